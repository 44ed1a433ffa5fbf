"""Table 5.1 of the thesis made again by its own method, and p0 by a balance of forces."""

import math
import time
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary import catenary
from anet_lumped.statics.catenary_net import catenary_net
from anet_lumped.statics.equilibrium import equilibrium
from studies.accuracy_cost.paired_timing import seconds_of, take_turns

LENGTH = 1.0  # of each cable [m]
SUPPORTS = np.array([(0.0, 1.0), (1.0, 1.0)])  # thesis, section 5.1.3: p1 and p2, (x, z) [m]
REFERENCE = 0.2036  # height of p0 that Table 5.1 is measured against, as the thesis rounds it [m]
LOWEST = 1 - math.sqrt(3) / 2  # both cables straight: the lower end of the search line [m]
TABLE_5_1 = [  # samples of p0, points per cable, computation time [s], error in z [cm]
    (10, 10, 2.5, 3.0),
    (100, 10, 7.0, -2.59),
    (100, 50, 19.0, -0.84),
    (100, 100, 40.0, -0.04),
    (200, 100, 70.0, -0.43),
    (200, 500, 310.0, 0.0),
]
MOTION_S = 4.0  # section 5.1.5
SPEED = 0.2  # [m/s]
MOTION = {"two cables": 14.5 * 60, "four cables": 30 * 60}  # stated computation time [s], the second "more than"
PAIRS, QUICK_PAIRS = 15, 6  # turns in which ways to find p0 are timed
SAMPLING, CATENARIES = "sampling, 200 × 500", "catenaries, Newton in Python"
LUMPED = {segments: f"lumped, 2 × {segments} segments" for segments in (20, 160)}


# The thesis's method ------------------------------------------------------------------------------------------------


def point_heights(z0, points):
    """Heights of the points of one cable for one p0 = (1/2, z0).

    Parameters
    ----------
    z0 : float [m]
    points : int
        Equal in arc length, both ends included.

    Returns
    -------
    (points,) float64 [m], from the support to p0
    """
    arc = np.linspace(0.0, LENGTH, points)
    p0 = np.array([0.5, z0])
    if math.dist(SUPPORTS[0], p0) >= LENGTH * (1 - 1e-12):  # the lowest sample of all: straight
        return SUPPORTS[0][1] + (z0 - SUPPORTS[0][1]) * arc / LENGTH
    return catenary(SUPPORTS[0], p0, LENGTH).point(arc)[:, 1]


def mean_height(z0, points, weights="equal"):
    """Potential energy of Eq. 5.1 over the weight; by symmetry both cables have the same.

    Parameters
    ----------
    z0 : float [m]
    points : int
    weights : "equal" or "trapezoid"
        Every point with the same mass, or the two end points with half of it.

    Returns
    -------
    float [m]
    """
    mass = np.ones(points)
    if weights == "trapezoid":
        mass[[0, -1]] = 0.5
    return float(mass @ point_heights(z0, points) / mass.sum())


def sample_p0(samples, points, weights="equal"):
    """Height of p0 by the thesis's method: the sample of least energy.

    Parameters
    ----------
    samples, points : int
        Samples of p0 on the symmetry line, points per cable.
    weights : "equal" or "trapezoid"

    Returns
    -------
    float [m]
    """
    line = np.linspace(LOWEST, SUPPORTS[0][1], samples)
    return float(line[np.argmin([mean_height(z0, points, weights) for z0 in line])])


def least_energy_p0(points, weights):
    """The same without the samples' grid: what the weights alone make of p0 [m]."""
    found = minimize_scalar(mean_height, bounds=(LOWEST, 0.9), args=(points, weights), method="bounded", options={"xatol": 1e-10})
    return float(found.x)


# The balance of forces ----------------------------------------------------------------------------------------------


def hanging_scene(supports, *, payload=0.0, segments=20, EA=1e9):
    """Cables of 1 m from each support to p0; stiff enough that p0 is the inextensible one's to a nanometre.

    Parameters
    ----------
    supports : (n, 3) [m]
    payload : float
        Mass at p0 over the mass of one cable.
    segments : int
    EA : float [N]

    Returns
    -------
    Scene
    """
    start = np.mean(supports, axis=0) - (0.0, 0.0, 0.5)
    return Scene(
        points=[Fixed(f"s{i}", at) for i, at in enumerate(supports)] + [Free("p0", 0.1 * payload, tuple(start))],
        cables=[Cable(f"s{i}", "p0", length=LENGTH, mass_per_length=0.1, EA=EA, segments=segments) for i in range(len(supports))],
        effects=[Gravity(9.81)],
    )


def two_supports():
    """Supports of Table 5.1 in 3-D, (2, 3) [m]."""
    return np.insert(SUPPORTS, 1, 0.0, axis=1)


def four_supports():
    """Supports of the four-cable net, which the thesis does not state: a square of 1 m at the same height."""
    return np.array([(-0.5, -0.5, 1.0), (0.5, -0.5, 1.0), (0.5, 0.5, 1.0), (-0.5, 0.5, 1.0)])


def balance_p0(scene):
    """p0 of the continuous net by Newton's method on the forces, from the scene's own place of it, (3,) [m]."""
    return catenary_net(scene, {point.name: point.at for point in scene.points}).points["p0"]


def moved(scene, x):
    """The scene moved by x [m] along the first axis."""
    return replace(scene, points=tuple(replace(point, at=(point.at[0] + x, *point.at[1:])) for point in scene.points))


# The study ----------------------------------------------------------------------------------------------------------


def compute(quick=False, executor=None, out=None):
    """The tables; everything that is timed runs one by one in this process."""
    exact = balance_p0(hanging_scene(two_supports()))[2]
    force_balance, turns = _force_balance(exact, QUICK_PAIRS if quick else PAIRS)
    return {
        "table_5_1": _table_5_1(exact),
        "bias": _bias(exact, (10, 20, 50, 100) if quick else (5, 10, 20, 50, 100, 200, 500)),
        "energy": _energy(),
        "force_balance": force_balance,
        "turns": turns,
        "motion": _motion(poses=20 if quick else 400),
    }


def _table_5_1(exact):
    rows = []
    for samples, points, thesis_time, thesis_error in TABLE_5_1:
        began = time.perf_counter()
        z0 = sample_p0(samples, points)
        taken = time.perf_counter() - began
        rows.append(
            {
                "samples": samples,
                "points": points,
                "thesis_error_cm": thesis_error,
                "error_cm": 100 * (z0 - REFERENCE),
                "half_end_masses_error_cm": 100 * (sample_p0(samples, points, "trapezoid") - REFERENCE),
                "no_grid_error_cm": 100 * (least_energy_p0(points, "equal") - exact),
                "grid_cm": 100 * (SUPPORTS[0][1] - LOWEST) / (samples - 1),
                "thesis_time_s": thesis_time,
                "time_s": taken,
            }
        )
    return pd.DataFrame(rows)


def _bias(exact, numbers):
    """Equal masses at n points are the cable's own mass and a payload at p0 of 1/(n - 1) of a cable's."""
    return pd.DataFrame(
        {
            "points": n,
            "equal_masses_mm": 1e3 * (least_energy_p0(n, "equal") - exact),
            "half_end_masses_mm": 1e3 * (least_energy_p0(n, "trapezoid") - exact),
            "payload_mm": 1e3 * (balance_p0(hanging_scene(two_supports(), payload=1 / (n - 1)))[2] - exact),
        }
        for n in numbers
    )


def _energy():
    line = np.linspace(LOWEST, 0.42, 160)
    return pd.DataFrame(
        {
            "p0_height_m": z0,
            "equal_masses_m": mean_height(z0, 10, "equal"),
            "half_end_masses_m": mean_height(z0, 10, "trapezoid"),
            "cable_m": mean_height(z0, 2001, "trapezoid"),
        }
        for z0 in line
    )


def _force_balance(exact, pairs):
    """Ways to find p0: a table of their errors and times, and one of the turns in which they were timed."""
    scenes = {segments: hanging_scene(two_supports(), segments=segments) for segments in LUMPED}
    methods = {CATENARIES: lambda: balance_p0(scenes[20])[2]}
    for segments, scene in scenes.items():
        methods[LUMPED[segments]] = lambda scene=scene: equilibrium(scene).position("p0")[2]
    samples, points = TABLE_5_1[-1][:2]
    timed = {SAMPLING: lambda: sample_p0(samples, points)} | methods
    turns = take_turns({method: lambda find=find: seconds_of(find) for method, find in timed.items()}, pairs)
    rows = [
        {"method": method, "error_mm": 1e3 * (find() - exact), "time_ms": 1e3 * float(np.median(turns[method]))}
        for method, find in methods.items()
    ]
    return pd.DataFrame(rows), pd.DataFrame(turns)


def _motion(poses):
    """One balance for each pose of the 4 s, each from scratch; `poses` fewer than 400 are scaled up."""
    rows = []
    for net, supports in (("two cables", two_supports()), ("four cables", four_supports())):
        still = hanging_scene(supports)
        for method, find in (("catenaries", balance_p0), ("lumped", lambda s: equilibrium(s).position("p0"))):
            scenes = [moved(still, SPEED * t) for t in np.linspace(0.0, MOTION_S, poses)]
            find(scenes[0])  # compiles
            began = time.perf_counter()
            path = np.array([find(scene) for scene in scenes])
            taken = time.perf_counter() - began
            off = path - path[0]
            off[:, 0] -= SPEED * np.linspace(0.0, MOTION_S, poses)
            rows.append(
                {
                    "net": net,
                    "method": method,
                    "poses": poses,
                    "time_a_pose_ms": 1e3 * taken / poses,
                    "time_s": taken / poses * 400,
                    "thesis_time_s": MOTION[net],
                    "largest_departure_m": float(np.linalg.norm(off, axis=1).max()),
                }
            )
    return pd.DataFrame(rows)
