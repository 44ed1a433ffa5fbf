"""The thesis's cable at rest in its arrangements: how far it stretches, and the least stretch that an explicit step permits."""

from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.optimize import brentq
from scipy.special import jn_zeros

from anet_lumped.advice.compare import compare, rmse
from anet_lumped.effects import Gravity
from anet_lumped.motion.stability import frequency_limit, hanging_stretch_floor, step_limit, top_modes
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary_net import catenary_net
from anet_lumped.statics.equilibrium import equilibrium
from studies.sweeping.rows import run_rows
from studies.thesis_cable import CORD_EA, GRAVITY, LENGTH, MASS, REST_GROWTH, energy_rise, quietly, rest_growth

SPANS = {"0.5 m apart": 0.5, "0.8 m apart": 0.8, "1.0 m apart": 1.0}  # of the supports [m]
ARRANGEMENTS = ("hung", *SPANS, "two cables")
STIFFNESSES = np.geomspace(1.0, 1e6, 13)  # EA [N]
SEGMENTS = (5, 10, 20, 40, 80, 160)
THESIS_SEGMENTS, THESIS_STRETCH = 20, 0.10
REFINED = (4, 10, 20, 40, 80, 160)  # segments at which the sag's error is taken, even for a node at the lowest point
INEXTENSIBLE = 1e9  # EA that stands for it [N]
STEPS = (1e-3, 1e-2)  # [s]
SCHEMES = ("symplectic_euler", "rk4")
FLOOR_STEPS, FLOOR_RESOLUTION = 2000, 2e-3
CURED = (1e1, 1e2, 1e4, 1e6, 1e9)  # EA [N]
SWING_RATE, SWING_TIME = 1.0, 2.0  # [rad/s], [s]


def arrangement(name, EA, segments, *, full_ends=False):
    """The thesis's cable of 1 m and 0.1 kg in one of its arrangements.

    Parameters
    ----------
    name : one of ARRANGEMENTS
        "hung" from one end, between two supports at the same height, or two cables from supports 1 m apart to p0.
    EA : float [N]
    segments : int
    full_ends : bool
        The loose end carries the mass of a whole segment instead of a half.

    Returns
    -------
    Scene
        All that is asked of it is asked of its first cable, the others being alike.
    """
    extra = MASS / segments / 2 if full_ends else 0.0
    if name == "hung":
        points = [Fixed("s0", (0.0, 0.0, 0.0)), Free("tip", mass=extra)]
        ends = [("s0", "tip")]
    elif name == "two cables":
        points = [Fixed("s0", (0.0, 0.0, 0.0)), Fixed("s1", (1.0, 0.0, 0.0)), Free("p0", mass=extra)]
        ends = [("s0", "p0"), ("s1", "p0")]
    else:
        points = [Fixed("s0", (0.0, 0.0, 0.0)), Fixed("s1", (SPANS[name], 0.0, 0.0))]
        ends = [("s0", "s1")]
    material = {"length": LENGTH, "mass_per_length": MASS / LENGTH, "EA": EA, "segments": segments}
    return Scene(points=points, cables=[Cable(*pair, **material) for pair in ends], effects=[Gravity(GRAVITY)])


def stretch(scene):
    """Mean stretch of the first cable at rest."""
    return equilibrium(scene).length(scene.cables[0].name) / LENGTH - 1


def exact(scene, elastic=True):
    """First cable of the continuous net, a catenary."""
    positions = {point.name: point.at or (0.5, 0.0, -0.5) for point in scene.points}
    return catenary_net(scene, positions, elastic=elastic).cables[scene.cables[0].name]


def compute(quick=False, executor=None, out=None):
    """The tables."""
    segments = SEGMENTS[:3] if quick else SEGMENTS
    every = 3 if quick else 1
    shapes = [
        {"arrangement": name, "EA_N": EA, "segments": n}
        for name in ARRANGEMENTS
        for n in (segments if name in ("hung", "0.8 m apart") else (THESIS_SEGMENTS,))
        for EA in STIFFNESSES[::every]
    ]
    floors = [
        {"arrangement": name, "scheme": scheme, "dt_s": dt, "segments": n}
        for name in (("hung", "two cables") if quick else ARRANGEMENTS)
        for n in (segments if name == "hung" else (THESIS_SEGMENTS,))
        for scheme in SCHEMES
        for dt in STEPS
    ]
    cures = [
        {"scheme": scheme, "dt_s": dt, "EA_N": EA}
        for scheme in ("rk4", "edmc")
        for dt in STEPS
        for EA in (CURED[1::2] if quick else CURED)
    ]
    return {
        "shape": run_rows(shape, shapes, executor=executor, out=out and out / "shape"),
        "springs": pd.DataFrame([springs(name) for name in ARRANGEMENTS]),
        "refinement": pd.DataFrame([refinement(n) for n in (REFINED[:4] if quick else REFINED)]),
        "floor": run_rows(floor, floors, executor=executor, out=out and out / "floor"),
        "cure": run_rows(cure, cures, executor=executor, out=out and out / "cure"),
    }


def shape(row):
    """Stretch, and distance of the nodes from both catenaries at the same unstretched arc length."""
    scene = arrangement(row["arrangement"], row["EA_N"], row["segments"])
    nodes = equilibrium(scene).shape(scene.cables[0].name)
    arc = np.linspace(0.0, LENGTH, row["segments"] + 1)
    elastic = exact(scene)
    found = {
        "stretch": stretch(scene),
        "stretch_catenary": elastic.length / LENGTH - 1,
        "rmse_elastic_mm": 1e3 * rmse(elastic.point(arc), nodes),
        "rmse_inextensible_mm": np.nan,
    }
    if row["arrangement"] != "1.0 m apart":  # where a cable that does not stretch would be a straight line
        found["rmse_inextensible_mm"] = 1e3 * rmse(exact(scene, elastic=False).point(arc), nodes)
    return found


def springs(name):
    """Spring of a segment that makes the cable 1.1 m long, and the steps that it permits."""

    def find(stretch_at):
        return np.exp(brentq(lambda log_EA: stretch_at(np.exp(log_EA)) - THESIS_STRETCH, 0.0, 5.0, xtol=1e-12))

    def lumped(EA, **ends):
        return arrangement(name, EA, THESIS_SEGMENTS, **ends)

    EA = find(lambda EA: stretch(lumped(EA)))
    per_segment = THESIS_SEGMENTS / LENGTH
    omega = max(mode.omega for mode in top_modes(lumped(EA)).values())
    joined = name in ("hung", "two cables")  # to a free point, whose mass counts
    full = find(lambda EA: stretch(lumped(EA, full_ends=True))) if joined else np.nan
    return {
        "arrangement": name,
        "spring_N_per_m": EA * per_segment,
        "spring_full_end_mass_N_per_m": full * per_segment,
        "EA_N": EA,
        "catenary_EA_N": find(lambda EA: exact(lumped(EA)).length / LENGTH - 1),
        "cord_is_stiffer_by": CORD_EA / EA,
        **{f"{scheme}_step_ms": 1e3 * float(step_limit(scheme, omega)) for scheme in SCHEMES},
    }


def refinement(segments):
    """Errors of the discretisation alone, of a cable that hardly stretches."""
    between = compare(equilibrium(arrangement("0.8 m apart", INEXTENSIBLE, segments)), elastic=False).cables[0]
    bessel = jn_zeros(0, 1)[0] / 2 * np.sqrt(GRAVITY / LENGTH)
    row = {"segments": segments, "sag_error_mm": 1e3 * abs(between.sag_error)}
    for full in (False, True):
        name = "full" if full else "half"
        row[f"swing_error_{name}_end_mass_percent"] = 100 * abs(slowest_swing(segments, full) / bessel - 1)
    return row


def slowest_swing(segments, full_ends):
    """Frequency of the first small swing of the hanging chain that does not stretch [rad/s]."""
    mass = np.full(segments, MASS / segments)
    mass[-1] *= 1.0 if full_ends else 0.5
    per_length = np.cumsum(mass[::-1])[::-1] * GRAVITY / (LENGTH / segments)  # tension over length, from the top
    stiffness = np.diag(per_length + np.append(per_length[1:], 0.0))
    stiffness -= np.diag(per_length[1:], 1) + np.diag(per_length[1:], -1)
    return float(np.sqrt(np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass)))[0]))


def floor(row):
    """Stretch at the largest EA that a step permits, as predicted and by bisection over runs from rest."""
    name, scheme, dt, segments = row["arrangement"], row["scheme"], row["dt_s"], row["segments"]
    omega = max(mode.omega for mode in top_modes(arrangement(name, 1.0, segments)).values())
    predicted = (frequency_limit(scheme, dt) / omega) ** 2  # omega^2 grows as EA
    low, high = predicted / 4, predicted * 4
    while high / low > 1 + FLOOR_RESOLUTION:
        middle = np.sqrt(low * high)
        stable = rest_growth(arrangement(name, middle, segments), scheme, dt, FLOOR_STEPS)[0] <= REST_GROWTH
        low, high = (middle, high) if stable else (low, middle)
    found = {
        "EA_predicted_N": predicted,
        "EA_measured_N": low,
        "floor_predicted": stretch(arrangement(name, predicted, segments)),
        "floor_measured": stretch(arrangement(name, low, segments)),
    }
    if name == "hung":
        found["floor_closed_form"] = float(hanging_stretch_floor(scheme, dt, LENGTH, segments, GRAVITY))
    return found


def cure(row):
    """The hung cable swings: how far it stretches, and what its energy does."""
    scene = arrangement("hung", row["EA_N"], THESIS_SEGMENTS)
    rest = equilibrium(scene)
    v = np.zeros_like(rest.q)
    v[:, 0] = SWING_RATE * (rest.q[:, 2] - rest.position("s0")[2])
    run = quietly(scene, SWING_TIME, method=row["scheme"], dt=row["dt_s"], start=replace(rest, v=v))
    length = run.length("s0-tip")
    return {
        "stretch_at_rest": rest.length("s0-tip") / LENGTH - 1,
        "largest_stretch": length.max() / LENGTH - 1 if run.reached_end else np.inf,
        "energy_rise": energy_rise(run) / run.energy[0, 0],
        "newton_per_step": run.work.newton_iterations / run.work.steps,
        "ended": run.status,
    }


def shown_segments(table):
    """Number of segments of the thesis, or the most that there are."""
    return min(THESIS_SEGMENTS, table["segments"].max())
