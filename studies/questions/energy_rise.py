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
from anet_lumped.results.run import State, segment_tensions
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from studies.questions.stability_map import implicit_schemes, label, predicted_step
from studies.shown.scheme_styles import style
from studies.sweeping.rows import run_rows

QUESTION = __doc__.splitlines()[0]

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
    """Tables of the study.

    Returns
    -------
    dict of pandas.DataFrame
        "by_scheme" (worst of each), "runs" (a line a run), "newton_iterations" (edmc, the loose cable at 10 ms), "verlet"
        (the loose cable for longer, within the limit), "whip" (energy over time).
    """
    grid = [STARTS, STIFFNESSES, ZETAS, STEPS_MS]
    if quick:
        grid = [STARTS, STIFFNESSES[1::2], ZETAS[1:], STEPS_MS[1:2]]
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
        "newton_iterations": run.work.newton_iterations / max(run.work.steps, 1),
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
                "runs_that_say_so": int((group["status"] != "done").sum()),
                "worst_rise": worst["rise"],
                "worst_rise_at": f"{worst['start']}, EA {worst['EA_N']:.0e} N, ζ {worst['zeta']:g}, {worst['step_ms']:g} ms",
                "worst_rise_zeta_to_0.05": group[group["zeta"] < 1.0]["rise"].max(),
                "diverged": int((group["status"] == "diverged").sum()),
                "unconverged": int((group["status"] == "unconverged").sum()),
                "runs_with_halvings": int((group["halvings"] > 0).sum()),
                "newton_iterations_a_step": group["newton_iterations"].mean(),
            }
        )
    return pd.DataFrame(lines)


def iterations(EA):
    """Newton iterations a step of edmc on the loose cable, without and with damping."""
    found = {"EA_N": EA}
    for zeta in ZETAS[:2]:
        run = simulate(cable(EA, zeta), DURATION, method="edmc", dt=ITERATIONS_STEP, start="straight")
        found[f"iterations_a_step_zeta_{zeta:g}"] = run.work.newton_iterations / run.work.steps
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
    """Figures of the study, {name: matplotlib Figure}."""
    return {"rise_against_stiffness": _plot_rise(rows["runs"]), "energy_over_time": _plot_whip(rows["whip"])}


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
    panels[0].set_ylabel("largest rise of energy over the scale")
    panels[0].text(0.03, 1e-10, "round-off and Newton's tolerance", transform=panels[0].get_yaxis_transform(), va="top",
                   fontsize=8, color="0.35")  # fmt: skip
    handles = {label: line for axes in panels for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    handles["some run did not reach its end"] = panels[0].plot([], [], "o", mfc="none", mec="k", ms=11, mew=0.8)[0]
    handles[f"rise of {GAIN:.0%}"] = panels[0].plot([], [], "k:", lw=0.8)[0]
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
        axes.plot(group["t_s"], group["energy_J"], color=style(scheme).color, label=name)
    axes.axhline(0.0, color="k", lw=0.8, ls=":")
    axes.set(xlabel="time [s]", ylabel="energy above that of the start [J]")
    axes.set_yscale("symlog", linthresh=0.01)
    axes.set_ylim(bottom=-1.0)
    axes.yaxis.set_minor_locator(NullLocator())
    axes.legend(frameon=False, fontsize=9, loc="upper left")
    axes.set_title(f"loose cable, EA = {WHIP_EA:.0e} N, ζ = {WHIP_ZETA:g}, steps of {1e3 * WHIP_STEP:g} ms", fontsize=10)
    return figure


def answer(rows):
    """The answer in words, with the numbers of `rows`."""
    table, runs, whip = rows["by_scheme"].set_index("scheme"), rows["runs"], rows["whip"]
    safe = [label("edmc"), label("backward_euler")]
    gained = table.drop(index=[*safe, label("verlet")], errors="ignore").sort_values("worst_rise_zeta_to_0.05")
    worst = "; ".join(
        f"{name} {line['worst_rise_zeta_to_0.05']:.2g} and {line['worst_rise']:.2g}, in {line['runs_that_gained']} of"
        f" {line['runs']} runs"
        for name, line in gained.iterrows()
    )
    ended = "every run of every scheme reached its end"
    if runs["status"].isin(LOST).any():
        ended = "every run reached its end but for " + ", ".join(
            f"{line['diverged'] + line['unconverged']} of {name}"
            for name, line in table.iterrows()
            if line["diverged"] + line["unconverged"]
        )
    counts = rows["newton_iterations"].set_index("EA_N")[f"iterations_a_step_zeta_{ZETAS[1]:g}"]
    numbers = ", ".join(f"{count:.2f} at {EA:.0e}" for EA, count in counts.items())
    lost = whip.groupby("scheme")["energy_J"].last()
    halved = table.loc[safe[0]]
    free = rows["verlet"][rows["verlet"]["zeta"] == 0.0]
    shares = ", ".join(f"{line.rise:.1g} at {line.share_of_limit:g}" for line in free.itertuples())
    damped = rows["verlet"][rows["verlet"]["zeta"] > 0.0]["rise"].max()
    return f"""
Two schemes never gain energy, whatever the start, stiffness, damper and step: edmc, whose largest rise is
{table.loc[safe[0], "worst_rise"]:.1g} of the energy in play, and backward Euler with {table.loc[safe[1], "worst_rise"]:.1g}.
That is round-off and Newton's tolerance. All other implicit schemes gain, from a share of the energy in play to many times all
of it, although their linear theory promises stability at every step.

Largest rise, at a damping ratio up to {ZETAS[1]:g} and with the damper of {ZETAS[2]:g} as well: {worst}. A rise is the
largest one above the least energy before, over the weight times the length of the cable ({MASS * GRAVITY * LENGTH:.3g} J)
or the elastic energy of the start if that is more; a run has gained if it is above {GAIN:.0%}. From a tenth of the energy in
play on a run does not end as "done" but says so: {int(table["runs_that_say_so"].sum())} of the
{int(table["runs_that_gained"].sum())} that gained.

No Newton iteration was left unconverged ({int(table["unconverged"].sum())} in {len(runs)} runs); {ended}. edmc had to
halve a step in {halved["runs_with_halvings"]} of its {halved["runs"]} runs, most of them at {STEPS_MS[-1]:g} ms and EA =
{STIFFNESSES[-1]:.0e} N.

Velocity Verlet's limit allows it in few of these cases, and is that of small motions: within it, an undamped cable that
goes slack and snaps taut gains energy all the same. Over {VERLET_TIME:g} s of the loose cable at EA = {VERLET_EA:.0e} N
the rise is {shares} of the limit; with a damping ratio of {VERLET_ZETAS[1]:g} it is {damped:.1g} at most.

Stiffness does not make edmc's steps dear: on the loose cable at {1e3 * ITERATIONS_STEP:g} ms, Newton iterations a step
are {numbers} N, the largest {counts.max() / counts.min():.2f} times the smallest.

What a scheme loses matters too. After {2 * DURATION:g} s of the loose cable at EA = {WHIP_EA:.0e} N and steps of
{1e3 * WHIP_STEP:g} ms, edmc has lost {-1e3 * lost["edmc"]:.2g} mJ, SDIRK2 {-1e3 * lost["sdirk2"]:.2g} mJ and backward Euler
{-1e3 * lost["backward_euler"]:.2g} mJ of a swing that is worth {1e3 * MASS * GRAVITY * LENGTH / 2:.3g} mJ; the implicit
midpoint rule has gained {lost["midpoint"]:.2g} J.

Left out: two-way springs, which hold no promise for any scheme; nets, where nothing else happens; and the accuracy of
what does not blow up, which is the study `speed`'s.
"""


if __name__ == "__main__":
    from studies.command_line import main

    main(["study", "energy_rise"])
