"""Summaries of a state at rest, a run, a scene before any run, advice and comparisons: plain dicts in SI units."""

import csv
import shlex
from dataclasses import asdict

import numpy as np

from anet_lumped.model.rest_lengths import at_time
from anet_lumped.model.tables import CABLE_SEGMENTS
from anet_lumped.results.end_forces import GROUND, UnknownForceError, end_forces_at_rest, rows_of_state
from anet_lumped.scene.scene import Free
from studies.shown.show import as_text
from studies.sweeping.measures import sag

ROUNDING = 1e-12  # of a net's size: what is left of a place that is 0
SOFT = 0.01  # static stretch worth a warning: cords under their working load stay below it


def rest_summary(state) -> dict:
    """Cables and free points of a state at rest, how well its forces balance, and whether it is stable."""
    return {
        "cables": [{"cable": cable.name} | row for cable, row in zip(state.scene.cables, _at_rest(state), strict=True)],
        "points": _points(state),
        "reactions": _reactions(state),
        **_bodies("bodies", state),
        "stable": state.stable,
        "residual": state.residual,
    }


def run_summary(run) -> dict:
    """Status, method and why, work, energy, and where the run ended."""
    result = {
        "status": run.status,
        "message": run.message,
        "method": run.method,
        "dt": run.dt,
        "reason": run.reason,
        "reached": run.t[-1],
        "wall_time": run.wall_time,
        "error_estimate_m": run.error_estimate,
        "tension_error_percent": 100.0 * run.tension_error,
    }
    return {name: value for name, value in result.items() if value is not None and value != ""} | {
        "work": [asdict(run.work)],
        "energy": [asdict(run.energy_balance)],
        **({"audit": [_audit(run.audit)]} if run.audit else {}),
        **({"events": [_event(event) for event in run.events]} if run.events else {}),
        **({"warning": list(run.warnings)} if run.warnings else {}),
        "cables": [
            {
                "cable": cable.name,
                "end_stretch": run.stretch(cable.name)[-1],
                "peak_stretch": run.stretch(cable.name).max(),
                "peak_segment_tension": run.peak_tension(cable.name),
                "peak_start_tension": _peak_at(run, cable, cable.start),
                "peak_end_tension": _peak_at(run, cable, cable.end),
            }
            for cable in run.scene.cables
        ],
        "points_at_the_end": _points(run.final),
        **_bodies("bodies_at_the_end", run.final),
    }


def _event(event) -> dict:
    return {
        "t_s": event.t, "event": event.kind, "where": event.where, "segment": event.segment, "tension": event.tension,
        "mass_kg": event.mass, "lost_J": event.lost,
    }  # fmt: skip


def _audit(audit) -> dict:
    return {
        "error_m": audit.error, "where": audit.where, "t_s": audit.t, "allowed_m": audit.allowed, "imbalance": audit.imbalance,
        "tension_error_percent": 100.0 * audit.tension_error, "wall_time": audit.wall_time, "passed": audit.passed,
    }  # fmt: skip


def recommendation_summary(found, scene, change=(), added=()) -> dict:
    """The recommended method for a scene (its name or file), its cost, the parts of its error, and the command to run it.

    ``change`` is what was changed in the scene first, as texts NAME=VALUE, and ``added`` are effects that were added to it.
    """
    cables = found.scene.cables
    alike = len({cable.segments for cable in cables}) == 1
    changes = {"segments": cables[0].segments} if alike else {f"{name}.segments": n for name, n in found.segments.items()}
    best = found.best
    stepping = f"--dt {best.dt:.6g}" if best.rtol is None else f"--rtol {best.rtol:.2g}"
    stepping += " --extrapolate" if best.extrapolate else ""
    before = [text for text in change if not text.partition("=")[0].strip().endswith("segments")]
    sets = [f"--effect {shlex.quote(text)}" for text in added] + [f"--set {shlex.quote(text)}" for text in before]
    sets = " ".join([*sets, *(f"--set {name}={n}" for name, n in changes.items())])
    unit, size = ("mm", 1e3) if found.unit == "m" else (found.unit, 1.0)
    named = {"best": best, "runner-up": found.runner_up, "with EA=inf": found.rigid}
    return {
        "recommended": [
            {
                "": name,
                "method": one.method + (", extrapolated" if one.extrapolate else ""),
                "step_ms": None if one.dt is None else 1e3 * one.dt,
                "rtol": one.rtol,
                f"time_error_{unit}": size * one.error,
                "times_faster": one.times_real_time,
            }
            for name, one in named.items()
            if one
        ],
        "segments": [{"cable": name, "segments": n} for name, n in found.segments.items()],
        "error": [
            {
                "of": found.of,
                f"asked_{unit}": size * found.error,
                f"segments_{unit}": size * found.segments_error,
                f"time_{unit}": size * found.time_error,
                **{
                    f"{name}_{unit}": size * value
                    for name, value in (("checked", found.checked_error), ("elasticity", found.elasticity))
                    if value is not None
                },
            }
        ],
        **({"stopped_before": found.left_out} if found.left_out else {}),
        **({"note": found.note} if found.note else {}),
        "simulated_for_s": found.t_end,
        "command": f"anet-lumped simulate {scene} --t-end {found.t_end:.4g} --method {best.method} {stepping} "
        f"{'' if found.start == 'equilibrium' else f'--start {found.start} '}{sets}",
    }


def effects_summary(found) -> dict:
    """Each effect of an audit: its numbers, what it changes, its cost, a verdict; and notes on effects that were not judged."""
    from anet_lumped.advice.effect_audit import NEEDED, NEGLIGIBLE

    return {
        "effects": _effects(found),
        "asked_for": f"{found.of} within {found.error:g} {found.unit}",
        "numerical_error_of_this_comparison": f"{found.known_to:.3g} {found.unit}",
        "simulated_for": f"{found.t_end:.4g} s by edmc at dt={found.dt:.3g} s",
        **({"stopped_before": ", ".join(found.left_out)} if found.left_out else {}),
        "notes": [f"{one.effect}: {one.reason}" for one in found.verdicts if one.verdict not in (NEEDED, NEGLIGIBLE)],
    }


def _effects(found):
    changes, size = ("changes_mm", 1e3) if found.unit == "m" else ("changes_N", 1.0)
    return [
        {
            "effect": one.effect.replace("_", " "),
            "in_the_scene": "yes" if one.present else "no",
            "dimensionless": ", ".join(f"{name} {as_text(value)}" for name, value in one.numbers.items()),
            changes: size * one.change,
            "cost_percent": 100.0 * one.cost,
            "explicit_steps": one.stiffness or None,
            "verdict": f"input missing: {one.missing}" if one.missing else one.verdict,
        }
        for one in found.verdicts
    ]


def prediction_summary(scene, dt: float | None = None) -> dict:
    """Predictions for a scene before any run: static stretch, top modes, the largest step of each method, warnings.

    With a step dt [s] also the stretch floor of the explicit methods: the smallest static stretch that it permits.
    """
    from anet_lumped.checks import check_number
    from anet_lumped.motion.stability import predict
    from anet_lumped.statics.equilibrium import EquilibriumError, equilibrium
    from integrators import schemes

    if dt is not None:
        check_number("dt", dt, "s", "the command", sign="positive")
    prediction = predict(scene)
    modes = prediction.modes.values()
    cables = [{"cable": mode.cable, "top_frequency": mode.omega, "damping_ratio": mode.zeta} for mode in modes]
    strains, warnings = {}, []
    try:
        rest = equilibrium(scene)
    except EquilibriumError as error:
        warnings.append(f"No static stretch, and so no stretch floor, is known: {error}")
    else:
        segments = rest.model.cable[:, CABLE_SEGMENTS]
        means = np.bincount(rest.model.cable_of, rest.segment_tension) / segments
        for row, found, cable, mean in zip(cables, _at_rest(rest), scene.cables, means.tolist(), strict=True):
            row |= found
            strains[cable.name] = cable.strain(mean)
            warnings += _about_rest(row, cable)
    methods = []
    for name, limit in prediction.limits.items():
        row = {"method": name, "largest_step": limit.step, "set_by": limit.cable}
        if dt is not None:
            row["stable"] = "yes" if dt <= limit.step else "no"
            if strains and schemes.scheme(name).explicit:
                floors = [float(prediction.stretch_floor(name, dt, cable, strain)) for cable, strain in strains.items()]
                row["stretch_floor"] = max(floors)
        methods.append(row | {"note": limit.note})
    unstable = [row["method"] for row in methods if row.get("stable") == "no"]
    if unstable:
        warnings.append(
            f"A step of {dt:g} s is beyond the largest stable step of {', '.join(unstable)}; "
            'take a smaller step or an implicit method such as "edmc".'
        )
    floor = "smallest stretch at rest, of a cable with another EA, at which the step is stable"
    explained = {"stretch_floor_is": floor} if dt is not None and strains else {}
    return {"cables": cables, "methods": methods} | explained | {"warning": warnings}


def ropes_summary(diameter: float) -> dict:
    """The ropes of the catalogue at a nominal diameter [m]."""
    from anet_lumped.checks import check_number
    from anet_lumped.scene.ropes import ROPES

    check_number("diameter", diameter, "m", "the command", sign="positive")
    rows, outside = [], []
    for name, rope in ROPES.items():
        low, high = rope.diameters or (np.nan, np.nan)
        if diameter < low or diameter > high:
            outside.append(f"{name} ({1e3 * low:.3g} to {1e3 * high:.3g} mm)")
        rows.append({
            "rope": name,
            "what": rope.about,
            "mass_per_metre_kg": rope.m2 * diameter**2,
            "EA": rope.static_EA(diameter),
            "breaking_load_N": rope.breaking_load(diameter),
            "outer_diameter_mm": 1e3 * rope.dv * diameter,
            "compared_from_mm": 1e3 * low,
            "to_mm": 1e3 * high,
            "source": rope.source,
        })  # fmt: skip
    warning = f"A diameter of {1e3 * diameter:.4g} mm is out of the range of {', '.join(outside)}: prefer the maker's data."
    return {"nominal_diameter_mm": 1e3 * diameter, "ropes": rows} | ({"warning": [warning]} if outside else {})


def write_effects(found, file) -> None:
    """Write the verdict on each effect as CSV, a row each, with its reason."""
    with file.open("w", newline="", encoding="utf-8") as text:
        rows = _effects(found)
        table = csv.DictWriter(text, [*rows[0], "reason"])
        table.writeheader()
        table.writerows(row | {"reason": one.reason} for row, one in zip(rows, found.verdicts, strict=True))


def write_nodes(state, file) -> None:
    """Write the position [m] of every node, cable by cable, as CSV."""
    with file.open("w", newline="", encoding="utf-8") as text:
        rows = csv.writer(text)
        rows.writerow(["cable", "node", "x", "y", "z"])
        for cable in state.scene.cables:
            rows.writerows([cable.name, i, *node] for i, node in enumerate(state.shape(cable.name).tolist()))


def _at_rest(state):
    """A row for each cable of a state at rest."""
    model, tension = state.model, state.segment_tension
    of_segments = np.linalg.norm(state.q[model.ends[:, 1]] - state.q[model.ends[:, 0]], axis=1)
    lengths = np.bincount(model.cable_of, of_segments)
    largest = np.full(len(lengths), -np.inf)
    np.maximum.at(largest, model.cable_of, tension)
    ends = np.linalg.norm(end_forces_at_rest(rows_of_state(state)), axis=2)
    slack = np.bincount(model.cable_of, tension <= 0.0) > 0
    rest_lengths = at_time(state.scene, state.t)
    return [
        {
            "stretch": length / rest_lengths.get(cable.name, cable.length) - 1,
            "sag": sag(state, cable.name),
            "start_tension": start,
            "end_tension": end,
            "segment_tension": top,
            "slack_segments": _ranges(np.flatnonzero(state.tension(cable.name) <= 0.0)) if any_slack else "",
        }
        for cable, length, top, (start, end), any_slack in zip(
            state.scene.cables, lengths.tolist(), largest.tolist(), ends.tolist(), slack.tolist(), strict=True
        )
    ]


def _about_rest(row, cable):
    if row["slack_segments"]:
        yield (
            f'Cable "{cable.name}" rests with slack segments, {row["slack_segments"]} of 0-{cable.segments - 1}: '
            "their tension is zero, and the shape of a slack stretch is not unique."
        )
    if row["stretch"] > SOFT:
        yield (
            f'Cable "{cable.name}" is {row["stretch"]:.2%} longer at rest than unstretched, more than {SOFT:.0%}: '
            f"EA = {cable.EA:g} N carries {row['segment_tension']:.3g} N."
        )


def _ranges(numbers):
    """ "0-3, 7" for 0, 1, 2, 3, 7."""
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1) if len(numbers) else []
    return ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 1 else f"{run[0]}" for run in runs)


def _points(state):
    """Positions of the points that move."""
    free = [point.name for point in state.scene.points if isinstance(point, Free)]
    return [{"point": name} | _xyz(_place(state, name)) for name in free]


def _place(state, name):
    """Position of a point or body, with 0 in place of what rounding leaves of it."""
    at = state.position(name)
    return np.where(np.abs(at) < ROUNDING * np.ptp(state.q), 0.0, at)


def _peak_at(run, cable, point):
    """Largest tension of a cable at a point [N]; None where that is not known, as of a point pushed from outside the scene."""
    try:
        return run.end_tension(cable.name, point).max()
    except UnknownForceError:
        return None


def _reactions(state):
    """Forces of supports, and of the ground if there is one, on the net."""
    scene = state.scene
    names = [point.name for point in scene.points if not isinstance(point, Free)]
    names += [body.name for body in scene.bodies if body.is_driven]
    names += [GROUND] if any(effect.is_ground for effect in scene.effects) and GROUND not in names else []
    return [{"support": name} | {f"{x}_N": f for x, f in _xyz(state.reaction(name)).items()} for name in names]


def _bodies(title, state):
    """A table of the places of bodies and of their rotations, as unit quaternions, if there are any."""
    rows = [
        {"body": body.name} | _xyz(_place(state, body.name)) | {"quaternion_wxyz": state.quaternion(body.name).tolist()}
        for body in state.scene.bodies
    ]
    return {title: rows} if rows else {}


def _xyz(vector):
    return dict(zip("xyz", vector, strict=True))
