"""Other engines behind one face: what each says without being installed, and that those installed move as we do."""

import inspect
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.prescribed import paths
from studies.peers import PEERS, Outcome, installed, peer
from studies.peers.problem import problem

ENGINE = {
    "moordyn": "moordyn",
    "exudyn": "exudyn",
    "mujoco": "mujoco",
    "drake": "pydrake",
    "cabledyn": "cabledyn",
}  # what each imports
NETS = ("moordyn", "exudyn", "mujoco")
FINE = {  # settings fine enough for the tolerances below
    "moordyn": {"dt": 3e-4},
    "exudyn": {"dt": 1e-3},
    "mujoco": {"dt": 1e-3, "integrator": "discrete"},
    "drake": {"accuracy": 1e-6, "scheme": "runge_kutta5"},
    "cabledyn": {"dt": 2e-4},
}
CORNERS = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0)]
SUDDEN = {  # for what starts with a jerk: each engine's own law of a slack segment, and a setting fine enough for it
    "moordyn": ("damped", {"dt": 3e-4}),
    "exudyn": ("linear", {"dt": 1e-4}),
    "mujoco": ("damped", {"dt": 3e-4, "integrator": "RK4"}),
}
WEIGHT = (Gravity(),)
T_END, SAVE_EVERY = 0.4, 0.04  # [s]


def net(mass=0.036, effects=WEIGHT, moves=True, **changes):
    """Three cables of six segments that meet at a payload, their corners at rest or brought up to speed in 0.2 s."""
    points = [
        Driven(f"s{i}", paths.line(at, (0.2, 0.0, 0.0), 0.2)) if moves else Fixed(f"s{i}", at) for i, at in enumerate(CORNERS)
    ]
    values = {"length": 1.0, "mass_per_length": 0.1, "EA": 1e4, "segments": 6, "zeta": 0.05} | changes
    return Scene([*points, Free("p0", mass=mass)], [Cable(f"s{i}", "p0", **values) for i in range(3)], effects)


def loose(effects=WEIGHT, **changes):
    """A cable let go from the horizontal."""
    values = {"length": 1.0, "mass_per_length": 0.1, "EA": 1e6, "segments": 8, "zeta": 0.05} | changes
    return Scene([Fixed("root", (0, 0, 0)), Free("tip", at=(1, 0, 0))], [Cable("root", "tip", **values)], effects)


def skip_without(name):
    pytest.importorskip(ENGINE[name], exc_type=ImportError)
    return peer(name)


def test_installed_are_those_with_a_version():
    assert installed() == [peer(name) for name in PEERS if peer(name).version() is not None]


def test_an_unknown_peer_is_refused():
    with pytest.raises(ValueError, match=r"A peer must be one of moordyn, .*, but it is 'orcaflex'"):
        peer("orcaflex")


def test_no_engine_is_imported_before_it_runs():
    code = (
        f"import sys; from studies.peers import PEERS, installed, peer; installed(); "
        f"print([m for m in {sorted(ENGINE.values())} if m in sys.modules])"
    )
    root = Path(__file__).parents[2]
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=root)
    assert out.stdout.strip() == "[]"


@pytest.mark.parametrize("name", PEERS)
def test_every_peer_has_the_same_face(name):
    module = peer(name)
    assert module.NAME and module.DESCRIPTION.endswith(".") and module.DESCRIPTION.count(". ") == 1
    assert module.version() is None or isinstance(module.version(), str)
    scene = net() if module.refuses(loose()) else loose()
    assert module.refuses(scene) is None
    for setting in module.settings(scene):
        inspect.signature(module.run).bind(scene, 1.0, 0.1, start=None, **setting)


@pytest.mark.parametrize(
    "name, scene, reason",
    [
        *(
            (name, loose(effects=[ViscousDamping(0.1)]), "is given gravity alone, but the scene has ViscousDamping")
            for name in NETS
        ),
        ("moordyn", loose(compression="linear"), 'does compression="none" or "damped" only, but cable "root-tip" has "linear"'),
        ("moordyn", loose(effects=[Gravity(9.81, (1, 0, 0))]), "MoorDyn knows gravity along -z only"),
        ("drake", net(), "it takes one cable, not a net"),
        ("cabledyn", loose(), "starts every scene from its own static equilibrium"),
        ("cabledyn", net(effects=()), "CableDyn needs gravity along -z"),
    ],
)
def test_what_a_peer_cannot_do_it_refuses_in_a_sentence(name, scene, reason):
    module = peer(name)
    said = module.refuses(scene)
    assert reason in said and said.endswith(".") and "\n" not in said
    with pytest.raises(ValueError, match=re.escape(said)):
        module.run(scene, 0.1, 0.1, **FINE[name])


@pytest.mark.parametrize(
    "name, wrong",
    [
        ("exudyn", {"dt": 1e-3, "solver": "Euler"}),
        ("exudyn", {"dt": 1e-3, "law": "push"}),
        ("mujoco", {"dt": 1e-3, "integrator": "Verlet"}),
        ("drake", {"accuracy": 1e-3, "scheme": "euler"}),
    ],
)
def test_an_unknown_choice_is_refused(name, wrong):
    argument = list(wrong)[1]
    with pytest.raises(ValueError, match=f"Argument `{argument}` must be one of .*, but it is '{wrong[argument]}'"):
        peer(name).run(loose(), 0.1, 0.1, **wrong)


def test_a_start_with_other_segments_is_refused():
    with pytest.raises(ValueError, match="must be a State of a scene with the same cables and segments"):
        problem(net(), 1.0, 0.1, equilibrium(net(segments=5)))


def test_driven_points_start_on_their_path_and_the_rest_where_the_state_has_them():
    scene = net()
    task = problem(scene, 1.0, 0.25, equilibrium(scene))
    assert np.array_equal(task.q, equilibrium(scene).q) and list(task.t) == [0.0, 0.25, 0.5, 0.75, 1.0]
    places = task.prescribed([0.0, 1.0])
    assert np.allclose(places[:, 0], CORNERS, atol=1e-15) and np.allclose(places[:, 1] - CORNERS, [0.18, 0.0, 0.0], atol=1e-15)


@pytest.mark.parametrize("wrong", [np.nan, 1e9])
def test_an_outcome_keeps_what_came_before_the_first_wrong_number(wrong):
    task = problem(loose(), 1.0, 0.25)
    q = np.tile(task.q, (len(task.t), 1, 1))
    assert task.outcome(q, 1.0, 0.0).status == "done"
    q[3, 0, 0] = wrong
    outcome = task.outcome(q, 1.0, 0.0)
    assert isinstance(outcome, Outcome) and outcome.status == "failed" and outcome.message.endswith("before t=0.75 s.")
    assert len(outcome.t) == 3 and outcome.position["tip"].shape == (3, 3)


def apart(outcome, run, name):
    """Largest distance between a peer's point and ours [m]."""
    assert outcome.status == "done" and outcome.message == ""
    assert outcome.wall_time > 0 and outcome.setup_time > 0
    assert np.allclose(outcome.t, run.t, atol=1e-12)
    return np.linalg.norm(outcome.position[name] - run.position(name), axis=1).max()


@pytest.mark.parametrize("name", NETS)
def test_the_carried_net_moves_as_ours(name):
    """Within what these steps leave, of a way of 60 mm."""
    module, scene = skip_without(name), net()
    rest = equilibrium(scene)
    outcome = module.run(scene, T_END, SAVE_EVERY, rest, **FINE[name])
    assert apart(outcome, simulate(scene, T_END, method="edmc", dt=1e-3, start=rest, save_every=SAVE_EVERY), "p0") < 2e-5


def test_cabledyn_carries_the_net_as_we_do_but_for_its_masses():
    """Consistent masses differ from lumped ones by the square of a segment's length: 1.4 mm with 6, 0.42 mm with 12."""
    module, off = skip_without("cabledyn"), []
    for segments in (6, 12):
        scene = net(segments=segments)
        rest = equilibrium(scene)
        outcome = module.run(scene, T_END, SAVE_EVERY, rest, **FINE["cabledyn"])
        off.append(apart(outcome, simulate(scene, T_END, method="edmc", dt=1e-3, start=rest, save_every=SAVE_EVERY), "p0"))
    assert off[0] < 2e-3 and 2.8 < off[0] / off[1] < 4.2


def test_cabledyn_starts_nowhere_but_at_rest():
    module, scene = skip_without("cabledyn"), net()
    with pytest.raises(ValueError, match="Argument `start` must be the equilibrium of the scene, because CableDyn starts there"):
        module.run(scene, T_END, SAVE_EVERY, equilibrium(net(mass=1.0, EA=1e3)), **FINE["cabledyn"])


T = np.linspace(0.0, T_END, 9)
WAYS = {
    "harmonic": lambda at: paths.harmonic(at, (0.02, 0.0, 0.01), 2.0, 0.3, 0.3),
    "samples": lambda at: paths.samples(T, np.array(at) + np.outer(0.02 * np.sin(5.0 * T) ** 2, (1.0, 0.5, 0.0))),
}


@pytest.mark.each_once
@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("way", WAYS)
def test_corners_follow_every_kind_of_path(name, way):
    """A micrometre: what MoorDyn's straight pieces of 1 ms leave of an acceleration of 3 m/s²."""
    law, fine = SUDDEN[name]
    module, scene = skip_without(name), net(compression=law)
    scene = replace(scene, points=(*(Driven(f"s{i}", WAYS[way](at)) for i, at in enumerate(CORNERS)), scene.points[3]))
    rest = equilibrium(scene)
    ours = simulate(scene, T_END, method="verlet", dt=2e-5, start=rest, save_every=SAVE_EVERY)
    assert apart(module.run(scene, T_END, SAVE_EVERY, rest, **fine), ours, "p0") < 1e-6


@pytest.mark.parametrize("name", NETS)
def test_a_net_that_drops_its_load_moves_as_ours(name):
    """From the equilibrium of another scene; p0 jumps up by millimetres and rings. Fourth order leaves 0.01 mm at most."""
    law, fine = SUDDEN[name]
    module, scene = skip_without(name), net(mass=0.0, moves=False, compression=law)
    rest = equilibrium(net(mass=0.5, moves=False, compression=law))
    ours = simulate(scene, T_END, method="verlet", dt=2e-5, start=rest, save_every=SAVE_EVERY)
    assert np.ptp(ours.position("p0"), axis=0).max() > 2e-3
    assert apart(module.run(scene, T_END, SAVE_EVERY, rest, **fine), ours, "p0") < 2e-5


@pytest.mark.parametrize("name", NETS)
def test_a_net_stopped_in_motion_moves_as_ours(name):
    """Velocities are handed over too: the net swings on from corners that stand still."""
    law, fine = SUDDEN[name]
    module, moving = skip_without(name), net(compression=law)
    last = simulate(moving, T_END, method="edmc", dt=1e-3, save_every=SAVE_EVERY).final
    stopped = replace(moving, points=tuple(Fixed(p.name, p.path.at(T_END)[0]) for p in moving.points[:3]) + moving.points[3:])
    ours = simulate(stopped, T_END, method="verlet", dt=2e-5, start=last, save_every=SAVE_EVERY)
    assert np.ptp(ours.position("p0"), axis=0).max() > 2e-3
    assert apart(module.run(stopped, T_END, SAVE_EVERY, last, **fine), ours, "p0") < 2e-5


@pytest.mark.parametrize("name", [name for name in PEERS if name != "cabledyn"])
def test_the_loose_cable_falls_as_ours(name):
    """Of a fall of 0.8 m: within the stretch that Drake leaves out, or MuJoCo's first order, g·t/2 a second of step."""
    module, scene = skip_without(name), loose()
    outcome = module.run(scene, T_END, SAVE_EVERY, **FINE[name] | ({"dt": 1e-5} if name == "moordyn" else {}))
    ours = simulate(scene, T_END, method="edmc", dt=2.5e-4, start="straight", save_every=SAVE_EVERY)
    assert apart(outcome, ours, "tip") < (4e-3 if name == "mujoco" else 1e-4)


@pytest.mark.parametrize("name, wild", [("moordyn", {"dt": 4e-3}), ("mujoco", {"dt": 4e-3, "integrator": "RK4"})])
def test_a_step_beyond_the_limit_fails_and_says_so(name, wild):
    outcome = skip_without(name).run(loose(), T_END, SAVE_EVERY, **wild)
    assert outcome.status == "failed" and "before t=" in outcome.message and len(outcome.t) < 11
