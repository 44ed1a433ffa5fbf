"""Points of bodies in MoorDyn files that carry something: M, V, CdA and CA."""

import numpy as np
import pytest
from beside_moordyn import places_of_points

from anet_lumped import Carried, simulate
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError
from anet_lumped.files.moordyn_writer import moordyn_text

DECK = """\
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
light 0.01 0.01 2e4 0 0 0 0 0 0
--- BODIES ---
ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca
(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)
1 Free 0 0 -20 0 0 0 100 0 20 0.05 0|0 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 20 0 0 0 0 0 0
2 Body1 0.5 0.2 -0.3 50 0.02 0.3 0.5
3 Body1 -0.5 -0.2 0.3 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 light 1 2 60 1 -
--- OPTIONS ---
100 WtrDpth
0 kBot
0 cBot
9.81 g
--- OUTPUTS ---
--- need this line ---
"""
LOAD, FREE = "-0.3 50 0.02 0.3 0.5", "-0.3 {} {} {} {}"


def read(*changes, **how):
    deck = DECK
    for old, new in changes:
        assert deck.count(old) == 1, old
        deck = deck.replace(old, new)
    return deck_from_text(deck, **how)


def test_a_load_is_carried_by_its_attachment():
    deck = read()
    (body,) = deck.scene.bodies
    assert body.carried == (("point2", Carried(mass=50.0, volume=0.02, CdA=0.3, Ca=0.5)),)
    assert any(said.startswith("Points with a volume or a CdA float at the surface") for said in deck.remarks)


def test_it_is_written_and_read_back():
    scene = read(("0.3 0 0 0 0", '0.3 7 0 0 0 ! name: "end"')).scene
    assert deck_from_text(moordyn_text(scene)).scene.bodies == scene.bodies
    at_origin = read(("-0.5 -0.2 0.3 0 0 0 0", '0 0 0 7 0 0 0 ! name: ""')).scene
    assert dict(at_origin.bodies[0].carried)[""] == Carried(mass=7.0)
    assert dict(deck_from_text(moordyn_text(at_origin)).scene.bodies[0].carried) == dict(at_origin.bodies[0].carried)


def test_a_body_without_a_mass_of_its_own_is_what_it_carries():
    (body,) = read(("0 100 0 20", "0 0 0 20")).scene.bodies
    assert body.mass is None and body.whole.total == 50.0 and np.allclose(body.whole.inertia, 20.0 * np.eye(3), atol=1e-12)
    with pytest.raises(DeckError, match=r'line 8, .*Masses on one line .* body "body1" must have an `inertia` of its own'):
        read(("0 100 0 20", "0 0 0 0"))


@pytest.mark.parametrize(
    ("body", "load", "t_end"),
    [
        ("100 0 20", (50, 0.02, 0.3, 0.5), 0.3),
        ("100 0 20", (0, 0.08, 0, 0), 0.1),
        ("100 0 20", (0, 0.08, 3, 2), 0.3),
        ("0 0 20", (50, 0.02, 0.3, 0.5), 0.3),
    ],
    ids=["all", "buoyancy", "drag and added mass", "without a mass of its own"],
)
def test_moordyn_moves_it_as_we_do(tmp_path, body, load, t_end):
    """RK4 with 0.1 ms there and 0.5 ms here leave 1e-10 m of ways of 0.02 to 0.4 m."""
    quiet = "--- OPTIONS ---\n1e-4 dtM\nRK4 tScheme\n0 TmaxIC\n1 disableOutput\n0 writeLog"
    changes = (("100 0 20", body), (LOAD, FREE.format(*load)), ("--- OPTIONS ---", quiet))
    scene = read(*changes, like_moordyn=True).scene
    text = DECK
    for old, new in changes:
        text = text.replace(old, new)
    path = tmp_path / "deck.txt"
    path.write_text(text)
    places = places_of_points(path, t_end, (2, 3))
    ours = simulate(scene, t_end, method="rk4", dt=5e-4, start="straight").final
    for name, place in zip(("body1.point2", "body1.point3"), places, strict=True):
        assert np.linalg.norm(np.subtract(place, scene.point(name).at)) > 0.01
        assert np.allclose(ours.position(name), place, rtol=0.0, atol=1e-9)
