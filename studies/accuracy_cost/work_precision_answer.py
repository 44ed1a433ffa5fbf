"""Words of the study `work_precision`, every number and claim from its rows."""

import numpy as np

from anet_lumped.motion.energy_gain import GAINED
from studies.accuracy_cost.comparisons import CHOICE_OVER_BEST, DEAREST_OVER_CHEAPEST, NET, NET_TARGET, PEER_OVER_OURS, SEGMENTS
from studies.accuracy_cost.contestants import OURS, OWN_CHOICE
from studies.accuracy_cost.paired_timing import Ratio, in_words
from studies.shown.sentences import between, counted, listed, power, stiffness
from studies.shown.show import as_text

LOOSE, LOOSE_TARGET, LOOSE_EA, FINER = "loose cable", 1.0, 1e6, 0.01  # errors [mm], [N]
WHIP_EA, STILL = 1e4, 2.0  # [N]; half the step of a method of order 2 leaves a quarter of the error, and here not even half
TURNING = "midpoint", "generalised_alpha"
STEP = 10.0  # [ms] of edmc, by which the parts of the error are told


def answer(rows):
    """Paragraphs, the finding first."""
    words = [_finding(rows), _loose(rows), _whip(rows), _stiffness(rows), _size(rows), _parts(rows), _choice(rows), _shocks(rows)]
    words.append(_doubt(rows))
    return "\n\n".join([*(text for text in words if text), _left_out(rows)])


def _line(rows, motion, EA, target):
    table = rows["equal_error"]
    found = table[
        (table["motion"] == motion) & (table["EA_N"] == EA) & (table["segments"] == SEGMENTS) & (table["target_mm"] == target)
    ]
    return found.iloc[0] if len(found) else None


def _ratio(rows, compared, line, target=None):
    """Ratio of two times that were taken in turns, or None."""
    table = rows["pairs"]
    found = table[(table["compared"] == compared) & (table["motion"] == line["motion"]) & (table["EA_N"] == line["EA_N"])]
    found = found[found["segments"] == line["segments"]]
    found = found if target is None else found[found["error_mm"] == target]
    return Ratio(*found.iloc[0][["median_ratio", "low", "high", "pairs"]]) if len(found) else None


def _net_lines(rows):
    table = rows["equal_error"]
    stiffnesses = table.loc[(table["motion"] == NET) & (table["segments"] == SEGMENTS), "EA_N"].unique()
    lines = [_line(rows, NET, EA, NET_TARGET) for EA in stiffnesses]
    return [line for line in lines if np.isfinite(line["ours_s"])]


def _finding(rows):
    lines = _net_lines(rows)
    if not lines:
        return f"No method and setting that was tried carries the net with p0 within {NET_TARGET:g} mm."
    text = (
        f"With p0 within {NET_TARGET:g} mm the carried net runs "
        f"{between([line['ours_times_real_time'] for line in lines], 'times', 2)} faster than real time on one core, with "
        f"{listed(line['best_ours'] for line in lines)}, at {listed(stiffness(line['EA_N']) for line in lines)}. "
    )
    compared = [line for line in lines if np.isfinite(line["peer_s"])]
    if not compared:
        return text + "Other engines were not run, so that nothing is said of them."
    best = listed(line["best_peer"] for line in compared)
    ratios = [f"{in_words(_ratio(rows, PEER_OVER_OURS, line, NET_TARGET), 2)} at {stiffness(line['EA_N'])}" for line in compared]
    text += f"The time of the best other engine ({best}) over that is {listed(ratios)}"
    own = max(line["peer_error_mm"] for line in compared)
    if own >= NET_TARGET:
        return text + "."
    finer = [_line(rows, NET, line["EA_N"], FINER) for line in compared]
    ratios = [
        f"{in_words(_ratio(rows, PEER_OVER_OURS, line, FINER), 2)} at {stiffness(line['EA_N'])}"
        for line in finer if np.isfinite(line["ratio"])
    ]  # fmt: skip
    text += f", at the longest step that holds there, which leaves {as_text(own, 2)} mm"
    return text + (f"; for errors of {FINER:g} mm it is {listed(ratios)}." if ratios else ".")


def _loose(rows):
    line = _line(rows, LOOSE, LOOSE_EA, LOOSE_TARGET)
    if line is None or not np.isfinite(line["ours_s"]):
        return ""
    text = (
        f"The loose cable at {stiffness(LOOSE_EA)}, let go from the horizontal, runs {as_text(line['ours_times_real_time'], 2)} "
        f"times faster than real time with its tip within {LOOSE_TARGET:g} mm up to 1 s, with {line['best_ours']}"
    )
    if not np.isfinite(line["peer_s"]):
        return text + "."
    coarsest = line["peer_error_mm"] < line["target_mm"]
    finer = f", whose fastest run leaves {as_text(line['peer_error_mm'], 2)} mm" if coarsest else ""
    found = in_words(_ratio(rows, PEER_OVER_OURS, line, LOOSE_TARGET), 2)
    return text + f"; the time of the best other engine, {line['best_peer']}{finer}, over that is {found}."


def _whip(rows):
    """Where the error of edmc stands still as its steps shrink, why."""
    runs = rows["runs"]
    chosen = (runs["motion"] == LOOSE) & (runs["EA_N"] == WHIP_EA) & (runs["segments"] == SEGMENTS) & (runs["method"] == "edmc")
    found = runs[chosen & runs["error_mm"].notna()].sort_values("step_ms", ascending=False)
    steps, errors = found["step_ms"].to_numpy(), found["error_mm"].to_numpy()
    still = [i for i in range(len(found) - 1) if errors[i + 1] > errors[i] / STILL]
    if not still:
        return ""
    first, last = still[0], still[-1] + 1
    return (
        f"From {as_text(steps[first], 2)} to {as_text(steps[last], 2)} ms the error of edmc on the loose cable at "
        f"{stiffness(WHIP_EA)} falls less than by two with some halvings of the step: from {as_text(errors[first], 2)} to "
        f"{as_text(errors[last], 2)} mm in all. After the whip the segments ring between slack and taut at their own frequency, "
        "which bends the motion that follows; steps that do not resolve this ringing damp it out, all to nearly the same motion."
    )


def _stiffness(rows):
    lines = _net_lines(rows)
    pairs = rows["pairs"][rows["pairs"]["compared"] == DEAREST_OVER_CHEAPEST]
    if len(lines) < 2 or not len(pairs):
        return ""
    found = pairs.iloc[0]
    runs = rows["runs"]
    verlet = runs[(runs["motion"] == NET) & (runs["segments"] == SEGMENTS) & (runs["method"] == "verlet")]
    least = verlet.groupby("EA_N")["wall_s"].min().dropna()
    text = (
        f"What this accuracy costs, by stiffness from {stiffness(lines[0]['EA_N'])} to {stiffness(lines[-1]['EA_N'])}: the dearest "
        f"over the cheapest is {in_words(Ratio(found.median_ratio, found.low, found.high, found.pairs), 2)}. "
    )
    if len(least) > 1:
        slope = np.polyfit(np.log(least.index), np.log(least), 1)[0]
        text += (
            f"verlet, bound to the axial waves, costs as EA to the power {slope:.2f}: {as_text(least.iloc[0], 2)} s at "
            f"{stiffness(least.index[0])} and {as_text(least.iloc[-1], 2)} s at {stiffness(least.index[-1])}."
        )
    return text


def _size(rows):
    table = rows["growth"]
    slope = np.polyfit(np.log(table["nodes"]), np.log(table["wall_s"]), 1)[0]
    first, last = table.iloc[0], table.iloc[-1]
    return (
        f"At one step the cost of edmc grows with the number of nodes to the power {slope:.2f}: "
        f"{as_text(1e3 * first['wall_s'], 2)} ms for a second of motion with {int(first['nodes'])} nodes, "
        f"{as_text(1e3 * last['wall_s'], 2)} ms with {int(last['nodes'])}, p0 off by {between(table['error_mm'], 'mm', 2)}, "
        f"{between(table['newton_per_step'], 'Newton iterations', 3)} a step. verlet would need "
        f"{as_text(last['verlet_predicted_s'], 2)} s with {int(last['nodes'])} nodes, because its step shrinks with the segments."
    )


def _parts(rows):
    table = rows["total_error"]
    edmc = table[table["method"] == "edmc"]
    model, by_segments = edmc.groupby("EA_N")["model_mm"].first(), edmc.groupby("segments")["discretisation_mm"].max()
    slope = np.polyfit(np.log(by_segments.index), np.log(by_segments), 1)[0]
    time = edmc.loc[edmc["step_ms"] == STEP, "time_mm"].max()
    parts = {"the segments": by_segments.max(), "the stretch": model.max(), f"steps of {STEP:g} ms of edmc": time}
    front = table[table["on_front"]].sort_values("wall_s")
    good = front[front["total_mm"] <= NET_TARGET]
    text = (
        f"Of the whole error against a continuous inextensible net, {max(parts, key=parts.get)} make the largest part tried. The "
        f"segments leave {listed(f'{as_text(value, 2)} mm with {N}' for N, value in by_segments.items())} of them a cable, as "
        f"their number to the power {slope:.2f}; the stretch "
        f"{listed(f'{as_text(value, 2)} mm at {stiffness(EA)}' for EA, value in model.items())}; steps of {STEP:g} ms of edmc "
        f"{as_text(time, 2)} mm. On the front of total error and time lie {listed(sorted(set(front['method'])))} with "
        f"{between(front['segments'])} segments"
    )
    if not len(good):
        return text + "."
    best = good.iloc[0]
    return text + (
        f"; the cheapest {NET_TARGET:g} mm of total error take {best['method']} at {as_text(best['step_ms'], 3)} ms with "
        f"{best['segments']} segments at {stiffness(best['EA_N'])}, {as_text(1e3 * best['wall_s'], 2)} ms for 4 s."
    )


def _choice(rows):
    runs, pairs = rows["runs"], rows["pairs"][rows["pairs"]["compared"] == CHOICE_OVER_BEST]
    own = runs[(runs["method"] == OWN_CHOICE) & (runs["status"] == "done")]
    found = [
        f"{as_text(line.error_mm, 2)} mm in {as_text(1e3 * line.wall_s, 2)} ms at {stiffness(line.EA_N)} ({line.reason})"
        for line in own[(own["motion"] == NET) & (own["segments"] == SEGMENTS)].itertuples()
    ]
    if not found:
        return ""
    text = f"Left to itself the library carries the net to within {listed(found)}."
    if not len(pairs):
        return text
    worst = pairs.loc[pairs["median_ratio"].idxmax()]
    slower = pairs[pairs["low"] > 1.0]
    told = in_words(Ratio(worst["median_ratio"], worst["low"], worst["high"], worst["pairs"]), 2)
    return text + (
        f" At the error that its choice has, the library takes longer than the best of its methods on {len(slower)} of "
        f"{counted(len(pairs), 'motion')}; the largest ratio of the times is {told} ({worst['motion']}, "
        f"{stiffness(worst['EA_N'])}, {worst['segments']} segments: {worst['second']})."
    )


def _shocks(rows):
    runs = rows["runs"]
    jerked = runs[runs["motion"].isin(("net stopped", "load dropped")) & (runs["engine"] == OURS) & runs["error_mm"].notna()]
    if not len(jerked):
        return ""
    worst = jerked[jerked["method"].isin(TURNING)].groupby("motion")["error_mm"].max()
    edmc = jerked[jerked["method"] == "edmc"].groupby("motion")["error_mm"]
    return (
        "A net that is stopped at once slackens and snaps taut, one that loses its load rings. There the schemes that hardly damp "
        f"axial waves, {' and '.join(TURNING)}, are off by up to "
        f"{listed(f'{as_text(value, 2)} mm ({name})' for name, value in worst.items())}, and edmc by "
        f"{listed(f'{between(group)} mm ({name})' for name, group in edmc)} at the steps tried."
    )


def _doubt(rows):
    table = rows["references"]
    worst = table.loc[table["difference_mm"].idxmax()]
    return (
        f"Each motion has two references by different methods. They differ by {power(table['difference_mm'].median(), 1)} mm in "
        f"the median and by {power(worst['difference_mm'], 2)} mm at worst ({worst['motion']}, {stiffness(worst['EA_N'])}, "
        f"{worst['segments']} segments), and nothing below that is said of any method."
    )


def _left_out(rows):
    runs = rows["runs"]
    left, failed = runs[runs["status"] == "left out"], runs[~runs["status"].isin(("left out", "done", GAINED, "refused"))]
    text = "Left out: compile time, which the table of first calls has; more than one core; memory; "
    if len(left):
        text += f"settings that would take longer than their bound, a row each that says so ({len(left)}); "
    if len(failed):
        who = listed(sorted(set((failed["engine"] + " " + failed["method"]).str.strip())))
        text += f"the errors of {counted(len(failed), 'run')} that did not reach the end ({who}); "
    if len(rows["refused"]):
        text += "motions that an engine does not take, in the table of those refused; "
    return text + "settings between those tried, which are interpolated."
