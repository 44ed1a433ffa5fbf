"""Words of the study `three_models`."""

import numpy as np

from studies.accuracy_cost.paired_timing import in_words, ratio
from studies.questions.thesis_tables.words import in_units
from studies.questions.three_models.cases import CARRIED, FLOWN, FOUR
from studies.questions.three_models.root_finders import BISECTION, EPSILON, FALSE_POSITION, OURS
from studies.questions.three_models.tables import (
    BALANCED,
    DESCENDED,
    EQUILIBRIUM,
    LUMPED,
    LUMPED_DEFAULT,
    POSES_A_SECOND,
    SAMPLED,
    TWIN,
    TWIN_MOCAP,
)
from studies.shown.sentences import between, counted, listed, power, share
from studies.shown.show import as_text

MODELS = {
    SAMPLED: "sampling the energy",
    DESCENDED: "the gradient of the energy",
    BALANCED: "a balance of forces on catenaries",
    EQUILIBRIUM: "the equilibrium of lumped masses",
    LUMPED: "edmc on lumped masses",
    LUMPED_DEFAULT: "the default method on lumped masses",
    TWIN: "rigid links",
}


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    motions, rest = rows["motions"], rows["rest"]
    words = [
        f"{_in_motion(motions, FLOWN)} {_side_by_side(rows['turns'])}".strip(),
        _at_rest(rest),
        _in_motion(motions, CARRIED),
        _mocap(motions),
        _energies(motions),
    ]
    words += [_steps(rows["steps"]), _setup(motions), _roots(rows["roots"]), _brackets(rows["roots"]), _starts(rows["starts"])]
    return "\n\n".join(text for text in [*words, _left_out(motions)] if text)


def _in_motion(motions, name):
    """Errors and times of the models on the four cables in a motion with its largest load, each at the step of least error."""
    table = motions[(motions["motion"] == name) & (motions["net"] == FOUR)]
    table = table[table["load_g"] == table["load_g"].max()]
    done = table[table["status"] == "done"]
    told = []
    for model, words in MODELS.items():
        lines = done[done["model"] == model]
        if len(lines):
            line = lines.loc[lines["error_mm"].idxmin()]
            seconds = 1e-3 * line["time_of_a_second_ms"]
            step = f", steps of {as_text(line['step_ms'])} ms" if model in (LUMPED, LUMPED_DEFAULT, TWIN) else ""
            told.append(f"{as_text(line['error_mm'], 2)} mm with {words} ({in_units(seconds)}{step})")
    words = (
        f"{name.capitalize()}, p0 of four cables with {as_text(table['load_g'].iloc[0])} g is off by at most {listed(told)}; "
        "in brackets the time of a second of motion."
    )
    lost = [f"{MODELS.get(r.model, r.model)} at {as_text(r.step_ms)} ms" for r in table[table["status"] != "done"].itertuples()]
    return words + (f" Not done: {listed(lost)}." if lost else "")


def _side_by_side(turns):
    """Time of the links over that of edmc, which took turns."""
    if not len(turns):
        return ""
    step = turns["links_step_ms"].iloc[0]
    return (
        f"Side by side, the time of the links at {as_text(float(step))} ms over that of edmc is "
        f"{in_words(ratio(turns['links_s'], turns['edmc_s']))}."
    )


def _at_rest(rest):
    told = []
    for model, words in MODELS.items():
        lines = rest[(rest["model"] == model) & (rest["status"] == "done")]
        if len(lines):
            seconds = 1e-3 * lines["time_ms"]
            took = listed([in_units(seconds.min()), in_units(seconds.max())]).replace(" and ", " to ")
            told.append(f"{between(lines['error_mm'], 'mm', 2)} with {words} ({took})")
    nets = len(rest[["net", "load_g"]].drop_duplicates())
    words = f"At rest, p0 of {counted(nets, 'net')} is off that of elastic catenaries by {listed(told)}; in brackets the time."
    if TWIN in set(rest["model"]):
        words += " The links start at the equilibrium of the lumped masses, and are left alone."
    return words


def _mocap(motions):
    """Rigid links whose supports the engine holds for bodies at rest, beside the energy method, which has no motion."""
    told = []
    for name in (CARRIED, FLOWN):
        part = motions[(motions["motion"] == name) & (motions["net"] == FOUR) & (motions["status"] == "done")]
        pairs = part.pivot_table(index="load_g", columns="model", values="error_mm", aggfunc="min", sort=False)
        if TWIN_MOCAP in pairs:
            line = pairs.dropna(subset=TWIN_MOCAP).iloc[-1]
            told.append(
                f"{name}, p0 is {as_text(line[TWIN_MOCAP], 2)} mm off, beside {as_text(line[BALANCED], 2)} mm of a balance of "
                f"forces at each pose and {as_text(line[TWIN], 2)} mm of links in the frame of their supports"
            )
    if not told:
        return ""
    return (
        "Links that hang on mocap bodies, which are set along their path before each step, do not feel that the supports "
        f"accelerate: {'; '.join(told)}. The rows of rigid links are therefore of links in the frame of their supports, whose "
        "acceleration is taken off gravity."
    )


def _energies(motions):
    told = []
    for model in (LUMPED, TWIN):
        lines = motions[(motions["model"] == model) & (motions["status"] == "done")]
        for step, line in lines.groupby("step_ms"):
            change = line["energy_change_percent"]
            told.append(f"{between(change, '%', 2)} with {MODELS[model]} at {as_text(float(step))} ms")
    return (
        "Once the supports move steadily nothing puts energy in. From then on the energy relative to them changes, in per cent of "
        f"what setting off had put in, by {listed(told)}. Poses of the energy method have no kinetic energy."
    )


def _steps(steps):
    if not len(steps):
        return ""
    finite = steps[np.isfinite(steps["largest_step_ms"])]
    free = steps[np.isinf(steps["largest_step_ms"])]
    told = [
        f"{as_text(line.largest_step_ms, 2)} ms of {line.method if line.model != TWIN else TWIN} ({line.known})"
        for line in finite.itertuples()
    ]
    words = f"The largest stable step of {steps['net'].iloc[0]} in flight is {listed(told)}."
    return words + (f" For {listed(free['method'])} there is no limit." if len(free) else "")


def _setup(motions):
    told = []
    for model in (LUMPED, TWIN):
        lines = motions[motions["model"] == model]
        if len(lines):
            told.append(f"{between(lines['setup_ms'], 'ms', 2)} for {MODELS[model]}")
    return (f"From a scene to the first step it takes {listed(told)}, once all is compiled.") + (
        " That is the equilibrium, and of links the engine's model too." if TWIN in set(motions["model"]) else ""
    )


def _roots(roots):
    """Iterations from the first bracket, and what the criterion of the thesis leaves."""
    first = roots.iloc[0]
    same = roots[roots["from_m"].isna() | ((roots["from_m"] == first.from_m) & (roots["to_m"] == first.to_m))]
    told = []
    for cable, lines in same.groupby("cable", sort=False):
        each = [
            f"{method} {line.iterations}" if line.status == "done" else f"{method} none ({line.status})"
            for method in (BISECTION, FALSE_POSITION, OURS)
            for line in lines[lines["method"] == method].itertuples()
        ]
        told.append(f"{cable}: {', '.join(each)}")
    done = roots[(roots["status"] == "done") & (roots["method"] != OURS)]
    worst = done.loc[done["error_m"].idxmax()]
    return (
        f"Iterations to the catenary number a of Eq. 3.4, from a on {as_text(first.from_m)} … {as_text(first.to_m)} m to "
        f"|f| < {power(EPSILON)} m, this library without a bracket: {'; '.join(told)}. That |f| is so small does not make a "
        f"as exact: its largest error is {power(worst['error_m'], 2)} m, of the cable {worst['cable']}."
    )


def _brackets(roots):
    told = []
    for method in (BISECTION, FALSE_POSITION):
        lines = roots[roots["method"] == method]
        bad = lines[~lines["status"].isin(("done", "mirrored"))]
        why = listed(f"{reason} {(bad['status'] == reason).sum()}" for reason in bad["status"].unique())
        mirrored = (lines["status"] == "mirrored").sum()
        told.append(
            f"{method} finds no root in {share(len(bad), len(lines))}"
            + (f" ({why})" if len(bad) else "")
            + f" and the mirrored one, −a, in {mirrored}"
        )
    return f"Of the brackets and cables tried, {'; '.join(told)}."


def _starts(starts):
    mirrored, none = ((starts["status"] == status).sum() for status in ("mirrored", "no root"))
    return (
        f"Without a bracket, SciPy's fsolve ends at the mirrored root from {share(mirrored, len(starts))} starts on "
        f"{power(starts['start_m'].min())} … {power(starts['start_m'].max())} m, and at none from {none}."
    )


def _left_out(motions):
    poses = motions.groupby("model", sort=False)["poses"].max().dropna()
    told = listed(f"{number:.0f} by {MODELS[model]}" for model, number in poses.items())
    text = (
        "Left out: the thesis's computer, engine and dampers of the joints, which are not known; air. A second of the energy "
        f"method is {POSES_A_SECOND} poses, as long as the first ones take: {told}."
    )
    if TWIN not in set(motions["model"]):
        text += " MuJoCo is not installed, so that there are no rigid links."
    return text
