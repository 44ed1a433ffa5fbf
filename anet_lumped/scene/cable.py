"""A cable between two points, and the numbers of its segments."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal, get_args

from anet_lumped.checks import SceneError, check_count, check_name, check_number, nearest, number, quoted, shown

from .creep import check_creep
from .polyester import static_curve
from .shedding import check_shedding
from .tension_strain import Curve, check_curve, slopes
from .working_curves import WorkingCurve

Compression = Literal["none", "damped", "linear"]
COMPRESSION: tuple[str, ...] = get_args(Compression)
HALF = 0.5  # of the fast stiffness of polyester, as if its slow spring were as stiff: what its numerical damper scales with


@dataclass(frozen=True)
class Cable:
    """A chain of equal segments between two points, with tension T = EA·eps + BA·(dl/dt)/L0 in each.

    Parameters
    ----------
    start, end : names of the points that it joins
    length : float [m], unstretched
    mass_per_length : float [kg/m]
    EA : float [N], axial stiffness; inf for a cable that does not stretch; with a curve its steepest slope, and left out
    segments : number of segments
    zeta : damping ratio of one segment, BA = zeta·L0·√(EA·mu)
    BA : float [N·s] or None, axial viscosity, in place of `zeta`
    compression : what a segment shorter than L0 does: "none" (carries nothing), "damped" (the damper acts, the
        spring does not), "linear" (spring and damper push as they pull)
    EA_compression : float [N], up to EA, axial stiffness of a segment shorter than L0, for compression="damped": 0, as if it were
        not given, is that law; EA is "linear"
    name : "start-end" if None
    diameter : float [m] or None, that air and water act on
    Cdn, Cdt : drag coefficients across and along the cable, on d·L0 and on π·d·L0
    Can, Cat : added-mass coefficients across and along the cable
    EI : float [N·m²], bending stiffness; acts where the scene has the effect `Bending`
    breaking_tension : float [N] or None, at which a segment fails; None for never
    tension_strain : sequence of (eps, T [N]) or None, the elastic tension over the strain in place of EA·eps: straight from (0, 0)
        to the first, from each to the next, and on beyond the last; both must grow
    EA_dynamic : float [N] or None, of a cable that creeps (fibre ropes): axial stiffness against fast stretching, larger than EA,
        which is that under a load held for long. A fast spring and damper, `EA_dynamic` and BA, are in series with a slow
        spring and the damper `BA_creep`, see `effects.laws.creep`; `zeta` is then that of the fast ones. Only pulls
    BA_creep : float [N·s] or None, viscosity of the creep
    EA_dynamic_per_tension : float, by how much EA_dynamic grows with the tension held
    working_curve : one of `working_curves` or None, of a polyester rope with an `EA_dynamic`: what it follows below the largest
        tension that it has held for long; above it `tension_strain`
    Cl : float, lift coefficient of the vortices that the cable sheds in `Water`, see `effects.vortex_shedding`; 0: none are shed
    St : float, Strouhal number f·d/U of the vortices of a cable at rest
    St_range : float, less than St, by how much f·d/U is larger or smaller where the cable vibrates
    shedding_window : float [s] or None, in which a vibration is known by its mean squares; None: 10 periods of the vortices
    """

    start: str
    end: str
    length: float = field(kw_only=True)
    mass_per_length: float = field(kw_only=True)
    EA: float = field(default=None, kw_only=True)  # type: ignore[assignment]  # a curve may stand for it
    segments: int = field(kw_only=True)
    zeta: float = field(default=0.0, kw_only=True)
    BA: float | None = field(default=None, kw_only=True)
    compression: Compression = field(default="none", kw_only=True)
    name: str = field(default=None, kw_only=True)  # type: ignore[assignment]  # its ends name it
    diameter: float | None = field(default=None, kw_only=True)
    Cdn: float = field(default=1.2, kw_only=True)
    Cdt: float = field(default=0.01, kw_only=True)
    Can: float = field(default=1.0, kw_only=True)
    Cat: float = field(default=0.0, kw_only=True)
    EI: float = field(default=0.0, kw_only=True)
    breaking_tension: float | None = field(default=None, kw_only=True)
    EA_compression: float = field(default=0.0, kw_only=True)
    tension_strain: Sequence[tuple[float, float]] | None = field(default=None, kw_only=True)
    EA_dynamic: float | None = field(default=None, kw_only=True)
    BA_creep: float | None = field(default=None, kw_only=True)
    EA_dynamic_per_tension: float = field(default=0.0, kw_only=True)
    working_curve: WorkingCurve | None = field(default=None, kw_only=True)
    Cl: float = field(default=0.0, kw_only=True)
    St: float = field(default=0.18, kw_only=True)
    St_range: float = field(default=0.08, kw_only=True)
    shedding_window: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        for point in (self.start, self.end):
            check_name(point, "point")
        name = f"{self.start}-{self.end}" if self.name is None else check_name(self.name, "cable")
        owner = f"cable {quoted(name)}"
        checked: dict[str, Any] = {
            "name": name,
            "length": check_number("length", self.length, "m", owner, sign="positive"),
            "mass_per_length": check_number("mass_per_length", self.mass_per_length, "kg/m", owner, sign="positive"),
            "segments": check_count("segments", self.segments, owner),
            "zeta": check_number("zeta", self.zeta, "", owner, sign="non-negative"),
        }
        if self.diameter is not None:
            checked["diameter"] = check_number("diameter", self.diameter, "m", owner, sign="positive")
        for key, unit in (("Cdn", ""), ("Cdt", ""), ("Can", ""), ("Cat", ""), ("EI", "N·m²"), ("EA_compression", "N")):
            checked[key] = check_number(key, getattr(self, key), unit, owner, sign="non-negative")
        if self.breaking_tension is not None:
            checked["breaking_tension"] = check_number("breaking_tension", self.breaking_tension, "N", owner, sign="positive")
        if self.BA is not None:
            checked["BA"] = check_number("BA", self.BA, "N·s", owner, sign="non-negative")
        if self.tension_strain is not None:
            checked["tension_strain"] = check_curve(self.tension_strain, owner)
            checked["EA"] = max(slopes(checked["tension_strain"]))
            if self.EA is not None and number(self.EA) != checked["EA"]:
                raise SceneError(f"Only one of `EA` and `tension_strain` may be given, but {owner} has both.")
        elif self.EA is None:
            raise SceneError(f"A cable must have `EA` or `tension_strain`, but {owner} has neither.")
        else:
            checked["EA"] = math.inf if number(self.EA) == math.inf else check_number("EA", self.EA, "N", owner, sign="positive")
        check_creep(self, checked, owner)
        check_shedding(self, checked, owner)
        vars(self).update(checked)
        if self.start == self.end:
            raise SceneError(f"A cable must join two different points, but {owner} runs from {quoted(self.start)} to itself.")
        if self.zeta and self.BA is not None:
            raise SceneError(f"Only one of `zeta` and `BA` may be given, but {owner} has zeta={self.zeta} and BA={self.BA}.")
        if not isinstance(self.compression, str) or self.compression not in COMPRESSION:
            raise SceneError(
                'Argument `compression` must be "none", "damped" or "linear", but '
                f"{owner} has compression={shown(self.compression)}" + (nearest(self.compression, COMPRESSION) or ".")
            )

        if self.EA_compression and (self.compression != "damped" or self.EA_compression > self.EA_first or self.inextensible):
            raise SceneError(
                'Argument `EA_compression` must not exceed a finite EA and needs compression="damped", but '
                f"{owner} has EA_compression={self.EA_compression}, EA={self.EA_first} and compression={shown(self.compression)}."
            )

    @property
    def inextensible(self) -> bool:
        """Whether it does not stretch, EA = inf."""
        return math.isinf(self.EA)

    @property
    def creeps(self) -> bool:
        """Whether it creeps, with an `EA_dynamic`."""
        return self.EA_dynamic is not None

    @property
    def EA_fast(self) -> float:
        """Axial stiffness against fast stretching [N]: EA, or the EA_dynamic of a cable without tension that creeps."""
        return self.EA if self.EA_dynamic is None else self.EA_dynamic

    @property
    def creep(self) -> tuple[float, float, float, float]:
        """Of a segment of a cable that creeps: static stiffness and that of the fast spring without tension [N/m], by how much this
        grows with the tension [1/m], and the slow damper [N·s/m]."""
        assert self.EA_dynamic is not None and self.BA_creep is not None
        static = self.EA if self.working_curve is None else min(self.EA, HALF * self.EA_dynamic)
        return tuple(x / self.L0 for x in (static, self.EA_dynamic, self.EA_dynamic_per_tension, self.BA_creep))  # type: ignore[return-value]

    @property
    def working_rows(self) -> Curve:
        """Rows of the original curve of a polyester rope, and then of the shape of its working curves; of others none."""
        return () if self.working_curve is None else (*self._curve, *self.working_curve.shape)

    @property
    def permanent_strain(self) -> float:
        """Strain that the cable has kept without tension, of a polyester rope that has held a tension."""
        return self._held[0]

    @property
    def _curve(self) -> Curve:
        return self.tension_strain  # type: ignore[return-value]  # as it was checked

    @cached_property
    def _held(self) -> tuple[float, Curve]:
        """`permanent_strain`, and the tension-strain curve of loads that are held, in strains of the length with it."""
        return (0.0, self._curve) if self.working_curve is None else static_curve(self._curve, self.working_curve)

    @property
    def EA_first(self) -> float:
        """Axial stiffness at L0 [N]: EA, or the first slope of the curve."""
        return self.EA if self.tension_strain is None else slopes(self._held[1])[0]

    @property
    def springs(self) -> tuple[tuple[float, float], ...]:
        """Springs in parallel that make the curve of loads that are held; none without one.

        The first one acts from the strain 0 on with a share of `stiffness`, each further one from its strain on with a share of the
        first. Strains are those of the length with the permanent strain.
        """
        if self.tension_strain is None:
            return ()
        curve = self._held[1]
        of_pieces, knots, steepest = slopes(curve), curve[:-1], self.stiffness * self.L0 * (1.0 + self.permanent_strain)
        steps = (after - before for before, after in pairwise(of_pieces))
        further = ((strain, step / of_pieces[0]) for (strain, _), step in zip(knots, steps, strict=True))
        return (0.0, of_pieces[0] / steepest), *further

    def strain(self, T: float) -> float:
        """Strain that a tension T >= 0 [N] holds, by the elastic law."""
        if self.tension_strain is None:
            return T / self.EA
        at, below, strain, (kept, curve) = 0.0, 0.0, 0.0, self._held
        for (eps, above), slope in zip(curve, slopes(curve), strict=True):
            if T > below or at == 0.0:
                strain = at + (T - below) / slope
            at, below = eps, above
        return kept + (1.0 + kept) * strain

    @property
    def L0(self) -> float:
        """Unstretched length of one segment [m]."""
        return self.length / self.segments

    @property
    def half_segment_mass(self) -> float:
        """Half the mass of one segment, which either of its nodes carries [kg]."""
        return 0.5 * self.mass_per_length * self.L0

    @property
    def stiffness(self) -> float:
        """Spring of one segment, k = EA/L0 [N/m]; of a polyester rope the steepest slope of loads that are held."""
        if self.working_curve is not None:
            return max(slopes(self._held[1])) / (self.L0 * (1.0 + self.permanent_strain))
        return self.EA / self.L0

    @property
    def dashpot(self) -> float:
        """Damper of one segment, c = BA/L0 [N·s/m]."""
        return self.axial_viscosity / self.L0

    @property
    def axial_viscosity(self) -> float:
        """Axial viscosity, BA as given or zeta·L0·√(EA·mu) [N·s]."""
        if self.inextensible:
            return 0.0
        if self.BA is not None:
            return self.BA
        return self.zeta * self.L0 * math.sqrt(self.EA_fast * self.mass_per_length)

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of one segment, zeta as given or BA/(L0·√(EA·mu))."""
        if self.BA is None or self.inextensible:
            return self.zeta
        return self.BA / (self.L0 * math.sqrt(self.EA_fast * self.mass_per_length))

    @property
    def omega_max(self) -> float:
        """Bound of the axial frequencies of the lumped chain, (2/L0)·√(EA/mu) [rad/s]."""
        return 2.0 / self.L0 * math.sqrt(self.EA_fast / self.mass_per_length)
