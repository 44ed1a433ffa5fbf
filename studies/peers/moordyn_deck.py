"""MoorDyn on an input file as it stands: its rest, and the motion of its coupled points.

Options that only say how MoorDyn itself runs are written anew: its step, its scheme, its way to rest, its log. Waves and currents
are switched off.
"""

import re
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from studies.peers.moordyn import silence

COUPLING = 1e-2  # [s], the longest time between two places that are given of a coupled point
CHUNK = 2.0  # [s] after which tensions at rest are compared
SETTLED = 1e-5  # change of an end's tension in CHUNK, over the largest one
MOST_STEPS = 400_000  # of MoorDyn, on each of both ways to rest
RELAXED = 120.0  # [s] of its own way to rest
OWN = {"threshIC": 1e-6, "dtIC": 1.0, "ICgenDynamic": 1, "CdScaleIC": 10.0}  # its way to rest, with more drag


class DeckEngine:
    """MoorDyn with a deck loaded; made by `loaded`."""

    def __init__(self, module, handle, lines, dt):
        self._dt, self._module, self._handle = dt, module, handle
        self._lines = [module.GetLine(handle, i + 1) for i in range(lines)]
        self._nodes = [module.GetLineN(line) for line in self._lines]
        self.has_rigid_bodies = module.GetNumberBodies(handle) + module.GetNumberRods(handle) > 0
        self.at, self._origins = _coupled_places(module, handle)
        self.time = 0.0

    def start(self):
        """Find MoorDyn's own start, its coupled points at rest."""
        self._module.Init(self._handle, self.at.tolist(), [0.0] * len(self.at))

    def settle(self, limit):
        """Wait at rest until the tensions stand still; True if they do before `limit` [s]."""
        before, limit = self.tensions(), min(limit, MOST_STEPS * self._dt)
        while self.time < limit:
            self._step(self.at, np.zeros(len(self.at)), CHUNK)
            now = self.tensions()
            if np.abs(now - before).max() <= SETTLED * np.abs(now).max():
                return True
            before = now
        return False

    def tensions(self):
        """Tensions of the first and of the last segment of each line, (lines, 2) [N]."""
        found = [[self._module.GetLineNodeTen(line, i) for i in (0, n)] for line, n in zip(self._lines, self._nodes, strict=True)]
        return np.linalg.norm(np.array(found), axis=2)

    def save(self, file):
        """Write the state to a file, from which `load` goes on."""
        self._module.SaveState(self._handle, str(file))

    def load(self, file):
        """Go on from a saved state, without a search for rest."""
        self._module.Init_NoIC(self._handle, self.at.tolist(), [0.0] * len(self.at))
        self._module.LoadState(self._handle, str(file))

    def march(self, displacement, t_end, save_every, coupling=COUPLING):
        """Tensions (k, lines, 2) [N] after each `save_every`, and the processor's time [s], all coupled points displaced alike.

        `displacement` gives (m, 3) [m] at times (m,) [s] from the beginning of the march.
        """
        between = max(1, int(np.ceil(save_every / coupling - 1e-9)))
        t = np.linspace(0.0, t_end, between * round(t_end / save_every) + 1)
        moved = displacement(t)
        x = np.tile(self.at, (len(t), 1))
        for first in self._origins:
            x[:, first : first + 3] += moved
        v = np.diff(x, axis=0) / (t[1] - t[0])
        calls = [(a.tolist(), b.tolist()) for a, b in zip(x[:-1], v, strict=True)]
        step, found = float(t[1] - t[0]), []
        began = time.process_time()
        for k, (a, b) in enumerate(calls):
            self._module.Step(self._handle, a, b, self.time, step)
            self.time += step
            if (k + 1) % between == 0:
                found.append(self.tensions())
        return np.array(found), time.process_time() - began

    def _step(self, x, v, dt):
        """March with constant velocities, in steps between which MoorDyn takes its own."""
        for _ in range(round(dt / COUPLING)):
            self._module.Step(self._handle, x.tolist(), v.tolist(), self.time, COUPLING)
            self.time += COUPLING


@contextmanager
def loaded(text, lines, *, dt, scheme="rk4"):
    """A `DeckEngine` of the text of a file; `lines` is how many it has, `dt` MoorDyn's largest step [s]."""
    import moordyn

    with tempfile.TemporaryDirectory() as folder, silence():
        deck = Path(folder) / "deck.txt"
        deck.write_text(_quiet(text, dt, scheme), encoding="utf-8")
        handle = moordyn.Create(str(deck))
        if handle is None:
            raise RuntimeError("MoorDyn does not read the file.")
        try:
            yield DeckEngine(moordyn, handle, lines, dt)
        finally:
            moordyn.Close(handle)


def _quiet(text, dt, scheme):
    """The deck with the options of MoorDyn's own run given last, where the last one counts, and with exponents that it reads."""
    text = re.sub(r"(\d)[dD]([+-]?\d)", r"\1E\2", text)
    run = OWN | {"TmaxIC": min(RELAXED, MOST_STEPS * dt), "dtM": dt, "tScheme": scheme}
    run |= {"writeLog": 0, "disableOutput": 1, "disableOutTime": 1, "WaveKin": 0, "Currents": 0}
    rows = text.splitlines()
    heading = next(i for i, row in enumerate(rows) if row.startswith("---") and "OPTIONS" in row.upper())
    end = next((i for i in range(heading + 1, len(rows)) if rows[i].startswith("---")), len(rows))
    return "\n".join([*rows[:end], *(f"{value} {name}" for name, value in run.items()), *rows[end:]]) + "\n"


def _coupled_places(module, handle):
    """Places, and angles, of all that is coupled, as MoorDyn wants them in one row; and where each begins in it.

    What is pinned takes its place alone. MoorDyn 2.7.2 counts three numbers too many for each such body, and passes over the last.
    """
    found, origins = [], []
    for i in range(module.GetNumberBodies(handle)):
        body = module.GetBody(handle, i + 1)
        kind = module.GetBodyType(body)
        if kind not in (module.BODY_TYPE_FIXED, module.BODY_TYPE_FREE):  # coupled, or coupled and pinned
            origins.append(len(found))
            found += [*module.GetBodyPos(body), *(module.GetBodyAngle(body) if kind == module.BODY_TYPE_COUPLED else ())]
    for i in range(module.GetNumberRods(handle)):
        rod = module.GetRod(handle, i + 1)
        if module.GetRodType(rod) == module.ROD_TYPE_CPLDPIN:
            origins.append(len(found))
            found += module.GetRodNodePos(rod, 0)
    for i in range(module.GetNumberPoints(handle)):
        point = module.GetPoint(handle, i + 1)
        if module.GetPointType(point) == module.POINT_TYPE_COUPLED:
            origins.append(len(found))
            found += module.GetPointPos(point)
    return np.array(found + [0.0] * (module.NCoupledDOF(handle) - len(found)), dtype=float), origins
