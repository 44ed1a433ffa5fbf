"""The mass of a rigid body: its centre and inertia, and the four point masses that stand for it.

Whatever turns and shifts as one piece is known by its mass, its centre of mass and its inertia about it. Four points of equal mass
m/4 at r + (s1 a1 e1 + s2 a2 e2 + s3 a3 e3), with the signs of (+++), (+--), (-+-), (--+), the principal axes e and

    a_k = sqrt(E_k/m) ,     E_k = (J_1 + J_2 + J_3)/2 - J_k ,

have the same three (Routh, The Elementary Part of a Treatise on the Dynamics of a System of Rigid Bodies, 1905, article 36). So
gravity, kinetic energy and momenta of a body are sums over points. E_k is the second moment of the mass along the axis e_k and
cannot be negative, which is why no principal inertia exceeds the sum of the other two.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import SceneError, Vector, as_entries, check_vector, shown

NEGLIGIBLE = 1e-9  # of the mass of a body: mass of each light point, taken from the rest of it so that all moments stay
ON_A_LINE = 1e-9  # of the sum of the principal inertias: what is below it is the rounding of 0
INERTIA_ROUNDING = 1e-6  # of the largest inertia: by how much one may exceed the sum of the other two


class Mass(NamedTuple):
    """Mass [kg], centre of mass (3,) [m] and inertia about it (3, 3) [kg m2], in the axes of a body."""

    total: float
    centre: np.ndarray
    inertia: np.ndarray

    @property
    def gyration(self) -> float:
        """Radius of gyration about the centre of mass, the root of half the trace of the inertia over the mass [m]."""
        return float(np.sqrt(0.5 * np.trace(self.inertia) / self.total))


def sum_of(parts: Iterable[Mass]) -> Mass:
    """The mass of parts that move as one piece, by Steiner's theorem."""
    parts = list(parts)
    total = sum(part.total for part in parts)
    centre = sum((part.total * part.centre for part in parts), np.zeros(3)) / total
    inertia = np.zeros((3, 3))
    for part in parts:
        d = part.centre - centre
        inertia += part.inertia + part.total * (d @ d * np.eye(3) - np.outer(d, d))
    return Mass(float(total), centre, inertia)


def is_on_a_line(mass: Mass) -> bool:
    """Whether a mass has no inertia about one of its axes: points on a line."""
    return bool(np.linalg.eigvalsh(mass.inertia)[0] <= ON_A_LINE * mass.inertia.trace())


def tensor(inertia: Any) -> np.ndarray:
    """(3, 3) inertia [kg m2] from the tensor or its principal moments (3,)."""
    J = np.array(inertia, float)
    return np.diag(J) if J.ndim == 1 else J


def check_inertia(value: Any, owner: str) -> tuple:
    """Principal moments (3,) or a symmetric tensor (3, 3), as tuples; what a mass distribution can have."""
    rows = as_entries(value) or ()
    is_tensor = len(rows) == 3 and all(as_entries(row) is not None for row in rows)
    checked: tuple = tuple(
        (check_vector("inertia", row, "kg m2", owner) for row in rows)
        if is_tensor
        else check_vector("inertia", value, "kg m2", owner)
    )
    J = tensor(checked)
    if not np.allclose(J, J.T, rtol=1e-9, atol=0.0):
        raise SceneError(f"Argument `inertia` must be a symmetric tensor [kg m2], but {owner} has inertia={shown(value)}.")
    a, b, c = np.linalg.eigvalsh(J)
    if not a > 0.0 or c > a + b + INERTIA_ROUNDING * c:
        raise SceneError(
            f"Principal moments of `inertia` must be positive, and none above the sum of the other two [kg m2], but {owner} has "
            f"{a:g}, {b:g} and {c:g}."
        )
    return checked


def four_masses(whole: Mass, light: list[Vector]) -> list[tuple[Vector, float]]:
    """Places in a body's axes [m], and masses [kg], of four equal masses that with the light points make up the whole."""
    light_mass, arms = NEGLIGIBLE * whole.total, np.array(light, float) - whole.centre
    left = whole.total - light_mass * len(arms)
    second = 0.5 * np.trace(whole.inertia) * np.eye(3) - whole.inertia - light_mass * arms.T @ arms
    centre = -light_mass * arms.sum(axis=0) / left
    second -= left * np.outer(centre, centre)
    values, axes = np.linalg.eigh(second)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    a = np.sqrt(np.maximum(values, 0.0) / left)
    signs = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], float)
    places = whole.centre + centre + (signs * a) @ axes.T
    return [(tuple(place.tolist()), left / 4.0) for place in places]
