"""Error of a lumped cable against the continuous one, in its parts: model, discretisation, time.

    x(EA, N, h) - x(inf, inf, 0)  =  [x(EA, inf, 0) - x(inf, inf, 0)]      model: a cable that stretches
                                   + [x(EA, N, 0) - x(EA, inf, 0)]         discretisation: N segments a cable
                                   + [x(EA, N, h) - x(EA, N, 0)]           time: step h of a method

with x the position of p0 of the carried net over time. x(EA, N, 0) is a `reference`; x(EA, inf, 0) is extrapolated from two
numbers of segments (errors fall as N^-2), x(inf, inf, 0) from two stiffnesses (the stretch falls as 1/EA).
"""

import numpy as np
import pandas as pd

from anet_lumped import simulate
from anet_lumped.motion.stability import predict
from integrators import schemes
from integrators.schemes.record import Stepping
from studies.accuracy_cost.equal_error import on_front
from studies.accuracy_cost.motions import carried, fitting
from studies.accuracy_cost.references import FINE_STEP, IMPLICIT_PAIR, extrapolated, largest_distance, track

STIFFNESSES = (1e2, 1e4, 1e6, 1e8)  # EA [N]; the last two make the inextensible limit
INEXTENSIBLE = np.inf  # cables that do not stretch at all, by edmc
SEGMENTS = (5, 10, 20, 40, 80)
STEPS = (40e-3, 20e-3, 10e-3, 5e-3, 2.5e-3)  # [s]
SHARES = (0.9,)  # of an explicit method's predicted limit: its error in time is far below that of the segments
FRONT_STIFFNESSES = (1e4, 1e6, INEXTENSIBLE)
LONGEST = 0.5  # [s] of wall time that a run on the way to the front may take
COST = 18e-9  # [s] about, of a node and force evaluation of an explicit step
CHEAP, REPEATS = 0.1, 3  # [s] and runs of what takes less


class Limits:
    """Tracks of p0 (k, 3) [m] in the limits of the step, of the segments and of the stiffness."""

    def __init__(self, stiffnesses, segments, folder=None):
        steps, method = (FINE_STEP, FINE_STEP / 2), IMPLICIT_PAIR[0]
        soft, stiff = stiffnesses[-2:]
        self.exact = {}
        for N in segments:
            for EA in stiffnesses:
                self.exact[EA, N] = track(carried(EA, N), method, steps, folder).position
            self.exact[INEXTENSIBLE, N] = extrapolated(self.exact[soft, N], self.exact[stiff, N], stiff / soft)
        coarse, fine = segments[-2:]
        limits = [(EA, self.exact[EA, coarse], self.exact[EA, fine]) for EA in (*stiffnesses, INEXTENSIBLE)]
        self.continuous = {EA: extrapolated(a, b, (fine / coarse) ** 2) for EA, a, b in limits}
        self.inextensible = self.continuous[INEXTENSIBLE]

    def parts(self, EA, segments, position):
        """Largest distance of each part, and of the whole, over the saved times [mm]."""
        exact, continuous, rigid = self.exact[EA, segments], self.continuous[EA], self.inextensible
        return {
            "model_mm": 1e3 * largest_distance(continuous, rigid),
            "discretisation_mm": 1e3 * largest_distance(exact, continuous),
            "time_mm": 1e3 * largest_distance(position, exact),
            "total_mm": 1e3 * largest_distance(position, rigid),
        }


def methods():
    """Schemes of this package that are raced, edmc first: those with fixed steps that hold a swing and do not damp it strongly."""
    raced = schemes.names(own=True, stepping=Stepping.FIXED, stable_undamped=True, damps_the_motion=False)
    return ("edmc", *(name for name in raced if name != "edmc"))


def runs_of(quick=False):
    """Stiffnesses, numbers of segments, and (motion, method, step) of every run that can be afforded."""
    stiffnesses, segments, raced, steps = STIFFNESSES, SEGMENTS, methods(), STEPS
    if quick:
        stiffnesses, segments, raced, steps = stiffnesses[1:3], segments[:3], ("edmc", "verlet"), steps[1:3]
    found = []
    for EA in (*stiffnesses, INEXTENSIBLE):
        for N in segments:
            motion = carried(EA, N)
            for method in raced if np.isfinite(EA) else schemes.names(takes_rigid_springs=True):
                scheme = schemes.scheme(method)
                if scheme.explicit:
                    limit = predict(motion.scene, schemes=(method,)).limits[method].step
                    own = [fitting(share * limit, motion.save_every) for share in SHARES]
                    own = [dt for dt in own if motion.t_end / dt * motion.nodes * scheme.force_evaluations * COST <= LONGEST]
                else:
                    own = steps
                if EA in FRONT_STIFFNESSES or method == "edmc":
                    found += [(motion, method, dt) for dt in own]
    return stiffnesses, segments, found


def compute(quick=False, folder=None):
    """Every run's error in parts, its wall time, and whether it is on the front of total error and wall time.

    Returns
    -------
    pandas.DataFrame
    """
    stiffnesses, segments, runs = runs_of(quick)
    limits = Limits(stiffnesses, segments, folder)
    table = pd.DataFrame([_run(limits, *one) for one in runs])
    cheap = np.flatnonzero(table["wall_s"] < CHEAP)
    turns = [table.loc[cheap, "wall_s"]]
    for _ in range(0 if quick else REPEATS - 1):
        turns.append([_run(limits, *runs[i])["wall_s"] for i in cheap])
    table.loc[cheap, "wall_s"] = np.median(turns, axis=0)
    raced = table["EA_N"].isin(FRONT_STIFFNESSES)
    table["on_front"] = False
    table.loc[raced, "on_front"] = on_front(table.loc[raced, "total_mm"], table.loc[raced, "wall_s"])
    return table


def _run(limits, motion, method, dt):
    run = simulate(motion.scene, motion.t_end, method=method, dt=dt, start=motion.start, save_every=motion.save_every)
    whole = run.ok and len(run.t) == len(limits.inextensible)
    errors = limits.parts(motion.EA, motion.segments, run.position(motion.point)) if whole else {}
    row = {"EA_N": motion.EA, "segments": motion.segments, "method": method, "step_ms": 1e3 * dt, **errors}
    return row | {"wall_s": run.wall_time, "status": run.status, "reason": run.message}
