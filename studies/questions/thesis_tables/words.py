"""Words of the study `thesis_tables`."""

import numpy as np

from studies.accuracy_cost.paired_timing import in_words, ratio
from studies.questions.thesis_tables.tables import LOWEST, MOTION, SAMPLING, SPEED
from studies.shown.sentences import between, listed, share
from studies.shown.show import as_text

LAST_DIGIT = 0.01  # [cm] of the thesis's errors, which its rounding may be off by
LEFT_OUT = (
    "Left out: the thesis's computer, program and sampling cube are not known, so that its times stand beside these and prove "
    "nothing alone. A net that moves as one body rests in the same shape at every pose, so that these poses say nothing about "
    "its swing."
)


def in_units(seconds):
    """A time in ms, s or min."""
    if seconds < 0.1:
        return f"{as_text(1e3 * seconds, 2)} ms"
    return f"{as_text(seconds, 2)} s" if seconds < 100 else f"{as_text(seconds / 60, 3)} min"


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    table, bias, balance, motion = (rows[name] for name in ("table_5_1", "bias", "force_balance", "motion"))
    quickest = balance.sort_values("time_ms").iloc[0]
    return "\n\n".join([_finding(table, quickest), _errors(table), _cause(bias), _times(rows["turns"], quickest, motion), LEFT_OUT])


def same(table):
    """Which errors of Table 5.1 the thesis's own method gives again to their last digit, and which but for their sign."""
    alike = (table.error_cm - table.thesis_error_cm).abs() < LAST_DIGIT
    mirrored = ~alike & ((table.error_cm + table.thesis_error_cm).abs() < LAST_DIGIT)
    return alike, mirrored


def _names(rows):
    return listed(f"({row.samples}, {row.points})" for row in rows.itertuples())


def _finding(table, quickest):
    alike, mirrored = same(table)
    others = table[~alike & ~mirrored]
    off = (others.error_cm - others.thesis_error_cm).abs()
    words = f"Made again by its own method, {share(alike.sum(), len(table))} errors of Table 5.1 come out to their last digit"
    if mirrored.any():
        words += f", {_names(table[mirrored])} with the opposite sign"
    if len(others):
        words += f"; {_names(others)} {'is' if len(others) == 1 else 'are'} {between(off, 'cm')} off"
    finer = 0.1 * abs(quickest.error_mm) < table.error_cm.abs().max()
    return (
        f"{words}. The method has two sources of error: a grid of p0 and, at each end of a cable, a point with a full mass where "
        f"half a mass belongs. A balance of forces has neither; it finds p0 in {as_text(quickest.time_ms, 2)} ms, "
        f"{as_text(abs(quickest.error_mm), 2)} mm from the continuous cable's, which is {'less' if finer else 'not less'} than the "
        "largest error of the table."
    )


def _errors(table):
    errors = "; ".join(f"{r.error_cm:+.3f} ({r.thesis_error_cm:+g}) for ({r.samples}, {r.points})" for r in table.itertuples())
    return (
        f"With p0 on {LOWEST:.4f} … 1 m, points equal in arc length with both ends included, and all masses equal, the errors of "
        f"p0's height in cm are, with the thesis's in brackets, by samples and points: {errors}. The samples are "
        f"{between(table.grid_cm, 'cm')} apart."
    )


def _cause(bias):
    ten, most = bias[bias.points == 10].iloc[0], bias.iloc[-1]
    explained = (bias.payload_mm / bias.equal_masses_mm).iloc[-1]
    slope = np.polyfit(np.log(bias.points - 1), np.log(bias.half_end_masses_mm.abs()), 1)[0]
    verdict = "explains" if abs(explained - 1.0) < 0.1 else "does not explain"

    def down(row):
        return (
            f"at n = {row.points:.0f} equal masses pull p0 down by {as_text(-row.equal_masses_mm, 3)} mm, and a balance of forces "
            f"with that payload by {as_text(-row.payload_mm, 3)} mm"
        )

    words = (
        f"A full mass at each end point is a payload at p0 of 1/(n − 1) of a cable, which {verdict} the error where the points are "
        f"many: {down(ten)}; {down(most)}. With half a mass at the ends (the trapezoid rule) "
        f"{as_text(abs(ten.half_end_masses_mm), 2)} and {as_text(abs(most.half_end_masses_mm), 2)} mm are left; they fall as n to "
        f"the power {slope:.2f}."
    )
    if (bias.half_end_masses_mm.abs() < 0.5 * bias.equal_masses_mm.abs()).all():
        words += " So the thesis's conclusion that n matters more than the samples of p0 follows from its masses."
    return words


def _times(turns, quickest, motion):
    against = ratio(turns[SAMPLING], turns[quickest.method])
    two, four = (motion[(motion.net == net) & (motion.method == "lumped")].iloc[0] for net in MOTION)
    return (
        f"Side by side in this program, sampling with 200 samples and 500 points takes {in_units(turns[SAMPLING].median())}; its "
        f"time over that of the balance of forces ({quickest.method}) is {in_words(against)}. The 4 s of motion at {SPEED:g} m/s, "
        f"400 poses each from scratch, take {in_units(two.time_s)} for two cables and {in_units(four.time_s)} for four, where the "
        "thesis states 14.5 min and more than 30 min."
    )
