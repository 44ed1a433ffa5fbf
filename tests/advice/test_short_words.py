"""What is shown of an audit and of a recommendation: a short line, and all of it on demand."""

from dataclasses import replace

from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.advice.recommendation import Candidate, Recommendation
from anet_lumped.results.audit import Audit

AUDIT = Audit(
    error=2.1e-4, where='point "bob"', t=0.3, allowed=0.01, imbalance=1e-9, wall_time=0.02, tension_error=0.004
)  # fmt: skip


def recommendation():
    cables = [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=n, name=f"line{n}") for n in (12, 15)]
    return Recommendation(
        scene=Scene([Fixed("a", (0, 0, 0)), Free("b")], cables), best=Candidate("edmc", 0.02, None, 3e-4, 1395.0),
        runner_up=Candidate("edmc", None, 2.4e-5, 4e-4, 1155.0), points=("b",), t_end=4.0, start="equilibrium", error=1e-3,
        segments_error=4.4e-4, time_error=3.4e-4, checked_error=6.8e-4, elasticity=1.3e-4, fast_enough=True,
    )  # fmt: skip


def test_an_audit_is_a_short_line_and_its_text_has_all():
    assert repr(AUDIT) == "<Audit passed: places to 0.00021 m, peak tension to 0.004 of it>"
    assert str(AUDIT).startswith('The audit passed.\nplaces: off by 0.00021 m, point "bob" at t=0.3 s; 0.01 m are allowed')
    assert "energy: 1e-09 of what was in play" in str(AUDIT)
    failed = replace(AUDIT, reason="The audit failed: it is off.")
    assert repr(failed).startswith("<Audit failed") and str(failed).startswith("The audit failed: it is off.\n")


def test_a_recommendation_is_a_short_line_and_its_text_has_all():
    found = recommendation()
    assert repr(found) == (
        "<Recommendation: 12 to 15 segments a cable, edmc with dt=0.02 s, error 0.00068 m (asked 0.001 m), 1395 times real time>"
    )
    for said in ("best: edmc with dt=0.02 s", "runner-up: edmc with rtol=2.4e-05", "line12 12, line15 15", "checked 0.00068 m"):
        assert said in str(found)
    assert "slower than" not in str(found) and "slower than" in str(replace(found, fast_enough=False))
    assert str(Candidate("edmc", 0.05, None, 1e-4, 10.0, extrapolate=True)) == "edmc with dt=0.05 s, extrapolated"
