"""Words of the study `work_precision`, every number from its rows."""

import numpy as np

from anet_lumped.motion.energy_gain import GAINED
from studies.accuracy_cost.contestants import OURS, OWN_CHOICE

NET, LOOSE = "carried net", "loose cable"
NET_TARGET, FINER, LOOSE_TARGET, LOOSE_EA = 0.1, 0.01, 1.0, 1e6  # [mm], [mm], [mm], [N]
WHIP_EA, STILL = 1e4, 2.0  # [N]; half the step of a method of order 2 leaves a quarter of the error, and here not even half
SEGMENTS = 20
TURNING = "midpoint", "generalised_alpha"


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


def _EA(EA):
    return "∞" if np.isinf(EA) else f"1e{np.log10(EA):.0f} N"


def _net_lines(rows):
    table = rows["equal_error"]
    stiffnesses = table.loc[(table["motion"] == NET) & (table["segments"] == SEGMENTS), "EA_N"].unique()
    lines = [_line(rows, NET, EA, NET_TARGET) for EA in stiffnesses]
    return [line for line in lines if np.isfinite(line["ours_s"])]


def _against(line):
    """The best other engine beside ours in words; empty where there is none."""
    if not np.isfinite(line["peer_s"]):
        return ""
    coarsest = line["peer_error_mm"] < line["target_mm"]
    finer = f", whose fastest run leaves {line['peer_error_mm']:.2g} mm" if coarsest else ""
    return f"{line['ratio']:.2g} times as long in the best other engine, {line['best_peer']}{finer}"


def _finding(rows):
    lines = _net_lines(rows)
    paces = [line["ours_times_real_time"] for line in lines]
    text = (
        f"With p0 within {NET_TARGET} mm the carried net runs {min(paces):.0f} to {max(paces):.0f} times faster than real time on "
        f"one core, with {_listed(line['best_ours'] for line in lines)}, at EA = {_listed(_EA(line['EA_N']) for line in lines)}. "
    )
    compared = [line for line in lines if np.isfinite(line["peer_s"])]
    if not compared:
        return text + "Other engines are not installed here, so that nothing is said of them."
    ratios = [f"{line['ratio']:.2g} at {_EA(line['EA_N'])}" for line in compared]
    best = _listed(line["best_peer"] for line in compared)
    text += f"The best other engine, {best}, takes longer by a factor of {_listed(ratios)}"
    own = max(line["peer_error_mm"] for line in compared)
    if own >= NET_TARGET:
        return text + "."
    finer = [_line(rows, NET, line["EA_N"], FINER) for line in compared]
    ratios = [f"{line['ratio']:.2g} at {_EA(line['EA_N'])}" for line in finer if np.isfinite(line["ratio"])]
    text += f", at the longest step that holds there, which leaves {own:.2g} mm"
    return text + (f"; for errors of {FINER} mm the factor is {_listed(ratios)}." if ratios else ".")


def _listed(words):
    words = list(dict.fromkeys(words))
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def _loose(rows):
    line = _line(rows, LOOSE, LOOSE_EA, LOOSE_TARGET)
    if line is None or not np.isfinite(line["ours_s"]):
        return ""
    text = (
        f"The loose cable at EA = {_EA(LOOSE_EA)}, let go from the horizontal, runs {line['ours_times_real_time']:.0f} times "
        f"faster than real time with its tip within {LOOSE_TARGET:g} mm up to 1 s, with {line['best_ours']}"
    )
    return text + (f"; the same error takes {_against(line)}." if _against(line) else ".")


def _whip(rows):
    """Where the error of edmc stands still as its steps shrink, why."""
    runs = rows["runs"]
    chosen = (runs["motion"] == LOOSE) & (runs["EA_N"] == WHIP_EA) & (runs["segments"] == SEGMENTS) & (runs["method"] == "edmc")
    found = runs[chosen & runs["error_mm"].notna()].sort_values("step_ms")
    steps, errors = found["step_ms"].to_numpy(), found["error_mm"].to_numpy()
    still = [i for i in range(len(found) - 1) if errors[i + 1] < STILL * errors[i]]
    if not still:
        return ""
    first, last = still[-1] + 1, still[0]
    return (
        f"From {steps[first]:.2g} to {steps[last]:.2g} ms the error of edmc on the loose cable at EA = {_EA(WHIP_EA)} hardly "
        f"falls: {errors[first]:.2g} and {errors[last]:.2g} mm. The two references agree, and up to the whip it falls with the "
        "square of the step. After the whip the segments ring between slack and taut at their own frequency, which bends the "
        "motion that "
        "follows; steps that do not resolve it damp it out, all to nearly the same motion. With rho_inf = 1, which damps nothing, "
        "the error falls with the square of the step all along, and with rho_inf = 0 too once the step resolves the ringing."
    )


def _stiffness(rows):
    lines = _net_lines(rows)
    if len(lines) < 2:
        return ""
    paces = [line["ours_s"] for line in lines]
    runs = rows["runs"]
    verlet = runs[(runs["motion"] == NET) & (runs["segments"] == SEGMENTS) & (runs["method"] == "verlet")]
    least = verlet.groupby("EA_N")["wall_s"].min().dropna()
    text = (
        f"What this accuracy costs hardly depends on the stiffness: from EA = {_EA(lines[0]['EA_N'])} to {_EA(lines[-1]['EA_N'])} "
        f"the dearest costs {max(paces) / min(paces):.2f} times the cheapest. "
    )
    if len(least) > 1:
        slope = np.polyfit(np.log(least.index), np.log(least), 1)[0]
        text += (
            f"verlet, bound to the axial waves, costs as EA to the power {slope:.2f}: {least.iloc[0]:.2g} s at "
            f"{_EA(least.index[0])} and {least.iloc[-1]:.2g} s at {_EA(least.index[-1])}, then far more accurate than asked."
        )
    return text


def _size(rows):
    table = rows["growth"]
    slope = np.polyfit(np.log(table["nodes"]), np.log(table["wall_s"]), 1)[0]
    first, last = table.iloc[0], table.iloc[-1]
    return (
        f"Cost grows with the number of nodes to the power {slope:.2f} at the same step and with it the same error: "
        f"{1e3 * first['wall_s']:.2g} ms for a second of motion with {int(first['nodes'])} nodes, {last['wall_s']:.2g} s with "
        f"{int(last['nodes'])}, p0 off by {table['error_mm'].min():.2g} to {table['error_mm'].max():.2g} mm, "
        f"{table['newton_per_step'].min():.2f} to {table['newton_per_step'].max():.2f} Newton iterations a step. verlet would need "
        f"{last['verlet_predicted_s']:.2g} s with {int(last['nodes'])} nodes, because its step shrinks as they grow."
    )


def _parts(rows):
    table = rows["total_error"]
    edmc = table[table["method"] == "edmc"]
    model, halves = edmc.groupby("EA_N")["model_mm"].first(), edmc.groupby("segments")["discretisation_mm"].max()
    slope = np.polyfit(np.log(halves.index), np.log(halves), 1)[0]
    step = 10.0
    time = edmc.loc[edmc["step_ms"] == step, "time_mm"].max()
    front = table[table["on_front"]].sort_values("wall_s")
    good = front[front["total_mm"] <= NET_TARGET]
    text = (
        f"Of the whole error against a continuous inextensible net the segments are the largest part: "
        f"{_listed(f'{value:.2g} mm with {N}' for N, value in halves.items())} segments a cable, as their number to the power "
        f"{slope:.2f}. Stretching accounts for {_listed(f'{value:.2g} mm at EA = {_EA(EA)}' for EA, value in model.items())}, and "
        f"steps of {step:g} ms of edmc for {time:.2g} mm. On the front of total error and wall time lie "
        f"{_listed(sorted(set(front['method'])))} with {front['segments'].min()} to {front['segments'].max()} segments"
    )
    if not len(good):
        return text + "."
    best = good.iloc[0]
    return text + (
        f"; the cheapest {NET_TARGET} mm of total error take {best['method']} at {best['step_ms']:.3g} ms with {best['segments']} "
        f"segments at EA = {_EA(best['EA_N'])}, {1e3 * best['wall_s']:.2g} ms for 4 s."
    )


def _choice(rows):
    runs = rows["runs"]
    own = runs[(runs["method"] == OWN_CHOICE) & (runs["status"] == "done")]
    found = []
    for line in own[(own["motion"] == NET) & (own["segments"] == SEGMENTS)].itertuples():
        found.append(f"{line.error_mm:.2g} mm in {1e3 * line.wall_s:.2g} ms at EA = {_EA(line.EA_N)} ({line.reason})")
    if not found:
        return ""
    worst = rows["own_choice"].loc[rows["own_choice"]["ratio"].idxmax()]
    return (
        f"Left to itself the library carries the net to within {_listed(found)}. On all motions its choice takes at most "
        f"{worst['ratio']:.2g} times as long as the best method at the error that it has ({worst['motion']}, "
        f"EA = {_EA(worst['EA_N'])}, {worst['segments']} segments: {worst['best']})."
    )


def _shocks(rows):
    runs = rows["runs"]
    jerked = runs[runs["motion"].isin(("net stopped", "load dropped")) & (runs["engine"] == OURS) & runs["error_mm"].notna()]
    if not len(jerked):
        return ""
    worst = jerked[jerked["method"].isin(TURNING)].groupby("motion")["error_mm"].max()
    edmc = jerked[jerked["method"] == "edmc"].groupby("motion")["error_mm"]
    return (
        "A net that is stopped at once slackens and snaps taut, one that loses its load rings. Schemes that do not damp axial "
        f"waves, or hardly, go astray there: {' and '.join(TURNING)} are off by up to "
        f"{_listed(f'{value:.0f} mm ({name})' for name, value in worst.items())}. edmc comes to within "
        f"{_listed(f'{value:.2g} mm ({name})' for name, value in edmc.min().items())} at the steps tried, from "
        f"{_listed(f'{value:.2g} mm' for value in edmc.max())}; what is below takes steps that resolve the axial waves."
    )


def _doubt(rows):
    table = rows["references"]
    worst = table.loc[table["difference_mm"].idxmax()]
    return (
        f"Each motion has two references by different methods. They differ by {table['difference_mm'].median():.1g} mm in the "
        f"median and by {worst['difference_mm']:.2g} mm at worst ({worst['motion']}, EA = {_EA(worst['EA_N'])}, "
        f"{worst['segments']} segments), and nothing below that is said of any method. Where dampers act only while a segment is "
        "taut (law none) the force jumps as it snaps taut, which costs every method its order."
    )


def _left_out(rows):
    runs = rows["runs"]
    left, failed = runs[runs["status"] == "left out"], runs[~runs["status"].isin(("left out", "done", GAINED, "refused"))]
    text = "Left out: compile time, which the table of first calls has; more than one core; memory; "
    if len(left):
        text += f"settings that would take longer than their bound, a row each that says so ({len(left)}); "
    if len(failed):
        who = _listed(sorted(set((failed["engine"] + " " + failed["method"]).str.strip())))
        text += f"the errors of {len(failed)} runs that did not reach their end ({who}); "
    if len(rows["refused"]):
        text += "motions that an engine does not take, in the table of those refused; "
    return text + "settings between those tried, which are interpolated."
