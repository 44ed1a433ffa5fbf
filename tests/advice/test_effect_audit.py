"""The audit of effects: what it says of changes against closed forms and another method, its verdicts, what it does not know."""

import csv
import json
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from systems import four_cables, loose_cable

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, load_scene, simulate
from anet_lumped.advice import effect_audit
from anet_lumped.advice.effect_audit import NEEDED, NEGLIGIBLE, STIFF, UNDECIDED, UNKNOWN, USE_RIGID, audit_effects
from anet_lumped.effects import REGISTRY, Air, Bending, Effect, Gravity, Ground, ViscousDamping, node_force
from anet_lumped.effects.flow.wind import Uniform
from studies.command_line import main


def hung(EA=1e3, mass=0.2, **changes):
    """A metre of cable that hangs still, with a mass at its end."""
    cable = Cable("a", "b", **(dict(length=1.0, mass_per_length=0.1, EA=EA, zeta=0.1, segments=10, diameter=0.01) | changes))
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=mass)], [cable], [Gravity()])


@pytest.fixture(scope="module")
def flown():
    return audit_effects(load_scene("net_flown"), 1e-3, at="p0")


@pytest.mark.slow
def test_the_flown_net(flown):
    """A real cord's elasticity does not matter at 1 mm, and the air does at 5 m/s."""
    assert flown["elasticity"].verdict == USE_RIGID and flown["elasticity"].change < 0.3e-3
    assert flown["air"].verdict == NEEDED and flown["air"].change > 5e-3 and not flown["air"].present
    assert flown["gravity"].verdict == flown["payload"].verdict == NEEDED
    assert flown["axial damping"].verdict == NEGLIGIBLE
    assert {flown[name].verdict for name in ("water", "bending", "ground", "viscous_damping")} == {UNKNOWN}
    assert flown.known_to <= 1e-4 and flown.unit == "m" and flown.of == "p0"
    # 5 m/s and the swing of the net on top of it; strain of 1 N on 1e4 N; 36 g on 400 g
    faster = flown["gravity"].numbers["Froude"] / 1.5964
    assert 1.0 < faster < 1.1 and flown["air"].numbers["drag/weight"] == pytest.approx(0.05619 * faster**2, rel=1e-3)
    assert 1e-5 < flown["elasticity"].numbers["strain"] < 5e-4 and flown["elasticity"].numbers["Irvine's lambda²"] > 40
    assert flown["payload"].numbers["payload/cables"] == pytest.approx(0.09)


@pytest.mark.slow
def test_changes_are_those_of_another_method(flown):
    """Generalised-alpha at 1 ms: of air, and of elasticity by cords a thousand times as stiff."""
    scene = load_scene("net_flown")
    stiff = replace(scene, cables=tuple(replace(cable, EA=1e7) for cable in scene.cables))
    blown = replace(scene, effects=(*scene.effects, Air()))
    save = flown.t_end / 40
    runs = [simulate(s, flown.t_end, method="generalised_alpha", dt=save / 100, save_every=save) for s in (scene, stiff, blown)]
    of_stretch, of_air = (np.linalg.norm(run.position("p0") - runs[0].position("p0"), axis=1).max() for run in runs[1:])
    assert flown["elasticity"].change == pytest.approx(of_stretch, rel=0.03)  # a few per cent of 0.15 mm, which both steps leave
    assert flown["air"].change == pytest.approx(of_air, rel=0.01)


def test_a_hung_mass_in_closed_form():
    """Stretch (M + mu L/2) g L/EA of the cable, of which the mass makes M g L/EA; its tension at the support (M + mu L) g."""
    found = audit_effects(hung(), 1e-4, at="b", t_end=0.5)
    assert found["elasticity"].change == pytest.approx((0.2 + 0.05) * 9.81 / 1e3, rel=1e-6)
    assert found["payload"].change == pytest.approx(0.2 * 9.81 / 1e3, rel=1e-6)
    assert found["elasticity"].verdict == found["payload"].verdict == NEEDED
    assert found["air"].change < 1e-9 and found["air"].verdict == NEGLIGIBLE and found["air"].numbers["drag/weight"] < 1e-9
    assert found["elasticity"].numbers["strain"] == pytest.approx(0.25 * 9.81 / 1e3, rel=1e-9)  # of the mean tension
    assert "Irvine's lambda²" not in found["elasticity"].numbers  # an upright cable has no sag
    tensions = audit_effects(hung(), 0.01, tension="a-b", t_end=0.5)
    assert tensions.unit == "N" and tensions["payload"].change == pytest.approx(0.2 * 9.81, rel=1e-6)
    assert tensions["elasticity"].change < 1e-6 and tensions["elasticity"].verdict in (NEGLIGIBLE, USE_RIGID)


def test_an_error_decides():
    for error, verdict in ((1e-2, NEGLIGIBLE), (1e-4, NEEDED)):
        assert audit_effects(hung(EA=1e3), error, t_end=0.5)["payload"].verdict == verdict


def test_ctrl_c_leaves_the_verdicts_that_there_are(monkeypatch):
    def interrupted(name, *given, verdict=effect_audit._verdict):
        if name == "payload":
            raise KeyboardInterrupt
        return verdict(name, *given)

    monkeypatch.setattr(effect_audit, "_verdict", interrupted)
    found = audit_effects(hung(), 1e-3, t_end=0.2)
    judged = [verdict.effect for verdict in found.verdicts]
    assert judged and found.left_out[0] == "payload" and not set(judged) & set(found.left_out)
    monkeypatch.setattr(effect_audit, "_verdict", lambda *given: interrupted("payload"))
    with pytest.raises(KeyboardInterrupt):
        audit_effects(hung(), 1e-3, t_end=0.2)


def test_without_weight_it_goes_on_from_rest():
    """A cable that hung falls upwards by its stretch alone; nothing else could hold its shape."""
    found = audit_effects(replace(hung(), effects=(Gravity(),)), 1e-4, at="b", t_end=0.2)
    assert found["gravity"].verdict == NEEDED and 1e-3 < found["gravity"].change < 1.0


@pytest.mark.slow
def test_what_a_scene_has_is_taken_away():
    """Each effect of a rich scene is judged, with its number, and what changes nothing is said to."""
    scene = hung(EI=1e-9, segments=5)
    scene = replace(scene, effects=(Gravity(), Air(wind=Uniform((3.0, 0, 0))), ViscousDamping(0.5), Bending(), Ground(height=-5.0)))
    found = audit_effects(scene, 1e-3, at="b", t_end=0.25)
    assert all(found[name].present for name in ("air", "viscous_damping", "bending", "ground"))
    # the air is what moves it: its speed against the cable is the wind's, 0.5 1.225 0.01 1.2 9/0.981
    assert found["air"].verdict == NEEDED and found["air"].numbers["drag/weight"] == pytest.approx(0.06743, rel=0.1)
    assert found["bending"].verdict == found["ground"].verdict == STIFF or found["bending"].verdict == NEGLIGIBLE
    assert found["bending"].change < 1e-4 and found["ground"].change < 1e-9
    # sqrt(1e-9/T)/0.2 with T = 0.25 g on average
    assert found["bending"].numbers["√(EI/T)/L0"] == pytest.approx(math.sqrt(1e-9 / (0.25 * 9.81)) / 0.2, rel=0.05)
    # omega = sqrt(g/L) of a metre: 0.5/(2 3.132)
    assert found["viscous_damping"].numbers["damping ratio of a swing"] == pytest.approx(0.0798, rel=1e-2)
    assert all(math.isfinite(one.cost) for one in found.verdicts if one.verdict != UNKNOWN)


@pytest.mark.slow
def test_soft_cables_need_their_elasticity():
    found = audit_effects(four_cables(EA=10.0, carried=True), 1e-3, t_end=1.0)
    assert found["elasticity"].verdict == NEEDED and found["elasticity"].change > 1e-2
    assert found["air"].reason == 'It needs the `diameter` [m] of every cable, but "s0-p0" has none.'
    rigid = audit_effects(four_cables(EA=math.inf, carried=True), 1e-3, t_end=0.5)
    assert rigid["elasticity"].verdict == UNKNOWN and "EA" in rigid["elasticity"].reason


@pytest.mark.slow
def test_effects_that_it_does_not_know_are_judged_all_the_same():
    @node_force
    def breeze(t, q, v, push):
        return push, 0.0, 0.0

    scene = hung()
    scene = replace(scene, effects=(Gravity(), breeze(push=0.1, points=["b"])))
    found = audit_effects(scene, 1e-3, at="b", t_end=0.5)
    # at rest the tip leans by about F L/(M g) = 4 cm for a massless cable, and by less for one that weighs
    assert found["breeze"].verdict == NEEDED and 0.03 < found["breeze"].change < 0.055


@pytest.mark.slow
def test_water_whose_level_is_given(monkeypatch):
    """Whatever effect of water there is, made by its level; buoyancy of 1 cm of fresh water over 100 g/m."""
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))
    made = carrying_water()
    del REGISTRY["pond"]
    REGISTRY["water"] = made
    found = audit_effects(hung(), 1e-5, at="b", t_end=0.3, water_level=1.0)["water"]
    assert found.verdict == NEEDED and not found.present
    assert found.numbers["buoyancy/weight"] == pytest.approx(0.785398, rel=1e-5)
    assert set(found.numbers) == {"drag/weight", "buoyancy/weight", "Froude", "Keulegan-Carpenter"}


def test_an_effect_that_refuses_the_scene_is_not_known():
    """What it says of the scene is the reason."""

    @dataclass(frozen=True)
    class Frost(Effect):
        level: float

        def table(self, model):
            raise SceneError("It needs a cold scene.")

        def kernels(self):
            return Gravity().kernels() | {"tangent": ViscousDamping(1.0).kernels()["tangent"]}

    known = REGISTRY.classes
    REGISTRY.classes = known | {"water": Frost}
    try:
        found = audit_effects(hung(), 1e-3, t_end=0.1, water_level=0.0)["water"]
    finally:
        REGISTRY.classes = known
    assert found.verdict == UNKNOWN and found.reason == "It needs a cold scene."
    with pytest.raises(KeyError, match="rain"):
        audit_effects(hung(), 1e-3, t_end=0.1)["rain"]


def carrying_water():
    @node_force
    def pond(t, q, v, length, level, density=1000.0):
        return 0.0, 0.0, density * 9.81 * 0.25 * math.pi * 1e-4 * length if q[2] < level else 0.0

    pond.all_waves = ()
    return pond


@pytest.mark.slow
def test_a_motion_that_is_not_known_decides_nothing():
    """Let go from the horizontal a cable is chaotic after its whip."""
    found = audit_effects(loose_cable(), 1e-3, t_end=1.5, start="straight")
    assert found.known_to > 1e-2
    assert found["elasticity"].verdict == found["axial damping"].verdict == UNDECIDED
    assert "The numerical error of this comparison is" in found["elasticity"].reason
    assert found["gravity"].verdict == NEEDED and found["gravity"].change > 1.0  # which is far beyond what is not known


@pytest.mark.slow
def test_command(tmp_path, capsys):
    def call(*words):
        with pytest.raises(SystemExit) as stopped:
            main(list(map(str, words)))
        return stopped.value.code

    assert call("effects", "net_flown", "--at", "p0", "--t-end", 3, "--out", tmp_path) == 0
    said = capsys.readouterr().out
    assert (
        "changes [mm]" in said
        and "negligible; use EA = inf" in said
        and "input missing: EI" in said
        and "asked for: p0 within 0.001 m" in said
    )
    with (tmp_path / "effects.csv").open() as file:
        rows = {row["effect"]: row for row in csv.DictReader(file)}
    assert rows["air"]["verdict"] == NEEDED and float(rows["air"]["changes_mm"]) > 1 and rows["bending"]["reason"]
    assert {row["effect"] for row in json.loads((tmp_path / "effects.json").read_text())["effects"]} == set(rows)
    assert call("effects", "net_flown", "--tension", "s0-p0", "--error", "50mN", "--t-end", 1, "--json") == 0
    assert "changes_N" in json.loads(capsys.readouterr().out)["effects"][0]
    assert call("effects", "net_flown", "--tension", "s0-p0", "--error", "1 lbf") == 2
    assert "must be a force such as 0.1N" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (dict(error=0.0), "`error` must be positive and finite, but it is 0.0"),
        (dict(error=1e-3, t_end=-1.0), "`t_end` must be positive"),
        (dict(error=1e-3, at="s0"), 'place of a free point can be asked for, but "s0" is held'),
        (dict(error=1e-3, at="p1"), 'no point "p1"'),
        (dict(error=1e-3, tension="s0-p9"), 'no cable "s0-p9", did you mean "s0-p0"'),
        (dict(error=1e-3, at="p0", tension="s0-p0"), "Only one of `at` and `tension`"),
    ],
)
def test_messages(settings, message):
    with pytest.raises((ValueError, SceneError), match=message):
        audit_effects(four_cables(), **settings)
