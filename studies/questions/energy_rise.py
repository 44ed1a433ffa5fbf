"""Which schemes gain energy, and how much?

A cable that hangs from one end is let go from starts that are as bad as starts get, and nothing puts energy in: whatever
the energy rises by is the scheme's own. Measured for every implicit scheme over stiffness, damping and step, and for
velocity Verlet where its predicted limit allows a step.
"""

import itertools

import numpy as np
import pandas as pd

from anet_lumped.effects import Gravity
from anet_lumped.model.build import build
from anet_lumped.motion.simulate import simulate
from anet_lumped.results.state import State, segment_tensions
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from studies.shown.scheme_styles import style
from studies.shown.sentences import between, counted, listed, percent, power, share
from studies.shown.show import as_text
from studies.study import Drawing, Part, Record
from studies.sweeping.rows import run_rows
from studies.thesis_cable import implicit_schemes, label, predicted_step

STUDY = Record(question=__doc__.splitlines()[0], part=Part.CURE, first_look="steps of 5 and 100 ms in place of four.")
TABLES = {
    "by_scheme": "A line for each scheme: its worst rise of energy and where, and how its runs ended.",
    "runs": "A line for each scheme, start, stiffness, damping ratio and step: the largest rise of energy over the energy in play.",
    "newton_iterations": "A line for each stiffness: Newton iterations that a step of edmc takes on the loose cable.",
    "verlet": "A line for each step within velocity Verlet's limit and damping ratio: the rise of energy over a longer time.",
    "whip": "A line for each scheme and time: the energy of the loose cable above that at the start.",
}

LENGTH, MASS, SEGMENTS, GRAVITY = 1.0, 0.1, 20, 9.81  # [m], [kg], -, [m/s^2]
DURATION = 0.6  # [s]; the loose cable cracks like a whip at 0.55 s
STARTS = ("loose", "crumpled", "one spot", "overstretched")
OVERSTRETCH = 0.5  # of the length
STIFFNESSES = (1e2, 1e4, 1e6, 1e9)  # EA [N]
ZETAS = (0.0, 0.05, 1e3)  # damping ratio of one segment
STEPS_MS = (1.0, 5.0, 20.0, 100.0)
LOST = ("diverged", "unconverged")  # statuses of runs that did not reach their end
SEED = 1  # of the random walk
GAIN = 0.01  # a run that rises by more has gained energy
TOLERANCE = 1e-5  # rise that Newton's tolerance of 1e-6 of the force and round-off leave at most
ITERATIONS_EA, ITERATIONS_STEP = (1e4, 1e6, 1e8, 1e9), 0.01  # the loose cable, [N] and [s]
VERLET_EA, VERLET_TIME = 1e4, 8.0  # the loose cable within Verlet's limit for longer, [N] and [s]
VERLET_SHARES, VERLET_ZETAS = (0.2, 0.4, 0.6, 0.8), (0.0, 0.05)  # of the largest stable step; damping ratios
WHIP_EA, WHIP_ZETA, WHIP_STEP = 1e6, 0.05, 0.005  # whose energy is drawn over time, [N], -, [s]


def cable(EA, zeta):
    """The cable, held at one end and loose at the other, which lies level for `start="straight"`.

    Parameters
    ----------
    EA : float [N]
    zeta : float
        Damping ratio of one segment.

    Returns
    -------
    Scene
    """
    one = Cable("a", "b", length=LENGTH, mass_per_length=MASS / LENGTH, EA=EA, zeta=zeta, segments=SEGMENTS)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", at=(LENGTH, 0, 0))], [one], [Gravity(GRAVITY)])


def at_rest_in(scene, start):
    """The cable at rest in one of the STARTS: level and unstretched, as a random walk of unstretched segments, with all
    nodes at the support, or level and stretched by OVERSTRETCH.

    Returns
    -------
    State
    """
    model = build(scene)
    level = np.linspace(0.0, LENGTH, SEGMENTS + 1)[:, None] * (1.0, 0.0, 0.0)
    if start == "crumpled":
        steps = np.random.default_rng(SEED).normal(size=(SEGMENTS, 3))
        steps *= LENGTH / SEGMENTS / np.linalg.norm(steps, axis=1)[:, None]
        shape = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    else:
        shape = {"loose": 1.0, "one spot": 0.0, "overstretched": 1.0 + OVERSTRETCH}[start] * level
    q = np.zeros((model.n, 3))
    q[model.nodes("a-b")] = shape
    return State(model, 0.0, q, np.zeros_like(q), segment_tensions(model, q, np.zeros_like(q)))


def energy_scale(state):
    """What a rise is relative to: the weight times the length of the cable, or the elastic energy of the start if that is
    more [J]."""
    one = state.scene.cables[0]
    stretch = np.linalg.norm(np.diff(state.shape("a-b"), axis=0), axis=1) - one.L0
    return max(MASS * GRAVITY * LENGTH, float(0.5 * one.stiffness * np.sum(np.maximum(stretch, 0.0) ** 2)))


def largest_rise(energy):
    """Largest rise of an energy above the least that it had before, NaN and inf left out."""
    energy = energy[np.isfinite(energy)]
    return float((energy - np.minimum.accumulate(energy)).max())


# The study ----------------------------------------------------------------------------------------------------------


def compute(quick=False, executor=None, out=None):
    """The tables."""
    grid = [STARTS, STIFFNESSES, ZETAS, STEPS_MS]
    if quick:
        grid = [STARTS, STIFFNESSES, ZETAS, STEPS_MS[1::2]]
    cases = [dict(zip(("start", "EA_N", "zeta", "step_ms"), case, strict=True)) for case in itertools.product(*grid)]
    allowed = [{"scheme": scheme, **case} for scheme in implicit_schemes() for case in cases]
    allowed += [
        {"scheme": "verlet", **case}
        for case in cases
        if 1e-3 * case["step_ms"] <= predicted_step("verlet", cable(case["EA_N"], case["zeta"]))
    ]
    runs = run_rows(fall, allowed, executor=executor, out=out and out / "runs")
    return {
        "by_scheme": by_scheme(runs),
        "runs": runs,
        "newton_iterations": pd.DataFrame(map(iterations, ITERATIONS_EA)),
        "verlet": pd.DataFrame(itertools.starmap(verlet, itertools.product(VERLET_SHARES, VERLET_ZETAS))),
        "whip": pd.concat(map(whip, implicit_schemes()), ignore_index=True),
    }


def fall(row):
    """One run: largest rise of energy over `energy_scale`, how it ended, and what it took."""
    start = at_rest_in(cable(row["EA_N"], row["zeta"]), row["start"])
    dt = 1e-3 * row["step_ms"]
    run = simulate(start.scene, DURATION, method=row["scheme"], dt=dt, start=start, save_every=dt)
    scale = energy_scale(start)
    return {
        "rise": largest_rise(run.energy[:, :3].sum(axis=1)) / scale,
        "scale_J": scale,
        "newton_per_step": run.work.newton_iterations / max(run.work.steps, 1),
        "halvings": run.work.halvings,
        "status": run.status,
        "reason": run.message,
    }


def by_scheme(runs):
    """Worst rise of each scheme and where, how many of its runs gained energy or failed, and its Newton iterations."""
    lines = []
    for scheme, group in runs.groupby("scheme", sort=False):
        worst = group.loc[group["rise"].idxmax()]
        lines.append(
            {
                "scheme": label(scheme),
                "runs": len(group),
                "runs_that_gained": int((group["rise"] > GAIN).sum()),
                "runs_that_say_so": int(((group["rise"] > GAIN) & (group["status"] != "done")).sum()),
                "worst_rise": worst["rise"],
                "worst_rise_at": f"{worst['start']}, EA = {power(worst['EA_N'])} N, ζ = {worst['zeta']:g}, {worst['step_ms']:g} ms",
                "worst_rise_zeta_to_0.05": group[group["zeta"] < 1.0]["rise"].max(),
                "diverged": int((group["status"] == "diverged").sum()),
                "unconverged": int((group["status"] == "unconverged").sum()),
                "runs_with_halvings": int((group["halvings"] > 0).sum()),
                "newton_per_step": group["newton_per_step"].mean(),
            }
        )
    return pd.DataFrame(lines)


def iterations(EA):
    """Newton iterations a step of edmc on the loose cable, without and with damping."""
    found = {"EA_N": EA}
    for zeta in ZETAS[:2]:
        run = simulate(cable(EA, zeta), DURATION, method="edmc", dt=ITERATIONS_STEP, start="straight")
        found[f"newton_per_step_zeta_{zeta:g}"] = run.work.newton_iterations / run.work.steps
        found[f"halvings_zeta_{zeta:g}"] = run.work.halvings
    return found


def verlet(share, zeta):
    """Rise of energy of the loose cable with velocity Verlet, the step within its predicted limit."""
    scene = cable(VERLET_EA, zeta)
    dt = share * predicted_step("verlet", scene)
    run = simulate(scene, VERLET_TIME, method="verlet", dt=dt, start="straight")
    rise = largest_rise(run.energy[:, :3].sum(axis=1)) / (MASS * GRAVITY * LENGTH)
    return {"share_of_limit": share, "zeta": zeta, "step_ms": 1e3 * dt, "rise": rise, "status": run.status}


def whip(scheme):
    """Energy of the loose cable over time, above that of the start."""
    scene = cable(WHIP_EA, WHIP_ZETA)
    run = simulate(scene, 2 * DURATION, method=scheme, dt=WHIP_STEP, start="straight", save_every=WHIP_STEP)
    energy = run.energy[:, :3].sum(axis=1)
    return pd.DataFrame({"scheme": scheme, "t_s": run.t, "energy_J": energy - energy[0], "status": run.status})


# Figures and words --------------------------------------------------------------------------------------------------

FLOOR = 1e-18  # drawn for no rise at all


def plot(rows):
    """Drawings of the study, by name."""
    title = f"EA = {power(WHIP_EA)} N, a damping ratio of {WHIP_ZETA:g} and steps of {1e3 * WHIP_STEP:g} ms"
    return {
        "rise_against_stiffness": Drawing(
            _plot_rise(rows["runs"]),
            "Largest rise of energy of each scheme over the stiffness, one panel a damping ratio ζ of a segment: the worst of all "
            "starts and steps, over the energy in play. The grey band at the bottom is round-off and Newton's tolerance.",
        ),
        "energy_over_time": Drawing(
            _plot_whip(rows["whip"]),
            f"Energy of the loose cable over time, above that at its start, at {title}. Nothing puts energy in, so that it may "
            "only fall.",
        ),
    }


def _plot_rise(runs):
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullLocator

    zetas = sorted(runs["zeta"].unique())
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    panels = figure.subplots(1, len(zetas), sharex=True, sharey=True, squeeze=False)[0]
    for axes, zeta in zip(panels, zetas, strict=True):
        axes.axhspan(FLOOR / 10, 1e-9, color="0.93", lw=0)
        for scheme, group in runs[runs["zeta"] == zeta].groupby("scheme", sort=False):
            worst = group.groupby("EA_N")["rise"].max().clip(lower=FLOOR)
            axes.loglog(worst.index, worst, ms=5, **style(scheme).of_line())
            failed = worst[group[group["status"].isin(LOST)]["EA_N"].unique()]
            axes.loglog(failed.index, failed, "o", mfc="none", mec="k", ms=11, mew=0.8)
        axes.axhline(GAIN, color="k", lw=0.8, ls=":")
        axes.set(title=f"ζ = {zeta:g}", xlabel="EA [N]", ylim=(FLOOR / 10, 1e19))
        axes.yaxis.set_major_locator(LogLocator(base=1000.0, numticks=20))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.grid(axis="y", color="0.85", lw=0.5)
    panels[0].set_ylabel("largest rise of energy over that in play [-]")
    handles = {label: line for axes in panels for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    handles["some run did not reach its end"] = panels[0].plot([], [], "o", mfc="none", mec="k", ms=11, mew=0.8)[0]
    handles[f"rise of {percent(GAIN)}"] = panels[0].plot([], [], "k:", lw=0.8)[0]
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=5, frameon=False, fontsize=9)
    return figure


def _plot_whip(whip):
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullLocator

    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.subplots()
    for scheme, group in whip.groupby("scheme", sort=False):
        status = group["status"].iloc[0]
        name = label(scheme) if status == "done" else f"{label(scheme)} ({status})"
        axes.plot(group["t_s"], group["energy_J"], markevery=20, ms=5, **(style(scheme).of_line() | {"label": name}))
    axes.axhline(0.0, color="k", lw=0.8, ls=":")
    axes.set(xlabel="time [s]", ylabel="energy above that of the start [J]")
    axes.set_yscale("symlog", linthresh=0.01)
    axes.set_ylim(bottom=-1.0)
    axes.yaxis.set_minor_locator(NullLocator())
    figure.legend(*axes.get_legend_handles_labels(), frameon=False, fontsize=9, loc="outside right center")
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    return "\n\n".join([
        _finding(rows), _gains(rows), _ended(rows), _within_the_limit(rows["verlet"]), _iterations(rows["newton_iterations"]),
        _losses(rows["whip"]), LEFT_OUT,
    ])  # fmt: skip


def _implicit(rows):
    """The table of implicit schemes by name, and which of them never gained energy."""
    table = rows["by_scheme"].set_index("scheme").drop(index=label("verlet"), errors="ignore")
    return table, table["runs_that_gained"] == 0


def _finding(rows):
    table, quiet = _implicit(rows)
    gained, words = table[~quiet], "Every implicit scheme gains energy in some run."
    if quiet.any():
        rises = listed(f"{power(row['worst_rise'], 1)} with {name}" for name, row in table[quiet].iterrows())
        small = table.loc[quiet, "worst_rise"].max() < TOLERANCE
        words = (
            f"Of {len(table)} implicit schemes {listed(table.index[quiet])} never {'gains' if quiet.sum() == 1 else 'gain'} "
            f"energy, whatever the start, stiffness, damper and step: the worst rise over the energy in play is {rises}, which is "
            f"{'no more than round-off' if small else f'below {percent(GAIN)}, yet more than round-off'} and Newton's tolerance "
            f"leave."
        )
    if not len(gained):
        return words
    return (
        f"{words} The worst rise with {listed(gained.index)} is {between(gained['worst_rise'], 'times', 2)} the energy in play, "
        "although linear theory promises stability at every step."
    )


def _gains(rows):
    table, quiet = _implicit(rows)
    gained = table[~quiet].sort_values("worst_rise_zeta_to_0.05")
    worst = "; ".join(
        f"{name} {power(row['worst_rise_zeta_to_0.05'], 2)} and {power(row['worst_rise'], 2)}, in {row['runs_that_gained']} of "
        f"{row['runs']} runs"
        for name, row in gained.iterrows()
    )
    said, all_gained = table["runs_that_say_so"].sum(), table["runs_that_gained"].sum()
    return (
        f"Largest rise at damping ratios up to {ZETAS[1]:g}, and at all of them: {worst or 'none'}. A rise is that above the least "
        f"energy before, over the weight times the length of the cable ({MASS * GRAVITY * LENGTH:.3g} J) or the elastic energy of "
        f"the start if that is more; a run has gained if it is above {percent(GAIN)}. Of {counted(all_gained, 'run')} that gained, "
        f"{said} did not "
        'end as "done" but say what is wrong with them; a run does so from a tenth of the energy in play on.'
    )


def _ended(rows):
    table, _ = _implicit(rows)
    lost = {name: row["diverged"] + row["unconverged"] for name, row in table.iterrows() if row["diverged"] + row["unconverged"]}
    unconverged = counted(table["unconverged"].sum(), "run")
    but = f" but {listed(f'{number} of {name}' for name, number in lost.items())}" if lost else ""
    edmc = rows["runs"][rows["runs"]["scheme"] == "edmc"]
    halved = edmc[edmc["halvings"] > 0]
    words = (
        f"All{but} of {table['runs'].sum()} runs reached their end; {unconverged} ended because Newton's iteration did not "
        f"converge. edmc had to halve a step in {share(len(halved), len(edmc))} runs"
    )
    if len(halved):
        step, EA = halved["step_ms"].mode().iloc[0], halved["EA_N"].mode().iloc[0]
        words += f", most often at {step:g} ms and at EA = {power(EA)} N"
    return words + "."


def _within_the_limit(table):
    free, damped = table[table["zeta"] == 0.0], table[table["zeta"] > 0.0]
    shares = listed(f"{power(line.rise, 1)} at {line.share_of_limit:g}" for line in free.itertuples())
    beyond = free[free["rise"] > GAIN]
    verdict = (
        "Velocity Verlet's limit is that of small motions: within it, an undamped cable that goes slack and snaps taut gains "
        f"energy from {beyond['share_of_limit'].min():g} of the limit on"
        if len(beyond)
        else "Within its limit velocity Verlet gains no energy on an undamped cable that goes slack and snaps taut"
    )
    return (
        f"{verdict}. Over {VERLET_TIME:g} s of the loose cable at EA = {power(VERLET_EA)} N the rise is {shares} of the limit; "
        f"with a damping ratio of {between(damped['zeta'])} it is {power(damped['rise'].max(), 1)} at most."
    )


def _iterations(table):
    counts = table.set_index("EA_N")[f"newton_per_step_zeta_{ZETAS[1]:g}"]
    numbers = listed(f"{count:.2f} at {power(EA)} N" for EA, count in counts.items())
    spread = counts.max() / counts.min()
    verdict = "hardly depends on" if spread < 1.5 else "depends on"
    return (
        f"What a step of edmc costs {verdict} the stiffness: on the loose cable at {1e3 * ITERATIONS_STEP:g} ms it takes {numbers} "
        f"Newton iterations, the most {spread:.2f} times the fewest."
    )


def _losses(whip):
    change = whip.groupby("scheme", sort=False)["energy_J"].last()
    lost = listed(f"{label(scheme)} {as_text(-1e3 * joules, 2)} mJ" for scheme, joules in change.items() if joules <= 0.0)
    gained = listed(f"{label(scheme)} {power(joules, 2)} J" for scheme, joules in change.items() if joules > 0.0)
    return (
        f"What a scheme loses matters too. After {2 * DURATION:g} s of the loose cable at EA = {power(WHIP_EA)} N and steps of "
        f"{1e3 * WHIP_STEP:g} ms, of a swing that is worth {1e3 * MASS * GRAVITY * LENGTH / 2:.3g} mJ: lost have {lost}; gained "
        f"have {gained}. The cable has dampers, which take their part."
    )


LEFT_OUT = (
    "Left out: two-way springs, which hold no promise for any scheme; nets, where nothing else happens; and the accuracy of what "
    "does not blow up, which the study work_precision measures."
)
