"""A rigid body, and the point masses that stand for it.

Whatever turns and shifts as one piece is known by its mass, its centre of mass and its inertia about it. Four points of equal mass
m/4 at r + (s1 a1 e1 + s2 a2 e2 + s3 a3 e3), with the signs of (+++), (+--), (-+-), (--+), the principal axes e and

    a_k = sqrt(E_k/m) ,     E_k = (J_1 + J_2 + J_3)/2 - J_k ,

have the same three (Routh, The Elementary Part of a Treatise on the Dynamics of a System of Rigid Bodies, 1905, article 36). So
gravity, kinetic energy and momenta of a body are sums over points. E_k is the second moment of the mass along the axis e_k and
cannot be negative, which is why no principal inertia exceeds the sum of the other two.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from anet_lumped.checks import (
    SceneError,
    Vector,
    as_entries,
    check_name,
    check_number,
    check_pairs,
    check_vector,
    nearest,
    quoted,
    shown,
)
from anet_lumped.prescribed.paths import Path, line
from anet_lumped.prescribed.turning import matrix_of
from anet_lumped.prescribed.turning_path import TurningPath

from .point import Driven, Free

NEGLIGIBLE = 1e-9  # of the mass of a body: mass of each attachment, taken from the rest of it so that all moments stay
INERTIA_ROUNDING = 1e-6  # of the largest inertia: by how much one may exceed the sum of the other two


@dataclass(frozen=True)
class OnBody(Free):
    """A point of a body: its origin, an attachment, one on each of its axes, or one of the masses that stand for it.

    Parameters
    ----------
    body : name of the body
    arm : (3,) tuple of float [m], from the origin of the body, in its axes
    """

    body: str = field(default="", kw_only=True)
    arm: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)


@dataclass(frozen=True)
class OnDrivenBody(Driven):
    """A point of a body whose motion is prescribed; ``body`` and ``arm`` as of `OnBody`."""

    body: str = field(default="", kw_only=True)
    arm: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)


@dataclass(frozen=True)
class Body:
    """A rigid body, to whose attachments cables are tied: a cable ends at "quad1.hook", or at the body's origin, "quad1".

    It moves freely, unless it is `pinned` or its motion is prescribed by `path` and `turning`. Lengths within the body are measured
    from its origin, along its own axes.

    Parameters
    ----------
    name : name of the body, unique among bodies and points
    mass : float [kg]; not needed where the motion is prescribed
    inertia : (3,) or (3, 3) array_like [kg m2], principal moments along its axes, or the tensor, about its centre of mass; likewise
    at : (3,) array_like [m], where its origin starts; not needed with a `path`
    rotation : (3,) array_like [rad], how its axes start: turned from those of the world about this vector, by its length
    attachments : dict of name to (3,) array_like [m]
    centre_of_mass : (3,) array_like [m]
    pinned : name of an attachment, or "" for the origin, that stays where it is while the body turns about it; None for a free body
    path : prescribed motion of the origin, made by `paths.line`, `paths.samples`, `paths.harmonic` or `paths.external`
    turning : prescribed rotation [rad], made likewise: at each time the axes are those at the start, turned about this vector

    Raises
    ------
    SceneError : a number that cannot be, such as an inertia above the sum of the other two
    """

    name: str
    mass: float | None = field(default=None, kw_only=True)
    inertia: Sequence[Any] | None = field(default=None, kw_only=True)
    at: Vector | None = field(default=None, kw_only=True)
    rotation: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    attachments: Mapping[str, Vector] | Sequence[tuple[str, Vector]] = field(default=(), kw_only=True)
    centre_of_mass: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    pinned: str | None = field(default=None, kw_only=True)
    path: Path | None = field(default=None, kw_only=True)
    turning: Path | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        check_name(self.name, "body")
        owner = f"body {quoted(self.name)}"
        checked: dict[str, Any] = {}
        for key, unit in (("rotation", "rad"), ("centre_of_mass", "m")):
            checked[key] = check_vector(key, getattr(self, key), unit, owner)
        pairs = check_pairs("attachments", self.attachments, "an attachment's name and its place", owner, may_be_empty=True)
        checked["attachments"] = tuple(
            (check_name(name, "attachment"), check_vector("attachments", at, "m", f"{quoted(name)} of {owner}"))
            for name, at in pairs
        )
        for key in ("path", "turning"):
            if getattr(self, key) is not None and not isinstance(getattr(self, key), Path):
                raise SceneError(
                    f"Argument `{key}` must be made by paths.line, paths.samples or paths.harmonic, but "
                    f"{owner} has {key}={shown(getattr(self, key))}."
                )
        if self.path is not None and self.at is not None:
            raise SceneError(f"Only one of `at` and `path` may be given, but {owner} has both.")
        if self.path is None:
            checked["at"] = check_vector("at", self.at, "m", owner)
        if self.is_driven and self.pinned is not None:
            raise SceneError(f"A body may be pinned or have a prescribed motion, but {owner} has both.")
        if not self.is_driven or self.mass is not None:
            checked["mass"] = check_number("mass", self.mass, "kg", owner, sign="positive")
        if not self.is_driven or self.inertia is not None:
            checked["inertia"] = _check_inertia(self.inertia, owner)
        names = [name for name, _ in checked["attachments"]]
        if self.pinned is not None and self.pinned not in ("", *names):
            raise SceneError(
                f'Argument `pinned` must name an attachment, or be "" for the origin, but {owner} has pinned={shown(self.pinned)}'
                + (nearest(self.pinned, names) or ".")
            )
        for key, value in checked.items():
            object.__setattr__(self, key, value)

    @property
    def is_driven(self) -> bool:
        """Whether its motion is prescribed."""
        return self.path is not None or self.turning is not None

    @property
    def motion(self) -> tuple[Path, Path | None]:
        """Prescribed motion of its origin, and rotation."""
        assert self.is_driven
        if self.path is not None:
            return self.path, self.turning
        assert self.at is not None
        return line(self.at, (0.0, 0.0, 0.0), 0.0), self.turning

    @cached_property
    def points(self) -> tuple[OnBody, ...] | tuple[OnDrivenBody, ...]:
        """Its points: the origin and the attachments.

        A body that is not driven has seven more, behind its origin: one on each of its axes, at its radius of gyration, by which
        its axes are known whatever its inertia; and the four masses.
        """
        ends: list[tuple[str, Vector]] = [(self.name, (0.0, 0.0, 0.0))]
        ends += [(f"{self.name}.{name}", arm) for name, arm in self.places]
        if self.is_driven:
            return tuple(
                OnDrivenBody(name, TurningPath.of(*self.motion, self.rotation, arm), body=self.name, arm=arm) for name, arm in ends
            )
        assert self.mass is not None and self.at is not None
        d = self.gyration
        ends[1:1] = [(f"{self.name}[x]", (d, 0.0, 0.0)), (f"{self.name}[y]", (0.0, d, 0.0)), (f"{self.name}[z]", (0.0, 0.0, d))]
        masses = _four_masses(self, [arm for _, arm in ends])
        named = [(*end, NEGLIGIBLE * self.mass) for end in ends]
        named[4:4] = [(f"{self.name}[{k}]", arm, m) for k, (arm, m) in enumerate(masses, start=1)]
        R, origin = matrix_of(self.rotation), np.array(self.at)
        return tuple(OnBody(name, m, at=tuple((origin + R @ arm).tolist()), body=self.name, arm=arm) for name, arm, m in named)

    @property
    def places(self) -> tuple[tuple[str, Vector], ...]:
        """Name and place of each attachment [m], from the origin, in its own axes."""
        return tuple(self.attachments)  # type: ignore[arg-type]  # pairs, once they are checked

    @cached_property
    def inertia_tensor(self) -> np.ndarray:
        """(3, 3) inertia about the centre of mass [kg m2], in its own axes."""
        J = np.array(self.inertia, float)
        return np.diag(J) if J.ndim == 1 else J

    @cached_property
    def gyration(self) -> float:
        """Radius of gyration about the centre of mass, the root of half the trace of the inertia over the mass [m]."""
        return float(np.sqrt(0.5 * np.trace(self.inertia_tensor) / self.mass))

    @cached_property
    def radius(self) -> float:
        """Largest distance of an attachment from the centre of mass, or the radius of gyration if that is larger [m]."""
        return max([self.gyration, *(float(np.linalg.norm(np.subtract(arm, self.centre_of_mass))) for _, arm in self.places)])

    @cached_property
    def least_masses(self) -> dict[str, float]:
        """Mass [kg] with which it resists a force on each of its points in the direction in which it resists least.

        1/m is the largest eigenvalue of I/m - [a] J^-1 [a], with the place a of the point from the centre of mass.
        """
        assert self.mass is not None
        found, J = {}, np.linalg.inv(self.inertia_tensor)
        for point in self.points:
            x, y, z = np.subtract(point.arm, self.centre_of_mass)
            across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            found[point.name] = 1.0 / float(np.linalg.eigvalsh(np.eye(3) / self.mass - across @ J @ across)[-1])
        return found


def _check_inertia(value: Any, owner: str) -> tuple:
    """Principal moments (3,) or a symmetric tensor (3, 3), as tuples; what a mass distribution can have."""
    rows = as_entries(value) or ()
    tensor = len(rows) == 3 and all(as_entries(row) is not None for row in rows)
    if tensor:
        checked = tuple(check_vector("inertia", row, "kg m2", owner) for row in rows)
    else:
        checked = tuple(check_vector("inertia", value, "kg m2", owner))  # type: ignore[arg-type]
    J = np.array(checked)
    J = J if tensor else np.diag(J)
    if not np.allclose(J, J.T, rtol=1e-9, atol=0.0):
        raise SceneError(f"Argument `inertia` must be a symmetric tensor [kg m2], but {owner} has inertia={shown(value)}.")
    a, b, c = np.linalg.eigvalsh(J)
    if not a > 0.0 or c > a + b + INERTIA_ROUNDING * c:
        raise SceneError(
            f"Principal moments of `inertia` must be positive, and none above the sum of the other two [kg m2], but {owner} has "
            f"{a:g}, {b:g} and {c:g}."
        )
    return checked


def _four_masses(body: Body, light: list[Vector]) -> list[tuple[Vector, float]]:
    """Places in a body's axes [m], and masses [kg], of four equal masses that with the light ones make up the body."""
    total, c, J = body.mass, np.array(body.centre_of_mass), body.inertia_tensor
    assert total is not None
    light_mass, arms = NEGLIGIBLE * total, np.array(light, float) - c
    left = total - light_mass * len(arms)
    second = 0.5 * np.trace(J) * np.eye(3) - J - light_mass * arms.T @ arms
    centre = -light_mass * arms.sum(axis=0) / left
    second -= left * np.outer(centre, centre)
    values, axes = np.linalg.eigh(second)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    a = np.sqrt(np.maximum(values, 0.0) / left)
    signs = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], float)
    places = c + centre + (signs * a) @ axes.T
    return [(tuple(place.tolist()), left / 4.0) for place in places]
