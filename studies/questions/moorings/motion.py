"""Rest and motion of one deck, here and in MoorDyn: tensions at both ends of each line."""

import tempfile
import time
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from anet_lumped import EquilibriumError, Scene, SceneError, SixMotions, State, equilibrium, platform, signals, simulate
from anet_lumped.files.moordyn_file import Deck
from anet_lumped.files.moordyn_writer import moordyn_text
from anet_lumped.scene.platform import driven_from_outside
from studies.peers.moordyn import state_file
from studies.peers.moordyn_deck import loaded
from studies.peers.problem import explicit_limit

SURGE, HEAVE, FREQUENCY, RAMP = 1.0, 0.5, 0.1, 10.0  # [m], [m], [Hz], [s]
MOTIONS = SixMotions(
    surge=signals.harmonic(0.0, SURGE, FREQUENCY, ramp=RAMP), heave=signals.harmonic(0.0, HEAVE, FREQUENCY, ramp=RAMP)
)
SAVED = 0.05  # [s]
SETTLE_LIMIT = 100.0  # [s] that MoorDyn has to come to rest, after its own way to rest
RK4_REACH = 2.78
TRIES, SHORTER = 4, 0.25  # of MoorDyn, whose contact with the bottom may want shorter steps than its lines
PUSHING = "cables with EI push"
OWN_WAY, FROM_HERE = "at rest by its own way", "at rest from this library's rest"
NOT_AT_REST = f"not wholly at rest after {SETTLE_LIMIT:g} s"


@dataclass(frozen=True, eq=False)
class Prepared:
    """A deck's scene at rest: the scene, the words that say what was changed to find a rest, and the rest."""

    scene: Scene
    changed: str
    rest: Any


def prepare(deck: Deck) -> Prepared:
    """Find rest; where cables that are stiff in bending would have to push, with cables that do.

    Raises
    ------
    EquilibriumError : no rest either way
    """
    try:
        return Prepared(deck.scene, "", equilibrium(deck.scene))
    except EquilibriumError:
        if not any(cable.EI for cable in deck.scene.cables):
            raise
    cables = [replace(cable, compression="linear") if cable.EI else cable for cable in deck.scene.cables]
    scene = replace(deck.scene, cables=cables)
    return Prepared(scene, PUSHING, equilibrium(scene))


def tensions(deck: Deck, found: Any) -> np.ndarray:
    """Sizes of the tensions at both ends of each line of a State (lines, 2) or of a Run (k, lines, 2) [N].

    MoorDyn tells sizes, too: where the damper of a slack segment pushes, its tension is negative here.
    """
    return np.abs(np.stack([found.tension(name)[..., [0, -1]] for name in deck.lines.values()], axis=-2))


def own_run(prepared: Prepared, t_end: float, **settings):
    """The run of the deck on its platform, and the processor's time [s]."""
    scene = platform(prepared.scene, MOTIONS, t_end)
    began = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = simulate(scene, t_end, start=prepared.rest, **settings)
    return run, time.process_time() - began


def is_driven(deck: Deck) -> bool:
    """Whether anything of it moves from outside."""
    return bool(driven_from_outside(deck.scene))


def displacement(t: np.ndarray) -> np.ndarray:
    """Of all coupled points (k, 3) [m]."""
    return MOTIONS.at(t)[:, 0, :3]


class Peer:
    """MoorDyn on one deck, which is written anew where MoorDyn does not read it."""

    def __init__(self, file: str | Path, deck: Deck):
        self._lines, self.limit = len(deck.lines), explicit_limit(deck.scene, RK4_REACH)
        self._text, self.written_anew = Path(file).read_text(encoding="utf-8", errors="replace"), False
        self._scene, self._rigid = deck.scene, True

    def rest(self, found: State):
        """Bring it to rest, by its own way, or where that does not end, from the rest `found` here.

        What is found from there is as much MoorDyn's own: it moves on until its tensions stand still. States of bodies that move by
        themselves, and of lines that creep, are not written for MoorDyn: its own way is all they have. A body that is driven is
        written as its points.

        Returns
        -------
        tensions : (lines, 2) float64 [N]
        way : str, how it came to rest, or that it did not
        state : bytes, from which `march` goes on

        Raises
        ------
        RuntimeError : MoorDyn does not read the deck, or diverges
        """
        tensions, settled, state = self._settled(None)
        if settled:
            return tensions, OWN_WAY, state
        own = self._text, self.written_anew
        if not self._scene.bodies and found.crept is None and self._of_points():
            from_here = self._settled(found)
            if from_here[1]:
                return from_here[0], FROM_HERE, from_here[2]
        self._text, self.written_anew = own
        return tensions, NOT_AT_REST, state

    def _of_points(self):
        """Whether MoorDyn's file has points and lines alone; one with bodies that are driven is written anew where that can be."""
        if self._rigid:
            try:
                self._text, self.written_anew = moordyn_text(self._scene), True
            except SceneError:
                return False
        return True

    def _settled(self, start):
        for _ in range(TRIES - 1):
            try:
                return self._settle(start)
            except RuntimeError as error:
                if "Create" not in str(error):
                    self.limit *= SHORTER
                elif self.written_anew:
                    raise
                else:
                    self._text, self.written_anew = moordyn_text(self._scene), True
        return self._settle(start)

    def _settle(self, start):
        with self._loaded(0.6 * self.limit) as engine, tempfile.TemporaryDirectory() as folder:
            state, self._rigid = Path(folder) / "state", engine.has_rigid_bodies
            if start is None:
                engine.start()
            else:
                state.write_bytes(state_file(start))
                engine.load(state)
            settled = engine.settle(SETTLE_LIMIT)
            engine.save(state)
            return engine.tensions(), settled, state.read_bytes()

    def march(self, state: bytes, t_end: float, saved: float, *, dt: float, scheme: str = "rk4", coupling: float = 1e-2):
        """Tensions (k, lines, 2) [N] after each `saved`, and the processor's time [s]."""
        with self._loaded(dt, scheme) as engine, tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "state"
            file.write_bytes(state)
            engine.load(file)
            return engine.march(displacement, t_end, saved, coupling)

    def _loaded(self, dt, scheme="rk4"):
        return loaded(self._text, self._lines, dt=dt, scheme=scheme)
