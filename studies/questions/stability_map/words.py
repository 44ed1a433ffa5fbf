"""Words of the study `stability_map`."""

import numpy as np

from studies.questions.stability_map.planes import (
    BORDER_DAMPERS,
    CLOSE,
    LONG_EA,
    LONG_SHARES,
    LONG_TIME,
    LONG_ZETAS,
    STABLE,
    UNSTABLE,
    survived,
    verdict,
)  # fmt: skip
from studies.shown.sentences import between, counted, listed, percent, power, share
from studies.thesis_cable import (
    DISTURBANCE,
    FOUND_K,
    REST_GROWTH,
    REST_STEPS,
    REST_TIME,
    WEIGHT_ENERGY,
    WHIP_RISE,
    WHIP_TIME,
    explicit_schemes,
    implicit_schemes,
    label,
)  # fmt: skip

TRIED = ("symplectic_euler", "verlet", "rk4")  # explicit schemes that the thesis's failures are repeated with
ABOUT = (5e-3, 20e-3)  # [s] that "about 10 ms" is


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    cells = rows["planes"].dropna(subset="dt_s")
    cells = cells.assign(verdict=verdict(cells), survived=survived(cells))
    failures = Failures(rows["thesis"])
    return "\n\n".join([
        _finding(cells, failures), _stiffer(failures), _damped(failures), _predicted(cells, rows["borders"]),
        _whip(rows["borders"], rows["long_whip"]), _implicit(cells), _judge(), LEFT_OUT,
    ])  # fmt: skip


class Failures:
    """The table of what the thesis tried, asked by scheme and change."""

    def __init__(self, table):
        self.table = table.set_index(["scheme", "change"])
        self.step_ms = 1e3 * table.groupby("scheme")["dt_s"].first()

    def limit(self, scheme, change):
        """Largest step in words."""
        return f"{self.table.loc[(scheme, change)].largest_step_ms:.2f} ms"

    def unstable(self, change, schemes=TRIED):
        """Those of some schemes that blow up with a change."""
        return [scheme for scheme in schemes if not self.table.loc[(scheme, change), "stable"]]

    def all_stable(self, scheme):
        """Whether a scheme is stable with every change."""
        return bool(self.table.loc[scheme, "stable"].all())


def _finding(cells, failures):
    found = [failures.table.loc[(scheme, "as found")].largest_step_ms for scheme in ("rk4", "symplectic_euler")]
    on_the_border = all(ABOUT[0] <= 1e-3 * limit <= ABOUT[1] for limit in found)
    across = [change for change in ("k × 1.2", "c = m/dt") if len(failures.unstable(change)) == len(TRIED)]
    edmc = cells[cells["scheme"] == "edmc"]
    rises = int((edmc["verdict"] != STABLE).sum())
    words = (
        f"The thesis's cable of 1.1 m, with 20 springs of {FOUND_K:.0f} N/m, is predicted to be stable with RK4 up to "
        f"{failures.limit('rk4', 'as found')} and with symplectic Euler up to {failures.limit('symplectic_euler', 'as found')}. "
    )
    if on_the_border and len(across) == 2:
        words += (
            "At a step of about 10 ms it lies on this border, and stiffer springs as well as dampers lead across it: both failures "
            "of the thesis are the border of explicit steps, which is known before any run. "
        )
    else:
        words += f"Of the thesis's two changes, {listed(across)} made all explicit schemes blow up. "
    stable = "is stable in all of the thesis's attempts" if failures.all_stable("edmc") else "is not stable in all of its attempts"
    return words + (
        f"The implicit edmc at {failures.step_ms['edmc']:.0f} ms {stable}, and its energy rises in {share(rises, len(edmc))} "
        f"cells, over EA = {power(cells['EA_N'].min())} to {power(cells['EA_N'].max())} N, dampers of "
        f"{between(cells.loc[cells['damper_Ns_per_m'] > 0, 'damper_Ns_per_m'], 'N·s/m')} and steps of "
        f"{between(1e3 * cells['dt_s'], 'ms')}."
    )


def _stiffer(failures):
    stiffer = failures.unstable("k × 1.2")
    return (
        f"First failure, k raised: at {failures.step_ms['rk4']:.1f} ms with RK4 ({percent(CLOSE)} of its limit) the cable as found "
        f"is {'stable' if 'rk4' not in failures.unstable('as found') else 'unstable'}; springs 1.2 times as stiff have a limit of "
        f"{failures.limit('rk4', 'k × 1.2')}, ten times as stiff {failures.limit('rk4', 'k × 10')}, since the limit falls as 1/√k. "
        f"With symplectic Euler, Verlet and RK4, each at {percent(CLOSE)} of its own limit, {share(len(stiffer), len(TRIED))} runs "
        "blow up at 1.2 k. Damping by the environment hardly moves the limit, as the top mode has turned many times before the "
        f"damping acts: with 2 /s it is {failures.limit('rk4', 'k × 10 and environment 2 /s')} at 10 k."
    )


def _damped(failures):
    heavier = failures.unstable("c = m/dt")
    return (
        "Second failure, dampers added: symplectic Euler needs k dt² + 2 c dt < m. A damper of c = m/dt would stop two neighbours "
        "within half a step; the explicit step overshoots and turns their speed round, by more each time. With c = m/dt the limits "
        f"are {failures.limit('symplectic_euler', 'c = m/dt')} (symplectic Euler), {failures.limit('verlet', 'c = m/dt')} (Verlet, "
        f"which takes the damper's force at a predicted speed) and {failures.limit('rk4', 'c = m/dt')} (RK4), and "
        f"{share(len(heavier), len(TRIED))} runs blow up; with c = 10 m/dt RK4's limit is {failures.limit('rk4', 'c = 10 m/dt')}."
    )


def _predicted(cells, borders):
    named = explicit_schemes(stable_undamped=True)
    limited = cells[cells["scheme"].isin(named)]
    right = (limited["verdict"] == UNSTABLE) == (limited["dt_s"] > limited["predicted_s"])
    euler = cells[cells["scheme"] == "explicit_euler"]
    failed = int((euler["verdict"] != STABLE).sum())
    rest = borders[borders["scheme"] != "explicit_euler"]
    off = (rest[["rest_over_predicted", "rest_one_way_over_predicted"]] - 1).abs().max()
    words = (
        f"Measured against predicted: about rest {share(right.sum(), len(right))} cells of "
        f"{listed(map(label, named))} are on the predicted side. By bisection the border is within "
        f"{100 * off.iloc[0]:.1f} % of the prediction with two-way springs and within {100 * off.iloc[1]:.1f} % with springs that "
        f"cannot push. Explicit Euler fails in {share(failed, len(euler))} cells"
    )
    inside = euler[(euler["dt_s"] <= euler["predicted_s"]) & (euler["verdict"] != STABLE)]
    return words + (", also where its axial modes would allow a step: nothing damps its swings." if len(inside) else ".")


def _whip(borders, longer):
    rest = borders[borders["scheme"] != "explicit_euler"]
    undamped = rest[rest["damper_Ns_per_m"] == 0]["whip_over_predicted"]
    damped = rest[rest["damper_Ns_per_m"] > 0]["whip_over_predicted"]
    here = longer[longer["share_of_limit"] == LONG_SHARES[1]]
    rises = [here[here["zeta"] == zeta].set_index("scheme")["whip_rise"] for zeta in LONG_ZETAS]
    told = [listed(f"{power(rise, 2)} with {label(scheme)}" for scheme, rise in of_zeta.items()) for of_zeta in rises]
    words = (
        f"In the whip (released from the horizontal) the border lies at {between(damped, 'times')} the prediction with dampers of "
        f"{between(BORDER_DAMPERS, 'N·s/m')}, as a cable that cannot push lets go of its damper, and at "
        f"{between(undamped, 'times')} without. In {LONG_TIME:g} s at EA = {power(LONG_EA)} N and {percent(LONG_SHARES[1])} of the "
        f"predicted limit the energy rises, over what the swing is worth, by {told[0]}; with a damping ratio of {LONG_ZETAS[1]:g} "
        f"in each segment by {told[1]}."
    )
    loud = [label(scheme) for scheme, rise in rises[0].items() if rise > WHIP_RISE]
    still = [label(scheme) for scheme, rise in rises[1].items() if rise > WHIP_RISE]
    if loud:
        words += f" So a loose cable without dampers needs a margin with {listed(loud)}."
    if still:
        words += f" With {listed(still)} such a damper does not help: take half of the limit, or steps that the scheme chooses."
    return words


def _implicit(cells):
    lines = []
    for scheme in implicit_schemes():
        here = cells[cells["scheme"] == scheme]
        bad = here[here["verdict"] != STABLE]
        if len(bad):
            k, c = (int((bad["plane"] == plane).sum()) for plane in ("stiffness", "damper"))
            most, lost = bad["whip_rise"].replace(np.inf, np.nan).max(), int(np.isinf(bad["whip_rise"]).sum())
            known = f" by up to {power(most, 2)} times the swing's worth" if np.isfinite(most) else ""
            without = f"{' and' if known else ''} without bound in {lost}" if lost else ""
            lines.append(
                f"{label(scheme)} in {counted(k, 'cell')} of the first plane and {c or 'none'} of the second,{known}{without}"
            )
    quiet = [scheme for scheme in implicit_schemes() if (cells[cells["scheme"] == scheme]["verdict"] == STABLE).all()]
    rises = {s: cells[cells["scheme"] == s]["whip_rise"].max() for s in quiet}
    quietest = listed(f"{label(s)}{f' ({power(rise, 1)} at most)' if rise > 0.0 else ''}" for s, rise in rises.items())
    words = (
        f"None of the implicit schemes has a border in linear theory. With {quietest} the energy of the whip never rises by more "
        f"than the judge's {percent(WHIP_RISE)} of the swing's worth of {WEIGHT_ENERGY / 2:.2f} J"
    )
    words += f"; it rises with {'; '.join(lines)}." if lines else "."
    start = cells[
        cells["scheme"].isin(implicit_schemes()) & (cells["rest_growth"] > REST_GROWTH) & cells["rest_at_once"].astype(bool)
    ]
    if len(start):
        who = listed(label(scheme) for scheme in start["scheme"].unique())
        words += (
            f" About rest, {who} {'overshoots' if start['scheme'].nunique() == 1 else 'overshoot'} in the first step, in "
            f"{counted(len(start), 'cell')} with heavy dampers, by up to {power(start['rest_growth'].max(), 1)} times the "
            "disturbance, and then calms down."
        )
    failed = cells[cells["verdict"] != STABLE]
    return words + (
        f" To survive is no proof: of {counted(len(failed), 'cell')} that fail, {int(failed['survived'].sum())} ran to their end."
    )


def _judge():
    return (
        f"The judge: nothing puts energy in, so that it may only fall. A cell is unstable if the energy of a disturbance of "
        f"{DISTURBANCE:g} m g L about rest grows by more than {REST_GROWTH:g} times within {REST_TIME:g} s or {REST_STEPS} steps, "
        f"or if that of the whip, in {WHIP_TIME:g} s, rises by more than {percent(WHIP_RISE)} of what the swing is worth. The "
        "bounded oscillation of energy that a symplectic step shows about rest just within its border is below that."
    )


LEFT_OUT = (
    "Left out: adaptive schemes, whose step is not given. Damping of the motion, which backward Euler pays its stability with, is "
    "not judged here. The thesis's solver and step are not known, so that the marks are an inference from the stretch that it "
    "states."
)
