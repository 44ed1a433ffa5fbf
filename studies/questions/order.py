"""Does every scheme converge at its order, for positions and for velocities?"""

import json
import warnings
from functools import cache

import numpy as np
import pandas as pd

from anet_lumped import Cable, Fixed, Free, Scene, State, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.tables import AXIAL_STIFFNESS
from integrators import schemes
from studies.shown.scheme_styles import style
from studies.shown.sentences import counted, listed, percent, power
from studies.study import Drawing, Part, Record
from studies.sweeping.rows import run_rows

STUDY = Record(question=__doc__, part=Part.CURE)
TABLES = {
    "orders": "A line for each motion and scheme: the slope of its errors over the step, which should be its order.",
    "errors": "A line for each motion, scheme and step: relative errors of position and velocity at the end.",
}

PROBLEMS = ("spring and mass", "swing of a hanging chain")
STEPS = {  # in T_END, for explicit schemes and for implicit ones
    PROBLEMS[0]: ((40, 80, 160, 320), (40, 80, 160, 320)),
    PROBLEMS[1]: ((8000, 11_000, 16_000, 22_000), (50, 100, 200, 400)),
}
T_END = {PROBLEMS[0]: 0.7, PROBLEMS[1]: 0.5}  # [s]
PUSH = {PROBLEMS[0]: (0.0, 0.0, 0.1), PROBLEMS[1]: (0.5, 0.0, 0.0)}  # [m/s] velocity of the end at the start
FEW = {"dop853": ((4, 6, 8, 11), (700, 800, 1000, 1400))}  # steps in T_END of a scheme that is at round-off with those above
REFERENCE = 100_000  # steps of rk4 that the swings are compared with
NOISE, ROUGH = 1e-9, 0.3  # relative errors between which they count: above Newton's tolerance, and small
TOLERANCE = 0.15  # by which a slope may miss the order
CONSERVING = "edmc, rho_inf = 1"


def cases():
    """Method and rho_inf of every case, by its name."""
    return {name: (name, None) for name in schemes.names(own=True)} | {CONSERVING: ("edmc", 1.0)}


def scene(problem):
    """One undamped segment with a payload, or ten that hang freely, damped along so that only the swing is left."""
    payload, segments, EA, zeta = (1.0, 1, 100.0, 0.0) if problem == PROBLEMS[0] else (0.0, 10, 1e4, 1.0)
    cable = Cable("top", "end", length=1.0, mass_per_length=0.1, EA=EA, zeta=zeta, segments=segments)
    return Scene([Fixed("top", (0, 0, 0)), Free("end", mass=payload)], [cable], [Gravity(9.81)])


def start_of(problem):
    """The scene at rest, with velocities that grow with the distance from the top."""
    rest = equilibrium(scene(problem))
    nodes = rest.model.nodes("top-end")
    v = np.zeros_like(rest.q)
    v[nodes] = np.linspace(0.0, 1.0, len(nodes))[:, None] ** 2 * PUSH[problem]
    return State(rest.model, 0.0, rest.q, v, rest.segment_tension)


@cache
def exact(problem):
    """Displacement and velocity at the end, (n, 3) each: z = v/omega sin(omega t), or the swings of another method."""
    start = start_of(problem)
    if problem == PROBLEMS[1]:
        run = march("rk4", problem, start, REFERENCE)
        return run.q[-1] - start.q, run.v[-1]
    end, d, v = start.model.node("end"), np.zeros_like(start.q), np.zeros_like(start.q)
    omega, speed, t = np.sqrt(start.model.axial[0, AXIAL_STIFFNESS] / start.model.mass[end]), PUSH[problem][2], T_END[problem]
    d[end, 2], v[end, 2] = speed / omega * np.sin(omega * t), speed * np.cos(omega * t)
    return d, v


def march(method, problem, start, steps, rho_inf=None):
    """A run of ``steps`` steps, of which the end is saved."""
    t = T_END[problem]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # explicit Euler has no stable step, and converges all the same
        return simulate(start.scene, t, method=method, dt=t / steps, start=start, save_every=t, rho_inf=rho_inf)


def errors(row):
    """Relative errors of position and velocity at the end, for each step of one scheme on one motion."""
    problem, (method, rho_inf) = row["problem"], cases()[row["method"]]
    start, (d, v) = start_of(problem), exact(problem)
    number, found = PROBLEMS.index(problem), []
    explicit_steps, implicit_steps = STEPS[problem]
    usual = explicit_steps if schemes.scheme(method).explicit else implicit_steps
    for steps in FEW[method][number] if method in FEW else usual:
        run = march(method, problem, start, steps, rho_inf)
        found.append(
            {
                "step_s": T_END[problem] / steps,
                "position_error": float(np.abs(run.q[-1] - start.q - d).max() / np.abs(d).max()),
                "velocity_error": float(np.abs(run.v[-1] - v).max() / np.abs(v).max()),
                "status": run.status, "reason": run.message,
            }
        )  # fmt: skip
    return {"errors": json.dumps(found)}


def compute(quick=False, executor=None, out=None):
    """Errors at four steps, and the slopes fitted to them."""
    # edmc first, alone while it compiles what implicit schemes share; then neighbours compile different schemes
    tried = sorted(("verlet", "edmc") if quick else cases(), key=lambda case: case != "edmc")
    rows = [{"problem": problem, "method": method} for problem in PROBLEMS for method in tried]
    runs = run_rows(errors, rows, executor=executor, out=out and out / "errors")
    table = pd.DataFrame(
        {"problem": run.problem, "method": run.method, **one} for run in runs.itertuples() for one in json.loads(run.errors)
    )
    slopes = []
    for (problem, method), lines in table.groupby(["problem", "method"], sort=False):
        row = {"problem": problem, "method": method, "order": schemes.scheme(cases()[method][0]).order}
        slopes.append(row | {f"{what}_slope": slope(lines["step_s"], lines[f"{what}_error"]) for what in ("position", "velocity")})
    return {"orders": pd.DataFrame(slopes), "errors": table}


def slope(steps, errors):
    """Slope of errors over steps in both logarithms; NaN where fewer than two lie between NOISE and ROUGH."""
    seen = (errors > NOISE) & (errors < ROUGH)
    return float(np.polyfit(np.log(steps[seen]), np.log(errors[seen]), 1)[0]) if seen.sum() >= 2 else np.nan


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "errors": Drawing(
            _plot_errors(rows["errors"]),
            "Error of the position at the end over the step, one panel a motion. A scheme of order 2 falls by four where the step "
            "is halved. Points below 1e-9 are at Newton's tolerance or round-off.",
        )
    }


def _plot_errors(table):
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullFormatter

    figure = Figure(figsize=(9.5, 4.2), layout="constrained")
    panels = figure.subplots(1, len(STEPS), sharey=True)
    for panel, (problem, part) in zip(panels, table.groupby("problem", sort=False), strict=True):
        for method, line in part.groupby("method", sort=False):
            conserving = {"label": method, "mfc": "none", "ls": ":"} if method == CONSERVING else {}
            look = style(cases()[method][0]).of_line() | conserving
            panel.loglog(line.step_s * 1e3, line.position_error, ms=4, lw=1, **look)
        panel.set(title=problem, xlabel="step [ms]")
        panel.xaxis.set_minor_formatter(NullFormatter())
    panels[0].set_ylabel("error of position over displacement [-]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right center", fontsize=8, frameon=False)
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    orders = rows["orders"]
    off = {what: (orders[f"{what}_slope"] - orders["order"]).dropna() for what in ("position", "velocity")}
    both = pd.concat(off.values())
    words = [
        f"Of {counted(len(both), 'slope')} of errors over the step, for positions and for velocities, "
        f"{(both.abs() <= TOLERANCE).sum()} lie within {TOLERANCE:g} of the order of their scheme, and half of them within "
        f"{both.abs().median():.3f}.",
        " ".join(_exceptions(orders, what, of_what) for what, of_what in off.items()),
    ]
    text = ""
    if len(orders[(orders["method"] == "symplectic_euler") & (orders["position_slope"] > 1.5)]):
        text = (
            "Symplectic Euler reaches order 2 in the positions of an undamped motion that starts from rest in position, because "
            "it is velocity Verlet seen half a step apart. "
        )
    text += (
        f"Left out: errors above {percent(ROUGH)}, and errors below {power(NOISE)}, which Newton's tolerance and round-off leave"
    )
    unseen = orders[orders["position_slope"].isna()]
    if len(unseen):
        text += f": all of {listed(f'{_label(row.method)} in the {row.problem}' for row in unseen.itertuples())}"
    return "\n\n".join([*words, text + "."])


def _exceptions(orders, what, off):
    """Slopes that miss their order, by name."""
    below, above = orders.loc[off.index[off < -TOLERANCE]], orders.loc[off.index[off > TOLERANCE]]
    if not len(below) + len(above):
        return f"No slope of {what} errors is farther from its order."
    named = [f"{_named(rows, what)} {side} the order" for rows, side in ((below, "below"), (above, "above")) if len(rows)]
    return f"Farther from it are, of {what} errors: {'; '.join(named)}."


def _label(method):
    return method if method == CONSERVING else schemes.scheme(method).label


def _named(rows, what):
    return listed(
        f"{_label(row.method)} ({row.problem}, {getattr(row, f'{what}_slope'):.2f} for {row.order})" for row in rows.itertuples()
    )
