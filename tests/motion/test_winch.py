"""A winch that keeps a tension, against the fall of a mass and a harmonic drive, with its work in the account."""

import numpy as np
import pytest
from hanging import G

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, load_scene, paths, save_scene, signals, simulate, winched
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity, LineChange


def lowered(**more):
    """1 kg on a light cord."""
    cord = Cable("winch", "load", length=1.0, mass_per_length=1e-3, EA=200.0, zeta=0.5, segments=4, **more)
    return Scene([Fixed("winch", (0, 0, 0)), Free("load", 1.0)], [cord], [Gravity(G)])


def test_a_load_falls_with_what_the_tension_leaves_up_to_the_speed_of_the_winch():
    """a = g - T/m with T = T_wanted + band v/rate: v approaches v_max = rate (m g - T_wanted)/band or the rate itself."""
    wanted, band, rate = 0.9 * G, 0.5, 0.4
    scene = winched(lowered(), "winch-load", tension=wanted, band=band, rate=rate, t_end=2.0)
    run = simulate(scene, 2.0, method="edmc", dt=2e-3)
    per_rate = band / rate  # m dv/dt = m g - T_wanted - (band/rate) v, until it is as fast as the winch
    speed = (G - wanted) / per_rate * (1.0 - np.exp(-per_rate * run.t))
    quick = speed < 0.95 * rate
    assert quick.sum() > 100
    assert -run.velocity("load")[quick][20:, 2] == pytest.approx(speed[quick][20:], abs=0.02)  # the cord springs by 5 mm at first
    assert -run.velocity("load")[-1, 2] == pytest.approx(rate, rel=0.03)  # the load swings on its cord since
    assert run.end_tension("winch-load", "winch")[-1] == pytest.approx(G, rel=0.03)
    assert run.energy_balance.imbalance < 1e-6 and run.energy_balance.work < 0.0
    T, (signal,) = run.tension("winch-load")[:, 0], scene.effects[-1].signals
    paid = np.array([signal.at(t)[0] for t in run.t])
    braked = np.trapezoid(T + 0.5 * T**2 / 200.0, paid)  # a longer cord is softer by T^2/(2 EA) a metre
    assert run.energy_balance.work == pytest.approx(-braked, rel=2e-3)


def test_a_driven_end_is_followed(tmp_path):
    """Of +-0.1 m the cord alone would make +-20 N; the winch leaves band v/rate."""
    cord = Cable("winch", "hand", length=1.0, mass_per_length=1e-3, EA=200.0, zeta=0.5, segments=4)
    points = [Fixed("winch", (0, 0, 0)), Driven("hand", paths.harmonic((1.05, 0, 0), (0.1, 0, 0), 0.5, ramp=1.0))]
    scene = winched(Scene(points, [cord]), "winch-hand", tension=10.0, band=2.0, rate=1.0, t_end=4.0)
    run = simulate(scene, 4.0, method="edmc", dt=5e-3)
    late = run.t > 1.5
    v = run.velocity("hand")[late, 0]
    assert run.end_tension("winch-hand", "winch")[late] == pytest.approx(10.0 + 2.0 * v, abs=0.1)  # lags by band/(EA rate) = 10 ms
    save_scene(scene, tmp_path / "winch.toml")
    assert load_scene(tmp_path / "winch.toml") == scene


def breaking():
    return lowered(breaking_tension=50.0)


def changed():
    scene = lowered()
    return Scene(scene.points, scene.cables, [*scene.effects, LineChange({"winch-load": signals.line(0, 0.1, 1.0)})])


@pytest.mark.parametrize(
    "scene, wanted, message",
    [
        (lowered(), {"tension": -1.0}, r"Argument `tension` must be positive and finite \[N\], but the winch of cable"),
        (lowered(), {"tension": 1.0, "rate": 0.0}, r"Argument `rate` must be positive and finite \[m/s\]"),
        (changed(), {}, r'must be alone in changing a length, but that of cable "winch-load" changes already'),
        (breaking(), {}, r"works in a scene without events and without cables that break, but this one has some"),
        (Scene(lowered().points, lowered().cables, (), [PayloadChange("load", 1.0, 2.0)]), {}, r"without events"),
        (
            Scene(lowered().points, [Cable("winch", "load", length=1.0, mass_per_length=1.0, EA=np.inf, segments=2)]),
            {},
            r"has EA=inf",
        ),
        (lowered(), {"tension": 20.0, "rate": 5.0}, r'must keep at least 0.001 of its length, but of cable "winch-load"'),
        (lowered(), {"band": 1e-9}, r"The winch of cable \"winch-load\", whose stiffness asks for steps of"),
    ],
)
def test_what_a_winch_cannot_do_is_refused(scene, wanted, message):
    with pytest.raises(InputError, match=message):
        winched(scene, "winch-load", **({"tension": 5.0, "rate": 1.0, "t_end": 1.0} | wanted))
