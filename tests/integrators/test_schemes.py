"""The records of the schemes: complete, light, and enough; a scheme is added by one file and one line."""

import subprocess
import sys

import numpy as np
import pytest
from systems import four_cables, loose_cable, spring_mass

from anet_lumped import simulate
from anet_lumped.motion.choice import SHARE_OF_LIMIT_SLACK, choose
from anet_lumped.motion.stability import damping_limit, frequency_limit, predict, step_limit
from integrators import schemes
from integrators.linear_stability import LaggingDamping, StepLimit
from integrators.schemes.record import Origin, Stepping
from studies import thesis_cable
from studies.accuracy_cost import contestants, motions, total_error
from studies.catalogue import outcome
from studies.questions import order
from studies.shown.scheme_styles import MARKS, style

NAMES = schemes.names()


@pytest.mark.filterwarnings("ignore::anet_lumped.motion.simulate.StabilityWarning")  # explicit Euler is stable at no step
@pytest.mark.parametrize("name", NAMES)
def test_a_record_is_complete(name):
    scheme = schemes.scheme(name)
    assert scheme.name == name and scheme.label and scheme.note
    assert scheme.own == (scheme.step is not None) == (scheme.memory_rows > 0)
    assert (scheme.stepping is Stepping.ADAPTIVE) == (scheme.origin is not Origin.OWN)
    if scheme.own:
        assert 1 <= scheme.carried_rows <= scheme.memory_rows and scheme.order in (1, 2, 4, 8)
        assert scheme.takes_changing_rest_lengths and scheme.stops_at_events
        assert len(scheme.parameters()) == 2 + len(scheme.options) + len(scheme.coefficients())
    if scheme.explicit and scheme.own:
        run = simulate(spring_mass().scene, 0.02, method=name, dt=0.01, start=spring_mass().start)
        # one at the start, and those of two steps
        assert run.work.force_evaluations == 1 + 2 * scheme.force_evaluations and run.work.newton_iterations == 0


def test_labels_and_names_are_different():
    assert len({schemes.scheme(name).label for name in NAMES}) == len(NAMES)


def test_names_are_those_of_records_with_the_values_wanted():
    assert schemes.names(own=True, explicit=True) == ("explicit_euler", "symplectic_euler", "verlet", "rk4", "dop853")
    assert schemes.names(takes_rigid_springs=True) == ("edmc",)
    assert schemes.names(own=True, stable_undamped=False) == ("explicit_euler",)
    assert schemes.names(origin=Origin.SCIPY) == ("RK45", "DOP853", "Radau", "BDF", "LSODA")


def test_parameters_hold_what_a_user_sets():
    alpha = schemes.scheme("generalised_alpha")
    np.testing.assert_array_equal(alpha.parameters(), [1e-6, 60, 0.8])
    np.testing.assert_array_equal(alpha.parameters(tolerance=1e-9, rho_inf=0.0), [1e-9, 60, 0.0])
    np.testing.assert_array_equal(alpha.parameters(rho_inf=None), alpha.parameters())


def test_who_chooses_the_steps():
    assert schemes.scheme("RK45").chooses_steps(0.1) and schemes.scheme("dop853").chooses_steps(None)
    assert not schemes.scheme("dop853").chooses_steps(0.1) and not schemes.scheme("edmc").chooses_steps(None)


def test_a_record_of_another_package_loads_none():
    """Nor does the registry load numba: only a scheme of this package does, for its step."""
    code = (
        "import sys; from integrators import schemes; list(map(schemes.scheme, ('RK45', 'LSODA', 'Tsit5', 'Kvaerno5'))); "
        "print([m for m in ('numba', 'scipy', 'jax', 'diffrax') if m in sys.modules]); "
        "schemes.names(); print([m for m in ('scipy.integrate', 'jax', 'diffrax') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split("\n")[:2] == ["[]", "[]"]


def test_no_record_is_compiled_until_it_is_marched():
    code = (
        "from integrators import schemes; schemes.names(order=2); "
        "print([n for n in schemes.names(own=True) if schemes.scheme(n).step.signatures])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


# --- limits of stability --------------------------------------------------------------------------------------------------


def test_what_a_limit_does_not_state_follows_from_its_largest_step():
    """Largest damping and highest frequency by bisection, against the closed forms of a scheme that has them."""

    class Bare(StepLimit):
        def largest_step(self, omega, d):
            return LaggingDamping(2.0).largest_step(omega, d)

    x, zeta, hd = np.array([0.1, 1.0, 1.9]), np.array([0.0, 0.3, 4.0]), np.array([0.0, 0.2, 0.01])
    known, bare = LaggingDamping(2.0), Bare()
    np.testing.assert_allclose(bare.largest_damping_ratio(x), known.largest_damping_ratio(x), rtol=1e-6, atol=1e-9)
    assert bare.largest_damping_ratio(np.array([2.1])) == -np.inf
    np.testing.assert_allclose(bare.highest_frequency(zeta, hd), known.highest_frequency(zeta, hd), rtol=1e-12)


# --- styles ---------------------------------------------------------------------------------------------------------------


def test_every_scheme_has_a_look_of_its_own():
    looks = [style(name) for name in NAMES]
    assert len({look.color for look in looks}) >= len(NAMES) - 1 and len({look.marker for look in looks}) == len(NAMES)
    assert len(MARKS) == len(set(MARKS)) >= len(NAMES) + 2  # and some for schemes that are added
    assert {style(name).line for name in schemes.names(explicit=True)} == {"--"}
    assert style("edmc").of_line() == {"label": "edmc", "color": style("edmc").color, "marker": style("edmc").marker, "ls": "-"}


# --- a scheme is added ----------------------------------------------------------------------------------------------------


@pytest.fixture
def toy(monkeypatch):
    """One file, `toy_scheme`, and one line."""
    monkeypatch.setitem(schemes.MODULES, "position_verlet", "toy_scheme")
    return "position_verlet"


def test_a_scheme_that_is_added_is_simulated(toy):
    """By its name, at the step that is chosen from its limit; of order 2; with steps chosen by a tolerance too."""
    motion = spring_mass(g=0.0)
    steps, off = np.array([40, 57, 80, 113, 160]), []
    for n in steps:
        run = simulate(motion.scene, 1.0, method=toy, dt=1.0 / n, start=motion.start)
        off.append(np.abs(run.q[-1, 0, 0] - motion.exact(1.0)[0][0]))
        assert run.ok and run.method == toy and run.work.force_evaluations == 1 + n
    assert -np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.15)
    whip = loose_cable(1e4, 0.0)
    chosen = simulate(whip, 0.2, method=toy, start="straight")
    assert chosen.ok and chosen.dt == pytest.approx(SHARE_OF_LIMIT_SLACK * choose(whip, toy).limit, rel=1e-2)
    adaptive = simulate(four_cables(1e3, carried=True), 0.2, method=toy, rtol=1e-5)
    assert adaptive.ok and adaptive.error_estimate > 0.0
    with pytest.raises(ValueError, match=r'did you mean "position_verlet"\?'):
        simulate(whip, 0.1, method="position_verlett")


def test_a_scheme_that_is_added_has_a_limit(toy):
    """As predicted, and as found: below it the energy of a disturbance swings, beyond it grows."""
    scene = thesis_cable.hung(100.0, 0.2, compression="linear")
    limit = thesis_cable.predicted_step(toy, scene)
    assert predict(scene).limits[toy].step == limit == thesis_cable.predicted_step("symplectic_euler", scene)
    for share, grows in ((0.99, False), (1.01, True)):
        assert (thesis_cable.rest_growth(scene, toy, share * limit)[0] > thesis_cable.REST_GROWTH) == grows
    assert step_limit(toy, 1.0) == 2.0 and damping_limit(toy, 1.0, 1.0) == pytest.approx(0.75, rel=1e-6)
    assert frequency_limit(toy, 1.0) == pytest.approx(2.0, rel=1e-12)


def test_a_scheme_that_is_added_is_in_every_list(toy):
    """Of the registry, of the studies, and among the looks of figures, without another line anywhere."""
    assert toy in schemes.names(own=True, explicit=True)
    assert toy in thesis_cable.explicit_schemes(stable_undamped=True) and thesis_cable.label(toy) == "position Verlet"
    assert (
        toy in order.cases()
        and toy in outcome.methods_tried()
        and toy in outcome.compiled_methods()
        and toy in total_error.methods()
    )
    assert outcome.not_promised(toy) == () and not contestants.of_another_package(toy)
    motion = motions.carried(1e4, 5)
    (mine,) = contestants.ours(motion, only=(toy,))
    limit = predict(motion.scene, schemes=(toy,)).limits[toy].step
    assert [setting["dt"] <= share * limit for setting, share in zip(mine.settings, contestants.SHARES, strict=True)] == [
        True,
        True,
    ]
    looks = [(style(name).color, style(name).marker) for name in schemes.names()]
    assert len(set(looks)) == len(looks) and style(toy).label == "position Verlet" and style(toy).line == "--"
