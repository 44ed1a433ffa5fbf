"""Forces that a MoorDyn file puts on points, bodies and rods."""

import numpy as np
import pytest

from anet_lumped import equilibrium
from anet_lumped.effects import AppliedForces, Dashpots
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError

MASS, g = 50.0, 9.81
HUNG = f"""\
a weight on a light rope, in air
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 0.02 1e-6 1e9 -1 0 0 0 0 0
--- BODIES ---
h
h
1 Free 20 0 -6 0 0 0 {MASS} 0 5 0 0 0
--- ROD TYPES ---
h
h
bar 0.1 25 0 0 0 0
--- RODS ---
h
h
1 bar Free 40 0 -5 40 0 -7 4 -
--- POINTS ---
ID Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 0 0 0 0 0
2 Free 0 0 -5 {MASS} 0 0 0
3 Fixed 20 0 0 0 0 0 0
4 Body1 0 0 1 0 0 0 0
5 Fixed 40 0 0 0 0 0 0
6 Free 7 7 -7 1 0 0 0
--- LINES ---
ID Type NodeA NodeB Length Segs Flags
(-) (-) (-) (-) (m) (-) (-)
1 rope 1 2 5 1 -
2 rope 3 4 5 1 -
3 rope 5 R1A 5 1 -
--- EXTERNAL LOADS ---
ID Object Fext Blin Bquad CSys
(#) (name) (N) (Ns/m) (Ns^2/m^2) (-)
@rows@
--- OPTIONS ---
0 rho
0 kBot
0 cBot
{g} g
--- OUTPUTS ---
--- need this line ---
"""


def read(*loads):
    return deck_from_text(HUNG.replace("@rows@", "\n".join(loads)))


def test_forces_on_points_rods_and_bodies_lean_their_ropes():
    """Each hangs along the sum of its weight and its force, by a rope whose own weight is nothing beside them."""
    deck = read("1 Point2 300|0|0 0 0 -", "2 Rod1 0|200|0 0|0 0|0 -", "3 body1 0|100|0 0 0 G", "4 Body1 0|50|0 0|0|0 0|0|0 G")
    (applied,) = [effect for effect in deck.scene.effects if isinstance(effect, AppliedForces)]
    assert dict(applied.force) == {"point2": (300.0, 0.0, 0.0), "rod1": (0.0, 200.0, 0.0), "body1": (0.0, 150.0, 0.0)}
    assert applied.axes == "world"
    rest = equilibrium(deck.scene)
    for point, top, force in (
        ("point2", (0, 0, 0), (300, 0, 0)),
        ("body1.point4", (20, 0, 0), (0, 150, 0)),
        ("rod1.a", (40, 0, 0), (0, 200, 0)),
    ):
        along = np.array([*force[:2], -MASS * g])
        np.testing.assert_allclose(
            rest.position(point), np.array(top) + 5 * along / np.linalg.norm(along), atol=1e-4
        )  # strains of 1e-6


def test_a_force_along_the_axes_of_a_body_turns_with_it():
    loads = "1 Body1 7|0|0 0 0 L", "2 Rod1 0|200|0 0|0 0|0 -", "3 Body1 0|0|5 0 0 G"
    (applied,) = [effect for effect in read(*loads).scene.effects if isinstance(effect, AppliedForces)]
    assert dict(applied.force_in_body) == {"body1": (7.0, 0.0, 0.0)}
    assert dict(applied.force) == {"rod1": (0.0, 200.0, 0.0), "body1": (0.0, 0.0, 5.0)} and applied.axes == "world"


def test_dampers():
    """Those of a rod are two, across and along it, in its own axes."""
    rows = "1 Point2 0|0|0 1|2|3 4|5|6 -", "2 Rod1 0 7|8 9|10 -", "3 Body1 0|0|0 1|1|1 0|0|0 G", "4 body1 3|0|0 0 0|2|0 L"
    deck = read(*rows)
    (dashpots,) = [effect for effect in deck.scene.effects if isinstance(effect, Dashpots)]
    assert dashpots == Dashpots(
        linear={"point2": (1.0, 2.0, 3.0), "body1": (1.0, 1.0, 1.0)},
        quadratic={"point2": (4.0, 5.0, 6.0)},
        linear_in_body={"rod1": (7.0, 8.0)},
        quadratic_in_body={"rod1": (9.0, 10.0), "body1": (0.0, 2.0, 0.0)},
    )


def test_columns_of_version_1_are_forces_too():
    text = HUNG.replace("@rows@", "1 Point2 1|0|0 0 0 -").replace("M V CdA CA", "M V FX FY FZ CdA CA")
    deck = deck_from_text(text.replace(f"-5 {MASS} 0 0 0", f"-5 {MASS} 0 3 4 5 0 0"))
    assert dict(deck.scene.effects[-1].force) == {"point2": (4.0, 4.0, 5.0)}  # with that of the section


@pytest.mark.parametrize(
    ("load", "remark"),
    [
        ("1 Point2 0|0|0 0 0 -", "No use is made of external loads: 0 (line 36)."),
        ("1 Point1 9|0|0 0 0 -", "No use is made of loads on what is held, or moved from outside: the force on point 1 (line 36)."),
        ("1 Point6 9|0|0 0 0 -", None),  # left out itself
    ],
)  # fmt: skip
def test_loads_that_move_nothing(load, remark):
    deck, usual = read(load), read("").remarks
    assert not any(isinstance(effect, AppliedForces) for effect in deck.scene.effects)
    assert [said for said in deck.remarks if said not in usual] == ([remark] if remark else [])


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ("1 Point2 9|0|0 1 0 -", r"Blin must be three finite numbers with \| between them"),
        ("1 Rod1 9|0|0 1|2|3 0 -", r"Blin must be two finite numbers with \| between them"),
        ("1 Point2 9|0|0 0 0|-1|2 -", "dampers Blin and Bquad must not be negative"),
        ("1 Point2 9|0 0 0 -", r"an external force Fext must be three finite numbers with \| between them"),
        ("1 Point2 9|x|0 0 0 -", "an external force Fext must be three finite numbers"),
        ("1 Point2 9|0|0", r"an external load must have 6 columns .* but has 3"),
        ("1 Line2 9|0|0 0 0 -", "an external load must be on Point, Rod or Body and a number"),
        ("1 Point9 9|0|0 0 0 -", "a force must be on a point in POINTS, but point 9 is not there"),
        ("1 Body9 9|0|0 0 0 G", "a load must be on a body in BODIES, but body 9 is not there"),
        ("1 Rod9 9|0|0 0 0 -", "a load on a rod must be on one that moves by itself"),
        ("1 Body1 9|0|0 0 0 -", "the axes CSys of a load on a body must be G, of the world, or L, its own"),
    ],
)  # fmt: skip
def test_loads_that_are_refused(load, message):
    with pytest.raises(DeckError, match=rf"line 3[67], .*{message}"):
        read(load)
