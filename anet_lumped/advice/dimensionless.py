"""The dimensionless numbers that say which effects govern a cable; SI units in, plain numbers out.

Each is a ratio that is small, or large, where an effect does not matter; how small is small enough for a given error only a run
with and without the effect tells (`effect_audit`).
"""

import math


def irvine(weight: float, chord: float, inclination: float, tension: float, EA: float) -> float:
    """Irvine's parameter lambda^2, the stiffness of a cable's stretch over that of its sag.

    lambda^2 = (w l cos(theta)/H)^2 EA l/(H L_e) with L_e = l (1 + (w l cos(theta)/H)^2/8), for a parabola of small sag. Well below
    4 pi^2, where the first two symmetric modes exchange, a cable is a taut string whose stretching counts; well above it, one that
    does not stretch at all.

    Parameters
    ----------
    weight : float [N/m], mu g
    chord : float [m], l, between its ends
    inclination : float [rad], theta, of the chord against the horizontal
    tension : float [N], H, along the chord
    EA : float [N]

    Source
    ------
    Irvine & Caughey, Proc. R. Soc. Lond. A 341 (1974) 299; Irvine, Cable Structures (1981), 2.4, for inclined ones.
    """
    slope = weight * chord * math.cos(inclination) / tension
    stretched = chord * (1.0 + slope * slope / 8.0)
    return slope * slope * EA * chord / (tension * stretched)


def drag_over_weight(density: float, speed: float, diameter: float, Cd: float, weight: float) -> float:
    """Drag across a cable over its weight, (rho/2) d Cd U^2/(mu g): the tangent of the angle at which it trails when it is towed.

    Parameters
    ----------
    density : float [kg/m3], rho
    speed : float [m/s], U, of the fluid relative to the cable
    diameter : float [m]
    Cd : float
    weight : float [N/m], mu g, less buoyancy

    Source
    ------
    Hoerner, Fluid-Dynamic Drag (1965), ch. 3; Pode, David Taylor Model Basin report 687 (1951), R/W of towed cables.
    """
    return 0.5 * density * diameter * Cd * speed**2 / weight


def bending_over_segment(EI: float, tension: float, L0: float) -> float:
    """Bending length sqrt(EI/T) over a segment's: below 1 the boundary layers that bending makes fit into one segment.

    Source
    ------
    w'''' - (T/EI) w'' = 0 of a beam in tension: Timoshenko, Strength of Materials II (3rd ed., 1956), ch. 2.
    """
    return math.sqrt(EI / tension) / L0


def damping_ratio(rate: float, omega: float) -> float:
    """Damping ratio zeta = rate/(2 omega) of a mode of frequency omega [rad/s] by damping of rate [1/s], f = -rate m v.

    Source
    ------
    Damping proportional to mass: Clough & Penzien, Dynamics of Structures (2nd ed., 1993), Rayleigh damping.
    """
    return 0.5 * rate / omega


def axial_damping_ratio(BA: float, EA: float, mass_per_length: float, length: float) -> float:
    """Damping ratio BA omega/(2 EA) of a cable's first axial mode between fixed ends, omega = (pi/L) sqrt(EA/mu).

    Source
    ------
    Damping proportional to stiffness: Clough & Penzien, Dynamics of Structures (2nd ed., 1993), Rayleigh damping.
    """
    return 0.5 * BA / EA * math.pi / length * math.sqrt(EA / mass_per_length)


def froude(speed: float, length: float, g: float) -> float:
    """Froude number U/sqrt(g L): inertia of a motion over weight, or of a flow over the waves it makes.

    Source
    ------
    Newman, Marine Hydrodynamics (1977), 1.3.
    """
    return speed / math.sqrt(g * length)


def keulegan_carpenter(speed: float, period: float, diameter: float) -> float:
    """Keulegan-Carpenter number U T/d: how many diameters a flow that oscillates goes; drag over inertia of the fluid.

    Source
    ------
    Keulegan & Carpenter, J. Res. Natl. Bur. Stand. 60 (1958) 423; DNV-RP-C205 (2010), 6.6.1.
    """
    return speed * period / diameter


def payload_over_cables(payload: float, cables: float) -> float:
    """Mass carried over that of the cables [kg]/[kg]."""
    return payload / cables


def buoyancy_over_weight(density: float, diameter: float, mass_per_length: float) -> float:
    """Weight of the fluid that a cable displaces over its own, rho pi d^2/(4 mu). Source: Archimedes."""
    return density * 0.25 * math.pi * diameter**2 / mass_per_length


def penetration(weight: float, stiffness: float, diameter: float) -> float:
    """Depth w/(k d) that a lying cable of w = mu g [N/m] is pressed into a ground of k [Pa/m], over its diameter.

    Source
    ------
    Hall & Goupee, Ocean Eng. 104 (2015) 590, eq. 16, for the contact area d L0.
    """
    return weight / (stiffness * diameter) / diameter if stiffness > 0.0 else math.inf
