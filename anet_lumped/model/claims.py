"""What an effect says of itself must be what its compiled functions do: compared at random states when a model is built.

What is said decides which work is left out: a force that is taken for a dead load and is none makes a wrong rest, and a wrong
motion, that end as if they were right.
"""

import numpy as np

from anet_lumped.checks import SceneError

SPREADS = 0.1, 1.0, 10.0  # of positions about the supports, in lengths of the longest cable; of velocities [m/s]
ROUNDING = 1e-9  # of the forces and energies compared: far above what rounding leaves, far below what a wrong law does
STEP = 0.01  # [s], of a whole step


def check_claims(effect, model, index, params):
    """Compare what an effect says of itself with its compiled functions.

    Parameters
    ----------
    effect : Effect
    model : Model, complete but for its effects
    index, params : the effect's own numbers, from its `table`

    Raises
    ------
    SceneError : names the effect, the member and what must hold
    """
    states = _States(effect, model, index, params)
    _check_couplings(states)
    for spread in SPREADS:
        states.draw(spread)
        if effect.dead_load:
            _check_dead_load(states)
        elif effect.linear_in_node_state:
            _check_linear(states)
        if effect.no_force_at_rest:
            _check_rest(states)
        if effect.passive and not effect.dead_load:
            _check_passive(states)
        if effect.same_everywhere and not effect.dead_load:
            _check_same_everywhere(states)


class _States:
    """Two random states of a model, and the functions of an effect at any."""

    def __init__(self, effect, model, index, params):
        self.effect, self.model, self.numbers = effect, model, (index, params)
        self.called = f"effect {type(effect).__name__}"
        self.kernels, self.random = effect.kernels(), np.random.default_rng(0)
        self.centre = np.mean(model.scene.supports or [np.zeros(3)], axis=0)
        self.reach = max((cable.length for cable in model.scene.cables), default=1.0)
        self.draw(1.0)

    def draw(self, spread):
        """Draw two states: times (2,) [s], positions and velocities (2, n, 3) [m], [m/s]."""
        self.t = self.random.uniform(0.0, 10.0, 2)
        self.q = self.centre + spread * self.reach * self.random.normal(size=(2, self.model.n, 3))
        self.v = spread * self.random.normal(size=(2, self.model.n, 3))

    def force(self, t, q, v):
        """Force (n, 3) [N] and power [W]."""
        f = np.zeros((self.model.n, 3))
        return f, self.kernels["force"](t, q, v, *self.numbers, f)

    def energy(self, t, q):
        """Potential energy [J]."""
        return self.kernels["energy"](t, q, *self.numbers)

    def tangent(self, t, q, v, c_q, c_v):
        """Blocks of the nodes, of neighbours and of next but one neighbours [N/m]."""
        blocks = self.blocks()
        self.kernels["tangent"](t, q, v, *self.numbers, c_q, c_v, *blocks)
        return blocks

    def whole_step(self):
        """Force (n, 3) [N], dissipated energy [J] and blocks of a step from one state to the other, without numerical damper."""
        f, blocks = np.zeros((self.model.n, 3)), self.blocks()
        taken, _ = self.kernels["whole_step"](self.t[0], STEP, 0.0, *self.q, *self.numbers, f, *blocks)
        return f, taken, blocks

    def blocks(self):
        """Room for all blocks there may be, whatever the effect says that it writes."""
        segments = self.model.n_segments
        return np.zeros((self.model.n_free, 3, 3)), np.zeros((self.model.near_rows, 2, 3, 3)), np.zeros((segments, 2, 3, 3))

    def refuse(self, member, must, but):
        """Say that a member is not true."""
        given = getattr(self.effect, member)
        raise SceneError(f"{must}, but the {self.called}, whose `{member}` is {given}, {but}.")


def _same(a, b, size):
    """Whether arrays are the same to rounding of numbers of a size; NaN is not."""
    return bool(np.max(np.abs(a - b), initial=0.0) <= ROUNDING * np.max(np.abs(size), initial=0.0))


def _check_couplings(states):
    """A function that writes blocks that its net does not have would write over other memory."""
    reach = states.effect.coupled_neighbours
    if reach not in (0, 1, 2):
        states.refuse("coupled_neighbours", "An effect may couple a node with those 0, 1 or 2 segments away", "is none of these")
    if reach == 2 or "tangent" not in states.kernels:
        return
    written = [states.tangent(states.t[0], states.q[0], states.v[0], 1.0, 1.0)]
    written += [states.whole_step()[2]] if "whole_step" in states.kernels else []
    must = "Blocks must be of nodes no farther away than an effect says that it couples"
    for _, near, far in written:
        if far.any() or (reach == 0 and near.any()):
            states.refuse("coupled_neighbours", must, f"writes those of nodes {2 if far.any() else 1} segments away")


def _check_dead_load(states):
    (t, later), (q, other), (v, faster) = states.t, states.q, states.v
    f, power = states.force(t, q, v)
    must = "The force of a dead load must be the same at any position, velocity and time"
    for what, state in (("position", (t, other, v)), ("velocity", (t, q, faster)), ("time", (later, q, v))):
        if not _same(states.force(*state)[0], f, f):
            states.refuse("dead_load", must, f"has one that changes with the {what}")
    held = np.flatnonzero(f[states.model.n_free :].any(axis=1))
    if len(held):
        where = states.model.where(states.model.n_free + held[0])
        states.refuse("dead_load", "A dead load must act on moving nodes alone", f"acts on {where}")
    if power != 0.0:
        states.refuse("dead_load", "The power that the force of a dead load takes out must be 0", f"takes {power:.3g} W")
    given, done, size = states.energy(t, other) - states.energy(t, q), -np.sum(f * (other - q)), np.sum(np.abs(f) * np.abs(other))
    if not _same(given, done, size + np.sum(np.abs(f) * np.abs(q))) or states.energy(later, q) != states.energy(t, q):
        states.refuse(
            "dead_load", "The energy of a dead load must be -f.q of its force f, at any time",
            f"has one that changes by {given:.6g} J where -f.q changes by {done:.6g} J",
        )  # fmt: skip


def _check_linear(states):
    t, (q, other), (v, faster), free = states.t[0], states.q, states.v, states.model.n_free
    f, g = states.force(t, q, v)[0][:free], states.force(t, other, faster)[0][:free]
    member, size = "linear_in_node_state", np.maximum(np.abs(f), np.abs(g))
    must = "The force on a node must be linear in the position and velocity of that node, and depend on no other node"
    middle = states.force(t, 0.5 * (q + other), 0.5 * (v + faster))[0][:free]
    if not _same(2.0 * middle, f + g, size):
        states.refuse(member, must, "has one that is not linear")
    for bit in range(states.model.n.bit_length()):  # two nodes differ in one bit of their numbers at least
        moved = (np.arange(states.model.n)[:, None] >> bit) % 2 == 1
        mixed = states.force(t, np.where(moved, other, q), np.where(moved, faster, v))[0][:free]
        if not _same(mixed, np.where(moved[:free], g, f), size):
            states.refuse(member, must, "has one that changes with other nodes")
    in_q, in_v = states.tangent(t, q, v, 1.0, 0.0)[0], states.tangent(t, q, v, 0.0, 1.0)[0]
    change = np.einsum("ixy,iy->ix", in_q, (other - q)[:free]) + np.einsum("ixy,iy->ix", in_v, (faster - v)[:free])
    if not _same(-change, g - f, size):
        states.refuse(member, "`tangent` must be the slope of `force` with its sign turned", "has another one")


def _check_rest(states):
    for t, q in zip(states.t, states.q, strict=True):
        if states.force(t, q, np.zeros_like(q))[0].any():
            states.refuse("no_force_at_rest", "The force on nodes at rest must be zero", "exerts one")


def _check_same_everywhere(states):
    t, q, v = states.t[0], states.q[0] - states.centre, states.v[0]
    here, there = states.force(t, q, v)[0], states.force(t, q + states.reach, v)[0]
    if not _same(there, here, here):
        states.refuse(
            "same_everywhere", "Forces that are the same everywhere must not change when all nodes are moved", "has others"
        )


def _check_passive(states):
    for t, q, v in zip(states.t, states.q, states.v, strict=True):
        f, power = states.force(t, q, v)
        if power < -ROUNDING * np.sum(np.abs(f * v)):
            states.refuse("passive", "The power that a passive force takes out must not be negative", f"takes {power:.3g} W")
    if "whole_step" in states.kernels:
        f, taken, _ = states.whole_step()
        if taken < -ROUNDING * np.sum(np.abs(f * (states.q[1] - states.q[0]))):
            states.refuse("passive", "What a passive force takes in a step must not be negative", f"takes {taken:.3g} J")
