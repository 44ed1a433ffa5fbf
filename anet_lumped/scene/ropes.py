"""Ropes by name: what a material and a nominal diameter say of mass, stiffness and strength.

With d the nominal diameter [m], a rope has

    mass_per_length = m2·d² ,   diameter = dv·d ,   breaking_load = b2·d² + b3·d³ ,
    EA = r·breaking_load  or  e2·d² ,  and where the tension swings about a mean  EA = r_a·breaking_load + r_b·tension .

`diameter` is that of a cylinder of the same volume, in which water sees the rope; the coefficients of drag and added mass
belong to it. The numbers are first estimates from makers' catalogues: makers differ by a tenth in mass and by a factor in the
stiffness of fibre ropes, which depends on load, age and water besides. Use the maker's data where you have them.

Sources
-------
[NREL] MoorPy component properties library: best fits to makers' catalogues of ropes for floating wind, and for stiffness over
    breaking load, on which catalogues are silent, values from papers (for nylon 1 to 10). github.com/NREL/MoorPy,
    moorpy/library/readme.md (9ce6c90); the coefficients of drag, after DNV-OS-E301, and of added mass, after Bureau Veritas
    NR493, from moorpy/library/MoorProps_default.yaml (0046627).
[OrcaFlex] The formulas of OrcaFlex's line type wizard for ropes and wires, as MoorPy states them: moorpy/MoorProps.py,
    getLineProps, source "Orcaflex-original" (1968740). Orcina offers them as first estimates for preliminary use.
[EN 12385] Factors of six-strand wire ropes, Feyrer, Wire Ropes, table 1.9: mass W·d² with W = 3590 kg/m³ (6x19) and 3670
    (6x36) with a fibre core, 4000 and 4090 with a wire core.
[UFC] UFC 4-159-03, Moorings (2005), table 6-8, double-braided nylon: breaking loads and AE, and 15 % less strength when wet.

No source states the diameters that its fits are for. Those given here are of tables with which the masses were compared: of
nylon and polypropylene, 3/16 to 3 5/8 inch, industrialrope.com (pounds per 100 feet; within 16 %); of polyester, 6 to 32 mm,
Robline's Rapallo, and 290 mm, the line in MoorDyn's tests/Mooring/polyester (within 13 %); of wire ropes, 6 to 60 mm, the scope
of ASTM A1023/A1023M, with EN 12385 (within 3 %). For HMPE there was none, and thin ropes are sold with twice the strength of its
fit.
"""

import warnings
from dataclasses import dataclass
from typing import cast

from anet_lumped.checks import SceneError, check_number, nearest, quoted, shown


class RopeWarning(UserWarning):
    """A diameter for which a rope's formulas were not compared with anything."""


@dataclass(frozen=True)
class Rope:
    """A kind of rope, by the coefficients of the formulas at the top of this file.

    Parameters
    ----------
    about : what it is
    m2 : float [kg/m³]
    dv : float, volume-equivalent over nominal diameter
    b2, b3 : float [N/m²], [N/m³]
    source : str, which of the sources above
    diameters : (smallest, largest) nominal diameter with which it was compared [m], or None if with none
    r : float, static EA over breaking load, or None where `e2` is given
    e2 : float [N/m²], or None
    r_a, r_b : float, of the EA about a mean tension, or None where the source has none
    wet : float, strength when wet over strength when dry
    Cdn, Can, Cat : float, as of a Cable, or None where the source has none
    """

    about: str
    m2: float
    dv: float
    b2: float
    source: str
    diameters: tuple[float, float] | None
    b3: float = 0.0
    r: float | None = None
    e2: float | None = None
    r_a: float | None = None
    r_b: float | None = None
    wet: float = 1.0
    Cdn: float | None = None
    Can: float | None = None
    Cat: float | None = None

    def breaking_load(self, diameter: float, *, wet: bool = False) -> float:
        """Return the minimum breaking load [N] of a rope of a nominal diameter [m]."""
        return (self.wet if wet else 1.0) * (self.b2 * diameter**2 + self.b3 * diameter**3)

    def static_EA(self, diameter: float) -> float:
        """Return the static (quasi-static) axial stiffness [N] of a rope of a nominal diameter [m]."""
        return cast(float, self.e2) * diameter**2 if self.r is None else self.r * self.breaking_load(diameter)


FIBRE_IN_WATER = {"Can": 1.1, "Cat": 0.15}
LAID = (0.00476, 0.0921)  # 3/16 to 3 5/8 inch
ROPES = {
    "nylon": Rope(
        "nylon (polyamide)", m2=585.0, dv=0.81, b2=207e6, b3=230e6, r=5.0, r_a=2.08, r_b=39.0, wet=0.85, Cdn=1.979,
        **FIBRE_IN_WATER, diameters=LAID, source="NREL, UFC",
    ),
    "polyester": Rope(
        "polyester", m2=679.0, dv=0.79, b2=308e6, r=14.0, r_a=11.6, r_b=40.0, Cdn=2.021,
        **FIBRE_IN_WATER, diameters=(0.006, 0.29), source="NREL",
    ),
    "hmpe": Rope(
        "high-modulus polyethylene (Dyneema)", m2=496.0, dv=0.80, b2=580e6, b3=651e6, r=56.0, r_a=59.0, r_b=54.0, Cdn=1.988,
        **FIBRE_IN_WATER, diameters=None, source="NREL",
    ),
    "polypropylene": Rope("polypropylene", m2=452.6, dv=0.80, b2=105.990e6, e2=1.06e9, diameters=LAID, source="OrcaFlex"),
    "wire-fibre-core": Rope(
        "six-strand steel wire, fibre core", m2=3610.9, dv=0.82, b2=584.175e6, e2=3.67e10, diameters=(0.006, 0.06),
        source="OrcaFlex",
    ),
    "wire-core": Rope(
        "six-strand steel wire, wire core (IWRC)", m2=3989.7, dv=0.80, b2=633.358e6, e2=4.04e10, diameters=(0.006, 0.06),
        source="OrcaFlex",
    ),
}  # fmt: skip


def rope(name: str, diameter: float, *, tension: float | None = None) -> dict[str, float]:
    """Return what a Cable needs to know of a rope: `Cable("a", "b", length=5.0, segments=20, **rope("nylon", 0.012))`.

    Parameters
    ----------
    name : one of `ROPES`
    diameter : float [m], nominal
    tension : float [N] or None
        Mean tension about which a fibre rope moves; its EA is then the dynamic one, otherwise the static one.

    Returns
    -------
    dict of mass_per_length [kg/m], EA [N], diameter [m] and, where the source has them, Cdn, Can, Cat

    Raises
    ------
    SceneError : an unknown name, a diameter that is not positive, a tension beyond the breaking load or where the source has
        no dynamic stiffness

    Warns
    -----
    RopeWarning : a diameter with which the formulas were not compared
    """
    if not isinstance(name, str) or name not in ROPES:
        words = {key: kind.about.lower() for key, kind in ROPES.items()} if isinstance(name, str) else {}
        alike = [key for key, about in words.items() if name.lower() in about]  # "Dyneema", "IWRC"
        hint = nearest(name, ROPES) or nearest(alike[0] if alike else "", ROPES) or f"; known: {', '.join(ROPES)}."
        raise SceneError(f"Unknown rope {shown(name)}{hint}")
    kind, owner = ROPES[name], f"rope {quoted(name)}"
    diameter = check_number("diameter", diameter, "m", owner, sign="positive")
    low, high = kind.diameters or (0.0, 0.0)
    if not low <= diameter <= high:
        with_which = f"ropes of {1e3 * low:.3g} to {1e3 * high:.3g} mm" if kind.diameters else "no rope of known diameter"
        warnings.warn(
            f"The formulas of {owner} were compared with {with_which}, but diameter={1e3 * diameter:.4g} mm: "
            "prefer the maker's data.",
            RopeWarning,
            stacklevel=2,
        )
    fields = {"mass_per_length": kind.m2 * diameter**2, "EA": kind.static_EA(diameter), "diameter": kind.dv * diameter}
    if tension is not None:
        fields["EA"] = _dynamic_EA(kind, diameter, tension, owner)
    return fields | {key: value for key in ("Cdn", "Can", "Cat") if (value := getattr(kind, key)) is not None}


def _dynamic_EA(kind: Rope, diameter: float, tension: float, owner: str) -> float:
    """EA = r_a·breaking_load + r_b·tension [N]."""
    if kind.r_a is None or kind.r_b is None:
        raise SceneError(
            f"Argument `tension` must be None where the source has no dynamic stiffness, but {owner} has tension={tension}."
        )
    tension = check_number("tension", tension, "N", owner, sign="non-negative")
    breaking = kind.breaking_load(diameter)
    if tension > breaking:
        raise SceneError(
            f"Argument `tension` must not exceed the breaking load, {breaking:.4g} N, but {owner} has tension={tension}."
        )
    return kind.r_a * breaking + kind.r_b * tension
