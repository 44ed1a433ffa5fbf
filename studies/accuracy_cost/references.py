"""Places that methods are judged by: two independent methods at far smaller steps, kept on disk.

Where the stiffness allows it, they are Runge-Kutta 4 and velocity Verlet at a small part of their stable steps; else
generalised-alpha and the midpoint rule, both extrapolated from two small steps by Richardson's formula. Cables that do not
stretch have the limit of elastic ones, extrapolated from two stiffnesses too, and edmc. A method is judged by the first, or
by the second if the first is itself; their distance says how far either can be trusted.
"""

import hashlib
import json
import os
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

import anet_lumped
from anet_lumped import simulate
from anet_lumped.motion.simulate import StabilityWarning
from anet_lumped.motion.stability import predict
from anet_lumped.regular_files import whole_file
from anet_lumped.scene.as_dict import scene_to_dict
from integrators import schemes
from studies.accuracy_cost.motions import fitting

EXPLICIT_PAIR, IMPLICIT_PAIR = ("rk4", "verlet"), ("generalised_alpha", "midpoint")
SHARES = (0.1, 0.2, 0.5)  # of the stable step: the smallest that costs no more than AFFORDABLE
COST = 60e-9  # [s] about, of a node and step of rk4
AFFORDABLE = 20.0  # [s], twice that for the largest share
INEXTENSIBLE_PAIR, LIMIT_STIFFNESSES = ("generalised_alpha", "edmc"), (1e6, 1e8)  # EA [N] that the limit is taken from
FINE_STEP = 0.5e-3  # [s] of the implicit pair, and half of it
SOURCES = ("effects/**/*.py", "model/*.py", "prescribed/*.py")  # the physics: a reference computed with others is not used


@dataclass(frozen=True, eq=False)
class Track:
    """Places (k, 3) [m] of the judged point at the saved times, and the least tension that any segment had then [N]."""

    position: np.ndarray
    least_tension: float


@dataclass(frozen=True, eq=False)
class Reference:
    """The tracks of two methods by name, the first of which judges."""

    tracks: dict[str, Track]

    @property
    def difference(self):
        """Largest distance between the two [m]."""
        first, second = self.tracks.values()
        return largest_distance(first.position, second.position)

    @property
    def taut(self):
        """Whether no segment slackened at a saved time, so that all laws of compression are one."""
        return min(track.least_tension for track in self.tracks.values()) > 0.0

    def error(self, method, position):
        """Largest distance of positions (k, 3) [m] from those of another method than ``method`` [m]."""
        judges = [track for name, track in self.tracks.items() if name != method]
        return largest_distance(position, judges[0].position)


def extrapolated(coarse, fine, ratio):
    """Limit of what is off by an error that is ``ratio`` times as large in the coarse track as in the fine one."""
    return fine + (fine - coarse) / (ratio - 1.0)


def largest_distance(a, b):
    """Largest distance of two tracks (k, 3) at equal times [m]."""
    return float(np.linalg.norm(a - b, axis=1).max())


def cache_folder():
    """Where references are kept: `anet-lumped/references` in the user's cache folder."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "anet-lumped" / "references"


def reference(motion, folder=None):
    """Both reference tracks of a motion.

    Parameters
    ----------
    motion : Motion
    folder : where they are kept; `cache_folder()` by default

    Returns
    -------
    Reference
    """
    methods, steps = plan(motion)
    if np.isfinite(motion.EA):
        return Reference({method: track(motion, method, steps[method], folder) for method in methods})
    elastic, own = methods
    soft, stiff = (track(motion.with_stiffness(EA), elastic, steps[elastic], folder) for EA in LIMIT_STIFFNESSES)
    ratio = LIMIT_STIFFNESSES[1] / LIMIT_STIFFNESSES[0]
    limit = Track(extrapolated(soft.position, stiff.position, ratio), stiff.least_tension)
    return Reference({elastic: limit, own: track(motion, own, steps[own], folder)})


def plan(motion):
    """The two methods, and for each the steps [s] that it is run with: one, or two to extrapolate from."""
    if np.isfinite(motion.EA):
        limits = predict(motion.scene, schemes=EXPLICIT_PAIR).limits
        for share in SHARES:
            steps = {name: (fitting(share * limits[name].step, motion.save_every),) for name in EXPLICIT_PAIR}
            cost = motion.t_end / steps[EXPLICIT_PAIR[0]][0] * motion.nodes * COST
            if cost <= AFFORDABLE * (2 if share == SHARES[-1] else 1):
                return EXPLICIT_PAIR, steps
    fine = fitting(FINE_STEP, motion.save_every)
    pair = IMPLICIT_PAIR if np.isfinite(motion.EA) else INEXTENSIBLE_PAIR
    return pair, dict.fromkeys(pair, (fine, fine / 2))


def track(motion, method, steps, folder=None):
    """A track, computed or read; from two steps it is extrapolated by the method's order.

    Raises
    ------
    RunError : the method did not reach the end
    """
    file = Path(folder or cache_folder()) / f"{cache_key(motion, method, steps)}.parquet"
    if file.exists():
        table = pd.read_parquet(file)
        return Track(table[["x_m", "y_m", "z_m"]].to_numpy(), float(table["least_tension_N"].min()))
    positions, tensions = [], []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StabilityWarning)
        for dt in steps:
            run = simulate(
                motion.scene, motion.t_end, method=method, dt=dt, start=motion.start, save_every=motion.save_every, check=True
            )
            positions.append(run.position(motion.point))
            tensions.append(min(run.tension(cable.name).min() for cable in motion.scene.cables))
    position = (
        positions[-1] if len(positions) == 1 else extrapolated(*positions, (steps[0] / steps[1]) ** schemes.scheme(method).order)
    )
    table = pd.DataFrame(position, columns=["x_m", "y_m", "z_m"])
    table["t_s"], table["least_tension_N"] = run.t, min(tensions)
    file.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(file, "A reference") as half:
        table.to_parquet(half, index=False)
    return Track(position, float(min(tensions)))


def cache_key(motion, method, steps):
    """Name of a track on disk: a hash of the scene, the start, the settings and the sources of the physics."""
    home = Path(anet_lumped.__file__).parent
    sources = [file.read_bytes() for pattern in SOURCES for file in sorted(home.glob(pattern))]
    settings = [motion.recipe, motion.t_end, motion.save_every, motion.point, method, list(steps)]
    text = json.dumps([scene_to_dict(motion.scene), settings], sort_keys=True)
    return hashlib.sha256(b"".join([text.encode(), *sources])).hexdigest()[:32]
