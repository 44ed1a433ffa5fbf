"""At which steps, stiffnesses and dampers is each scheme stable, and why did the thesis's model fail when it was improved?

Two planes, (step, stiffness) and (step, damper), measured cell by cell for the schemes of this package and drawn under the
border that `anet_lumped.motion.stability` predicts before any run. The judge is the energy, which nothing puts in here, so that it
may only fall: surviving to the end is not enough.
"""

import warnings
from dataclasses import replace

import numpy as np

from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.motion.energy_gain import GAINED
from anet_lumped.motion.simulate import simulate
from anet_lumped.motion.stability import step_limit, top_modes
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.equilibrium import equilibrium
from integrators import schemes
from studies.sweeping.rows import run_rows

QUESTION = __doc__.splitlines()[0]

LENGTH, MASS, SEGMENTS, GRAVITY = 1.0, 0.1, 20, 9.81  # the thesis's cable [m], [kg], -, [m/s^2]
SEGMENT_MASS = MASS / SEGMENTS  # [kg]
WEIGHT_ENERGY = MASS * GRAVITY * LENGTH  # [J]
FOUND_EA = MASS * GRAVITY / (2 * 0.1)  # makes the hung cable 1.1 m long [N]: EA = m g/2 eps; study `length_error`
FOUND_K = FOUND_EA * SEGMENTS / LENGTH  # [N/m]
CORD_EA = 9e3  # 3 mm nylon [N]
STEPS = np.geomspace(1e-3, 0.1, 11)  # [s]
STIFFNESSES = np.geomspace(1.0, 1e8, 11)  # EA [N]
DAMPERS = np.geomspace(1e-3, 1e3, 11)  # of a segment [N s/m], beside springs of FOUND_K
DISTURBANCE = 1e-10  # energy put into random velocities about rest, over WEIGHT_ENERGY
REST_TIME, REST_STEPS = 2.0, 200  # [s] and steps at least
REST_GROWTH = 1e3  # unstable if the energy rises by more, over that of the disturbance
WHIP_TIME = 1.2  # [s]; the cable cracks at about 0.55 s
WHIP_RISE = 0.1  # unstable if the energy rises by more, over what the whole swing is worth
BORDER_EA = (FOUND_EA, 100.0, 1e4)  # where the border is measured to BORDER_RESOLUTION [N]
BORDER_DAMPERS = (0.05, 0.2, 2.0)  # [N s/m]
BORDER_STEPS, BORDER_RESOLUTION = 4000, 2e-3
CLOSE = 0.98  # of the largest stable step, where the thesis's cable is put
SEED = 1
NUMBERS = ("dt_s", "predicted_s", "rest_growth", "whip_rise")  # columns of a cell
OTHERS = ("rest_at_once", "rest_ended", "whip_ended")
LONG_EA, LONG_TIME = 1e4, 3.0  # [N], [s]: the whip of the schemes that do not damp, just within their border
LONG_SHARES, LONG_ZETAS = (0.5, 0.8, 0.95), (0.0, 0.05)  # of the largest stable step; damping ratios of a segment


# Scenes, starts and the judge ---------------------------------------------------------------------------------------


def hung(EA, damper=0.0, *, segments=SEGMENTS, compression="none", rate=0.0, tip=None):
    """The thesis's cable, held at its upper end.

    Parameters
    ----------
    EA : float [N]
    damper : float
        c of each segment [N s/m].
    rate : float
        Damping by the environment [1/s].
    tip : (3,) [m]
        Where the loose end starts, for `start="straight"`.

    Returns
    -------
    Scene
    """
    cable = Cable(
        "top", "tip", length=LENGTH, mass_per_length=MASS / LENGTH, EA=EA, BA=damper * LENGTH / segments,
        segments=segments, compression=compression,
    )  # fmt: skip
    effects = [Gravity(GRAVITY)] + [ViscousDamping(rate)] * (rate > 0)
    return Scene(points=[Fixed("top", (0.0, 0.0, 0.0)), Free("tip", at=tip)], cables=[cable], effects=effects)


def disturbed(scene, axes=(1.0, 1.0, 1.0)):
    """Rest with random velocities along `axes`, so that every mode has its share of an energy too small to matter.

    Returns
    -------
    State
    """
    rest = equilibrium(scene)
    n_free, mass = rest.model.n_free, rest.model.mass
    v = np.zeros_like(rest.q)
    v[:n_free] = np.random.default_rng(SEED).normal(size=(n_free, 3)) * axes
    v *= np.sqrt(DISTURBANCE * WEIGHT_ENERGY / (0.5 * mass[:, None] * v**2).sum())
    return replace(rest, v=v)


def energy_rise(run):
    """Largest mechanical energy of a run without driven points less that at its start, inf if it diverged [J]."""
    energy = run.energy[:, :3].sum(axis=1)
    return float(energy.max() - energy[0]) if run.reached_end and np.isfinite(energy).all() else np.inf


def rest_growth(scene, scheme, dt, steps=None, start=None):
    """Run about rest.

    Returns
    -------
    growth : float
        Rise of energy over that of the disturbance.
    at_once : bool
        The energy was largest right after the first steps: it overshot and fell, it did not grow.
    ended : str
    """
    duration = steps * dt if steps else max(REST_TIME, REST_STEPS * dt)
    run = quietly(scene, duration, method=scheme, dt=dt, start=start or disturbed(scene))
    at_once = run.reached_end and int(run.energy[:, :3].sum(axis=1).argmax()) <= 1
    return energy_rise(run) / (DISTURBANCE * WEIGHT_ENERGY), at_once, run.status


def whip_rise(scene, scheme, dt, duration=WHIP_TIME):
    """Run released from horizontal: rise of energy over what the swing is worth, and how the run ended."""
    run = quietly(scene, duration, method=scheme, dt=dt, start="straight")
    return energy_rise(run) / (WEIGHT_ENERGY / 2), run.status


def quietly(scene, t_end, **settings):
    """`simulate` without its warning that the step is too long, which is what is asked here."""
    with warnings.catch_warnings(action="ignore", category=UserWarning):
        return simulate(scene, t_end, **settings)


def explicit_schemes(**wanted):
    """Names of the explicit schemes of this package."""
    return schemes.names(own=True, explicit=True, **wanted)


def implicit_schemes():
    """Names of the implicit schemes of this package."""
    return schemes.names(own=True, explicit=False)


def label(scheme):
    """What figures and texts call a scheme."""
    return schemes.scheme(scheme).label


def predicted_step(scheme, scene):
    """Largest stable step of the scene's top axial mode [s]."""
    (mode,) = top_modes(scene).values()
    return float(step_limit(scheme, mode.omega, mode.zeta))


# The study ----------------------------------------------------------------------------------------------------------


def compute(quick=False, executor=None, out=None):
    """Tables of the study.

    Returns
    -------
    dict of pandas.DataFrame
        "planes" (a line a cell), "borders" (measured by bisection beside predicted), "long_whip" (just within them),
        "thesis" (its two failures).
    """
    every = 4 if quick else 1
    steps = list(STEPS[::every])
    lines = [
        {"plane": plane, "scheme": scheme, "EA_N": EA, "damper_Ns_per_m": c, "steps": steps}
        for scheme in explicit_schemes() + implicit_schemes()
        for plane, grid in (
            ("stiffness", [(EA, 0.0) for EA in STIFFNESSES[::every]]),
            ("damper", [(FOUND_EA, c) for c in DAMPERS[::every]]),
        )
        for EA, c in grid
    ]
    places = [(EA, 0.0) for EA in BORDER_EA[: 1 if quick else None]]
    places += [(FOUND_EA, c) for c in BORDER_DAMPERS[:: 2 if quick else 1]]
    borders = [
        {"scheme": scheme, "EA_N": EA, "damper_Ns_per_m": c}
        for scheme in explicit_schemes()
        for EA, c in places
        if c > 0 or schemes.scheme(scheme).stable_undamped
    ]
    long = [
        {"scheme": scheme, "share_of_limit": share, "zeta": zeta}
        for scheme in explicit_schemes(stable_undamped=True)
        for share in (LONG_SHARES[1:2] if quick else LONG_SHARES)
        for zeta in LONG_ZETAS
    ]
    planes = run_rows(line_of_cells, lines, executor=executor, out=out and out / "planes")
    planes = planes.drop(columns="steps").explode([*NUMBERS, *OTHERS], ignore_index=True)
    return {
        "planes": planes.astype(dict.fromkeys(NUMBERS, float)),
        "borders": run_rows(border, borders, executor=executor, out=out and out / "borders"),
        "long_whip": run_rows(long_whip, long, executor=executor, out=out and out / "long_whip"),
        "thesis": run_rows(failure, _failures(), executor=executor, out=out and out / "thesis"),
    }


def line_of_cells(row):
    """Cells of one stiffness and damper, for all steps: a list for each of NUMBERS and OTHERS."""
    scheme, EA, c = row["scheme"], row["EA_N"], row["damper_Ns_per_m"]
    # Two-way springs about rest, the thesis's law, are linear in the axial direction, for which the prediction is exact.
    about_rest, loose = hung(EA, c, compression="linear"), hung(EA, c, tip=(LENGTH, 0.0, 0.0))
    start, predicted, explicit = disturbed(about_rest), predicted_step(scheme, about_rest), schemes.scheme(scheme).explicit
    cells = []
    for dt in row["steps"]:
        rest, whip = (np.nan, False, ""), (np.nan, "")
        # An implicit scheme is put to the hard test first; where it fails, rest tells whether small motions grow as well.
        if not explicit:
            whip = whip_rise(loose, scheme, dt)
        if explicit or whip[0] > WHIP_RISE:
            rest = rest_growth(about_rest, scheme, dt, start=start)
        if explicit and rest[0] <= REST_GROWTH:
            whip = whip_rise(loose, scheme, dt)
        cells.append((dt, predicted, rest[0], whip[0], *rest[1:], whip[1]))
    return dict(zip((*NUMBERS, *OTHERS), map(list, zip(*cells, strict=True)), strict=True))


def border(row):
    """Largest stable step of an explicit scheme, by bisection: about rest with springs that push and that do not, whip."""
    scheme, EA, c = row["scheme"], row["EA_N"], row["damper_Ns_per_m"]
    predicted = predicted_step(scheme, hung(EA, c))
    # No axial damper acts on swings, which explicit Euler lets grow at any step: its border is that of axial motion.
    swings = schemes.scheme(scheme).stable_undamped
    axes = (1.0, 1.0, 1.0) if swings else (0.0, 0.0, 1.0)
    found = {}
    for name, compression in (("rest", "linear"), ("rest_one_way", "none")):
        scene = hung(EA, c, compression=compression)
        start = disturbed(scene, axes)
        found[name] = _largest_step(
            lambda dt, scene=scene, start=start: rest_growth(scene, scheme, dt, BORDER_STEPS, start)[0] <= REST_GROWTH,
            predicted,
        )
    if swings:
        loose = hung(EA, c, tip=(LENGTH, 0.0, 0.0))
        found["whip"] = _largest_step(lambda dt: whip_rise(loose, scheme, dt)[0] <= WHIP_RISE, predicted)
    return {"predicted_ms": 1e3 * predicted} | {f"{name}_over_predicted": h / predicted for name, h in found.items()}


def long_whip(row):
    """A longer whip just within the border: rise of energy over what the swing is worth."""
    damper = row["zeta"] * np.sqrt(LONG_EA * SEGMENTS / LENGTH * SEGMENT_MASS)
    loose = hung(LONG_EA, damper, tip=(LENGTH, 0.0, 0.0))
    dt = row["share_of_limit"] * predicted_step(row["scheme"], loose)
    rise, ended = whip_rise(loose, row["scheme"], dt, LONG_TIME)
    return {"dt_s": dt, "whip_rise": rise, "ended": ended}


def _largest_step(stable, about):
    low, high = about / 2, about * 2
    while high / low > 1 + BORDER_RESOLUTION:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return float(low)


def _failures():
    """The thesis's cable just within the border of each scheme, and what it tried next."""
    rows = []
    for scheme in ("symplectic_euler", "verlet", "rk4", "edmc"):
        dt = min(CLOSE * predicted_step(scheme, hung(FOUND_EA)), 0.01)
        for change, k, c, rate in (
            ("as found", 1.0, 0.0, 0.0),
            ("k × 1.2", 1.2, 0.0, 0.0),
            ("k × 10", 10.0, 0.0, 0.0),
            ("k × 10 and environment 2 /s", 10.0, 0.0, 2.0),
            ("c = m/dt", 1.0, SEGMENT_MASS / dt, 0.0),
            ("c = 10 m/dt", 1.0, 10 * SEGMENT_MASS / dt, 0.0),
        ):
            spring = k * FOUND_K
            rows.append({"scheme": scheme, "dt_s": dt, "change": change, "spring_N_per_m": spring,
                         "damper_Ns_per_m": c, "environment_per_s": rate})  # fmt: skip
    return rows


def failure(row):
    """The thesis's hanging cable with one thing changed: predicted step and damper, and what the energy does."""
    EA, rate = row["spring_N_per_m"] * LENGTH / SEGMENTS, row["environment_per_s"]
    scene = hung(EA, row["damper_Ns_per_m"], compression="linear", rate=rate)
    (mode,) = top_modes(scene).values()
    growth, _, ended = rest_growth(scene, row["scheme"], row["dt_s"])
    return {
        "length_m": equilibrium(scene).length("top-tip"),
        "largest_step_ms": 1e3 * float(step_limit(row["scheme"], mode.omega, mode.zeta, rate)),
        "energy_growth": growth,
        "stable": bool(growth <= REST_GROWTH),
        "ended": ended,
    }


# Figures and words --------------------------------------------------------------------------------------------------

STABLE, RISES, UNSTABLE = 0, 1, 2
COLORS = ("#d6e6f4", "#E69F00", "#5b2a6e")


def verdict(cells):
    """What the energy says of each cell: STABLE, RISES (in the whip, or at the very start and then falls) or UNSTABLE."""
    grows = (cells["rest_growth"] > REST_GROWTH) & ~cells["rest_at_once"].astype(bool)
    rises = (cells["whip_rise"] > WHIP_RISE) | (cells["rest_growth"] > REST_GROWTH)
    return np.where(grows, UNSTABLE, np.where(rises, RISES, STABLE))


def survived(cells):
    """Whether the run by which a cell failed reached its end all the same."""
    ended = cells["whip_ended"].where(cells["whip_rise"] > WHIP_RISE, cells["rest_ended"])
    return (verdict(cells) != STABLE) & ended.isin(("done", GAINED))


def plot(rows):
    """Figures of the study, {name: matplotlib Figure}."""
    cells = rows["planes"].dropna(subset="dt_s")
    return {
        "step_and_stiffness": _plot_plane(cells[cells["plane"] == "stiffness"], "EA_N", rows["thesis"]),
        "step_and_damper": _plot_plane(cells[cells["plane"] == "damper"], "damper_Ns_per_m", rows["thesis"]),
    }


def _plot_plane(cells, ordinate, thesis):
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure = Figure(figsize=(13, 5.6), layout="constrained")
    lines = explicit_schemes(), implicit_schemes()
    panels = figure.subplots(2, max(map(len, lines)), sharex=True, sharey=True)
    cells = cells.assign(verdict=verdict(cells))
    drawn = []
    for row, line in zip(panels, lines, strict=True):
        drawn += zip(row, line, strict=False)
        for axes in row[len(line) :]:
            axes.remove()
    for axes, scheme in drawn:
        here = cells[cells["scheme"] == scheme]
        grid = here.pivot(index=ordinate, columns="dt_s", values="verdict")
        steps, ordinates = 1e3 * grid.columns.to_numpy(float), grid.index.to_numpy(float)
        axes.pcolormesh(steps, ordinates, grid, cmap=ListedColormap(COLORS), vmin=0, vmax=2)
        alive = here[survived(here)]
        axes.plot(1e3 * alive["dt_s"], alive[ordinate], ".", ms=3, color="w")
        axes.set(xscale="log", yscale="log", title=label(scheme))
        limits = axes.get_xlim(), axes.get_ylim()
        _draw_border(axes, scheme, ordinate, limits[1])
        _draw_thesis(axes, scheme, ordinate, thesis)
        axes.set(xlim=limits[0], ylim=limits[1])
    if ordinate == "EA_N":
        for axes in figure.axes:
            axes.axhline(CORD_EA, color="k", lw=0.8, ls=":")
        panels[0, len(lines[0]) - 1].text(STEPS[-1] * 1e3, 1.3 * CORD_EA, "3 mm nylon ", ha="right", fontsize=8)
    panels[1, 3].set_xlabel("step [ms]", fontsize=11)
    name = "axial stiffness EA [N]" if ordinate == "EA_N" else f"damper of a segment c [N s/m], spring {FOUND_K:.0f} N/m"
    figure.supylabel(name, fontsize=11)
    handles = [
        Patch(color=COLORS[STABLE], label="energy does not rise"),
        Patch(color=COLORS[RISES], label="rises in the whip or at the very start"),
        Patch(color=COLORS[UNSTABLE], label="small motions about rest grow without end"),
        Line2D([], [], marker="o", ls="", ms=5, mfc="0.6", mec="0.6", label="white dot: yet ran to its end"),
        Line2D([], [], color="k", lw=2, label="predicted border"),
        Line2D([], [], color="k", lw=1.5, ls="--", label="of axial modes alone"),
        Line2D([], [], marker="*", ls="", ms=11, mfc="w", mec="k", label="the thesis's cable: 1.1 m, no damper"),
        Line2D([], [], marker="^", ls="-", color="#009E73", label="what it tried"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return figure


def _draw_border(axes, scheme, ordinate, limits):
    """Predicted step over stiffness or damper; for explicit Euler, which no swing survives, that of axial modes."""
    if not schemes.scheme(scheme).explicit:
        return
    values = np.geomspace(*limits, 300)
    EA, c = (values, 0.0 * values) if ordinate == "EA_N" else (np.full(300, FOUND_EA), values)
    (mode,) = top_modes(hung(1.0)).values()
    omega = mode.omega * np.sqrt(EA)
    steps = step_limit(scheme, omega, c * LENGTH / SEGMENTS / EA * omega / 2)
    style = {"lw": 2} if schemes.scheme(scheme).stable_undamped else {"ls": "--", "lw": 1.5}
    axes.plot(1e3 * np.where(steps > 0, steps, np.nan), values, color="k", **style)


def _draw_thesis(axes, scheme, ordinate, thesis):
    """The thesis's cable and what was tried next, at the step that the thesis's table has for the scheme."""
    steps = thesis.groupby("scheme")["dt_s"].first()
    step = 1e3 * steps.get(scheme, steps["edmc"])
    if ordinate == "EA_N":
        low, high = FOUND_EA, 10 * FOUND_EA
    else:
        low, high = DAMPERS[0], 10 * SEGMENT_MASS / (step / 1e3)
    axes.plot([step, step], [low, high], color="#009E73", lw=1.5)
    axes.plot(step, high, "^", color="#009E73", ms=6)
    axes.plot(step, low, "*", ms=11, mfc="w", mec="k", clip_on=False)


def answer(rows):
    """The answer in words, with the numbers of `rows`."""
    cells, borders, thesis = rows["planes"].dropna(subset="dt_s"), rows["borders"], rows["thesis"]
    cells = cells.assign(verdict=verdict(cells), survived=survived(cells))
    limited = cells[cells["scheme"].isin(explicit_schemes(stable_undamped=True))]
    right = (limited["verdict"] == UNSTABLE) == (limited["dt_s"] > limited["predicted_s"])
    euler = cells[cells["scheme"] == "explicit_euler"]
    failed = cells[cells["verdict"] != STABLE]
    tried = thesis.set_index(["scheme", "change"])
    lines = []
    for scheme in implicit_schemes():
        here = cells[cells["scheme"] == scheme]
        bad = here[here["verdict"] != STABLE]
        if len(bad):
            k, c = (int((bad["plane"] == plane).sum()) for plane in ("stiffness", "damper"))
            most = bad["whip_rise"].replace(np.inf, np.nan).max()
            lost = int(np.isinf(bad["whip_rise"]).sum())
            lines.append(
                f"{label(scheme)} in {k} cells of the first plane and {c} of the second, by up to {most:.1e} times the "
                f"swing's worth" + (f", and without bound in {lost}" if lost else "")
            )
    quiet = [scheme for scheme in implicit_schemes() if (cells[cells["scheme"] == scheme]["verdict"] == STABLE).all()]
    quietest = ", ".join(f"{label(s)} {max(cells[cells['scheme'] == s]['whip_rise'].max(), 0):.1g}" for s in quiet)
    start = cells[cells["scheme"].isin(implicit_schemes()) & (cells["rest_growth"] > REST_GROWTH) & cells["rest_at_once"]]
    overshoot = ""
    if len(start):
        who = " and ".join(label(scheme) for scheme in start["scheme"].unique())
        overshoot = f"""About rest, {who} also overshoots in its first step, in {len(start)} cells with heavy dampers, by
up to {start["rest_growth"].max():.0e} times the disturbance, and then calms down. """
    about_rest = borders[borders["scheme"] != "explicit_euler"]
    off = (about_rest[["rest_over_predicted", "rest_one_way_over_predicted"]] - 1).abs().max()
    undamped = about_rest[about_rest["damper_Ns_per_m"] == 0]["whip_over_predicted"]
    damped = about_rest[about_rest["damper_Ns_per_m"] > 0]["whip_over_predicted"]

    def long(scheme, zeta):
        table = rows["long_whip"]
        chosen = (table["scheme"] == scheme) & (table["zeta"] == zeta) & (table["share_of_limit"] == LONG_SHARES[1])
        return table[chosen]["whip_rise"].iloc[0]

    def limit(scheme, change):
        row = tried.loc[(scheme, change)]
        return f"{row.largest_step_ms:.2f} ms"

    step = 1e3 * thesis.groupby("scheme")["dt_s"].first()
    stiffer = [s for s in ("symplectic_euler", "verlet", "rk4") if not tried.loc[(s, "k × 1.2"), "stable"]]
    heavier = [s for s in ("symplectic_euler", "verlet", "rk4") if not tried.loc[(s, "c = m/dt"), "stable"]]
    all_edmc = bool(tried.loc["edmc", "stable"].all())
    return f"""
Both failures of the thesis are the border of explicit steps, which is known before any run. Its cable of 1.1 m, 20
springs of {FOUND_K:.0f} N/m, is stable with RK4 up to {limit("rk4", "as found")} and with symplectic Euler up to
{limit("symplectic_euler", "as found")}: at a step of about 10 ms it lies on the border, and stiffer springs as well as
dampers lead across it. The implicit `edmc` has no border: at 10 ms it is stable in {"all" if all_edmc else "not all"} of
the thesis's attempts, and its energy rises in {int((cells[cells["scheme"] == "edmc"]["verdict"] != STABLE).sum())} of
{int((cells["scheme"] == "edmc").sum())} cells, over EA = {cells["EA_N"].min():g} to {cells["EA_N"].max():.0e} N, dampers of
{DAMPERS[0]:g} to {DAMPERS[-1]:g} N s/m and steps of {1e3 * STEPS[0]:g} to {1e3 * STEPS[-1]:g} ms.

First failure, k raised: at {step["rk4"]:.1f} ms with RK4 (98 % of its limit) the cable as found is stable; springs 1.2
times as stiff have a limit of {limit("rk4", "k × 1.2")}, ten times as stiff {limit("rk4", "k × 10")}, since the limit falls
as 1/√k. Of symplectic Euler, Verlet and RK4, each at 98 % of its own limit, {len(stiffer)} of 3 blow up at 1.2 k.
Damping by the environment does not help, as the top mode has turned many times before it acts: with 2 /s the limit at
10 k is {limit("rk4", "k × 10 and environment 2 /s")}.

Second failure, dampers added: symplectic Euler needs k dt² + 2 c dt < m. A damper of c = m/dt would stop two neighbours
within half a step; the explicit step overshoots and turns their speed round, by more each time. With c = m/dt the
limits fall to {limit("symplectic_euler", "c = m/dt")} (symplectic Euler), {limit("verlet", "c = m/dt")} (Verlet, which
takes the damper's force at a predicted speed and tolerates half as much) and {limit("rk4", "c = m/dt")} (RK4), and
{len(heavier)} of 3 blow up; with c = 10 m/dt RK4's limit is {limit("rk4", "c = 10 m/dt")}.

Measured against predicted: about rest {int(right.sum())} of {len(right)} cells of symplectic Euler, Verlet, RK4 and DOP853 are on
the predicted side. By bisection the border is within {100 * off.iloc[0]:.1f} % of the prediction with two-way springs and
within {100 * off.iloc[1]:.1f} % with springs that cannot push. Explicit Euler fails in
{int((euler["verdict"] != STABLE).sum())} of {len(euler)} cells, inside the wedge that its axial modes would allow as well:
nothing damps its swings.

The whip (released from horizontal) is harder and softer. With dampers of {BORDER_DAMPERS[0]:g} to {BORDER_DAMPERS[-1]:g} N
s/m its border lies at {damped.min():.2f} to {damped.max():.2f} times the prediction: a cable that cannot push lets go of its
damper. Without, it lies at {undamped.min():.2f} to {undamped.max():.2f} times: segments that turn slack and taut again kick
the energy of a scheme that does not damp, long before small motions grow. In {LONG_TIME:g} s at EA = {LONG_EA:g} N and
{100 * LONG_SHARES[1]:.0f} % of the predicted limit it rises by {long("symplectic_euler", 0.0):.2g} (symplectic Euler),
{long("verlet", 0.0):.2g} (Verlet), {long("rk4", 0.0):.2g} (RK4) and {long("dop853", 0.0):.2g} times (DOP853) what the swing is
worth; with a damping ratio of {LONG_ZETAS[1]:g} in each segment by {long("symplectic_euler", LONG_ZETAS[1]):.2g},
{long("verlet", LONG_ZETAS[1]):.2g}, {long("rk4", LONG_ZETAS[1]):.2g} and {long("dop853", LONG_ZETAS[1]):.2g}. A loose cable
needs some damping or a margin; DOP853, whose steps are the longest, needs half of its limit, or its own choice of steps.

Implicit schemes, none of which has a border in linear theory: the energy never rises beyond the judge's 10 % with
{quietest or "none"} (largest rise in the whip, over the swing's worth of {WEIGHT_ENERGY / 2:.2f} J). It rises with
{"; ".join(lines) or "none"}.
{overshoot}Linear stability is about small motions; a slackening cable is another matter. Survival would have hidden it:
of the {len(failed)} cells that fail, {int(failed["survived"].sum())} ran to their end.

The judge: nothing puts energy in, so it may only fall. A cell is unstable if the energy of a disturbance of
{DISTURBANCE:g} m g L about rest grows by more than {REST_GROWTH:g} times within {REST_TIME:g} s or {REST_STEPS} steps, or
if the whip's, in {WHIP_TIME:g} s, rises by more than {100 * WHIP_RISE:.0f} % of what the swing is worth. The bounded
oscillation of energy that a symplectic step shows about rest just within its border is below that.

Left out: adaptive schemes, whose step is not given. Damping of the motion, which backward Euler pays its stability with,
is not judged here. The thesis's solver and step are not known, so that the marks are an inference from the stretch that
it states.
"""


if __name__ == "__main__":
    from studies.command_line import main

    main(["study", "stability_map"])
