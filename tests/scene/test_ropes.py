"""The catalogue of ropes: against makers' tables and restatements of its sources, and where it does not hold."""

import math
import warnings

import pytest

from anet_lumped import Cable, SceneError
from anet_lumped.scene.as_dict import scene_from_dict
from anet_lumped.scene.ropes import ROPES, RopeWarning, rope

INCH, POUND_PER_100_FEET = 0.0254, 0.45359237 / 30.48  # [m], [kg/m]
LAID = {  # industrialrope.com, three-strand: diameter [inch], pounds per 100 feet
    "nylon": [(3 / 16, 1.0), (0.5, 6.5), (1.0625, 29.0), (2.0, 95.0), (3.625, 312.0)],
    "polypropylene": [(3 / 16, 0.7), (0.5, 4.7), (1.0625, 20.4), (3.0, 153.0)],
}
POLYESTER = [(0.006, 0.024), (0.012, 0.094), (0.02, 0.244), (0.032, 0.62), (0.29, 52.0)]  # Robline, Rapallo; MoorDyn's tests
MASSES = [(name, d * INCH, w * POUND_PER_100_FEET) for name, rows in LAID.items() for d, w in rows]
MASSES += [("polyester", *row) for row in POLYESTER]
FITS = {  # EA of MoorPy's library, moorpy/library/readme.md, N: static, and about a mean of L per cent of the breaking load
    "polyester": (lambda d: 4.32e9 * d**2, lambda d, L: (3.58e9 + 0.12e9 * L) * d**2),
    "nylon": (
        lambda d: 1.15e9 * d**3 + 1.04e9 * d**2,
        lambda d, L: (0.48e9 + 0.09e9 * L) * d**3 + (0.43e9 + 0.08e9 * L) * d**2,
    ),
    "hmpe": (
        lambda d: 36.4e9 * d**3 + 32.5e9 * d**2,
        lambda d, L: (38.4e9 + 0.35e9 * L) * d**3 + (34.2e9 + 0.31e9 * L) * d**2,
    ),
}
DENSITIES = {  # [kg/m³] of what they are made of: MoorPy's library; wire ropes with what fills them
    "nylon": 1140.0, "polyester": 1380.0, "hmpe": 975.0, "polypropylene": 910.0, "wire-fibre-core": 6810.0, "wire-core": 7850.0,
}  # fmt: skip


@pytest.mark.parametrize(("name", "diameter", "mass"), MASSES)
def test_masses_are_those_of_makers_tables(name, diameter, mass):
    """Within 16 %: what makers differ from each other."""
    assert rope(name, diameter)["mass_per_length"] == pytest.approx(mass, rel=0.16)


@pytest.mark.parametrize(("name", "factors"), [("wire-fibre-core", (0.359, 0.367)), ("wire-core", (0.400, 0.409))])
def test_masses_of_wire_ropes_are_those_of_the_standard(name, factors):
    """W·d²/100 in kg/m, d in mm, of 6x19 and 6x36 (EN 12385); 3 % hold the two constructions."""
    for factor in factors:
        assert rope(name, 0.02)["mass_per_length"] == pytest.approx(factor * 20.0**2 / 100.0, rel=0.03)


@pytest.mark.parametrize("name", FITS)
@pytest.mark.parametrize("diameter", [0.012, 0.08])
def test_stiffness_is_that_of_the_source(name, diameter):
    """Its own restatement, rounded to two digits: 2 %."""
    static, dynamic = FITS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RopeWarning)
        assert rope(name, diameter)["EA"] == pytest.approx(static(diameter), rel=0.01)
        for percent in (0.0, 10.0, 40.0):
            tension = 0.01 * percent * ROPES[name].breaking_load(diameter)
            assert rope(name, diameter, tension=tension)["EA"] == pytest.approx(dynamic(diameter, percent), rel=0.02)


@pytest.mark.parametrize(("inch", "load", "EA"), [(1.0, 1.495e5, 5.29e5), (2.1, 6.806e5, 24.09e5), (3.5, 17.081e5, 60.46e5)])
def test_nylon_is_as_strong_and_as_stiff_as_the_navys(inch, load, EA):
    """UFC 4-159-03, table 6-8, double-braided nylon [N]: strength within 20 %; stiffness, where papers differ tenfold, within 2."""
    nylon = ROPES["nylon"]
    assert nylon.breaking_load(inch * INCH) == pytest.approx(load, rel=0.2)
    assert EA < nylon.static_EA(inch * INCH) < 2.0 * EA
    assert nylon.breaking_load(inch * INCH, wet=True) == pytest.approx(0.85 * nylon.breaking_load(inch * INCH), rel=1e-15)


@pytest.mark.parametrize(("name", "load", "EA", "outer"), [
    ("polypropylene", 105990e3, 1.06e9, 0.80), ("wire-fibre-core", 584175e3, 3.67e10, 0.82), ("wire-core", 633358e3, 4.04e10, 0.80),
])  # fmt: skip
def test_orcaflexs_ropes(name, load, EA, outer):
    """OrcaFlex's formulas at 24 mm, in N and m: of the square of the diameter."""
    fields = rope(name, 0.024)
    assert ROPES[name].breaking_load(0.024) == pytest.approx(load * 0.024**2, rel=1e-12)
    assert (fields["EA"], fields["diameter"]) == pytest.approx((EA * 0.024**2, outer * 0.024), rel=1e-12)


@pytest.mark.parametrize("name", ROPES)
def test_outer_diameter_is_that_of_the_volume(name):
    """d_v = √(4 m/(π rho)): 1 % holds what its two digits leave."""
    kind = ROPES[name]
    assert kind.dv == pytest.approx(math.sqrt(4.0 * kind.m2 / (math.pi * DENSITIES[name])), rel=0.01)


@pytest.mark.parametrize("name", ROPES)
def test_a_cable_takes_what_a_rope_says(name):
    kind = ROPES[name]
    diameter = math.sqrt(math.prod(kind.diameters)) if kind.diameters else 0.02
    with warnings.catch_warnings():
        warnings.simplefilter("error" if kind.diameters else "ignore", RopeWarning)
        cable = Cable("a", "b", length=5.0, segments=20, **rope(name, diameter))
    assert (cable.mass_per_length, cable.EA) == (kind.m2 * diameter**2, kind.static_EA(diameter))
    assert cable.diameter == kind.dv * diameter
    assert cable.Cdn == (kind.Cdn or 1.2) and cable.Can == (kind.Can or 1.0)


@pytest.mark.parametrize(
    ("name", "diameter", "message"),
    [
        ("nylon", 0.004, r'rope "nylon" were compared with ropes of 4.76 to 92.1 mm, but diameter=4 mm'),
        ("polyester", 0.3, r"ropes of 6 to 290 mm, but diameter=300 mm: prefer the maker's data"),
        ("wire-core", 0.061, r"ropes of 6 to 60 mm, but diameter=61 mm"),
        ("hmpe", 0.012, r"were compared with no rope of known diameter, but diameter=12 mm"),
    ],
)
def test_a_diameter_that_nothing_was_compared_with_is_a_warning(name, diameter, message):
    with pytest.warns(RopeWarning, match=message):
        rope(name, diameter)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nilon", 0.012), r"Unknown rope 'nilon', did you mean \"nylon\"\?"),
        (("dyneema", 0.012), r"Unknown rope 'dyneema', did you mean \"hmpe\"\?"),
        (("IWRC", 0.012), r"Unknown rope 'IWRC', did you mean \"wire-core\"\?"),
        (("spaghetti", 0.012), r"Unknown rope 'spaghetti'; known: nylon, polyester, hmpe, .*, wire-core\."),
        ((["nylon"], 0.012), r"Unknown rope \['nylon'\]"),
        (("nylon", -1.0), r'`diameter` must be positive and finite \[m\], but rope "nylon" has diameter=-1.0'),
        (("nylon", 0.012, -1.0), r'`tension` must be non-negative and finite \[N\], but rope "nylon" has tension=-1.0'),
        (("nylon", 0.012, 1e6), r'`tension` must not exceed the breaking load, 3.021e\+04 N, but .* tension=1000000.0'),
        (("wire-core", 0.012, 1.0), r"`tension` must be None where the source has no dynamic stiffness, but rope \"wire-core\""),
    ],
)  # fmt: skip
def test_messages(arguments, message):
    name, diameter, *tension = arguments
    with pytest.raises(SceneError, match=message):
        rope(name, diameter, **({"tension": tension[0]} if tension else {}))


def scene_of(cable, **shared):
    points = [{"name": "a", "kind": "fixed", "at": [0, 0, 0]}, {"name": "b", "kind": "free"}]
    ends = {"start": "a", "end": "b", "length": 2.0, "segments": 10}
    return scene_from_dict({"points": points, "cables": [ends | cable]} | ({"cable_defaults": shared} if shared else {}))


def test_a_scene_file_may_name_the_rope():
    fields = rope("nylon", 0.012)
    (cable,) = scene_of({"rope": "nylon", "diameter": 0.012}).cables
    assert {key: getattr(cable, key) for key in fields} == fields
    (cable,) = scene_of({"diameter": 0.016, "EA": 1e5}, rope="polyester").cables
    assert (cable.EA, cable.mass_per_length) == (1e5, rope("polyester", 0.016)["mass_per_length"])


@pytest.mark.parametrize(
    ("cable", "message"),
    [
        ({"rope": "nylon"}, r"^scene, cable .a-b.: key `diameter` is missing; a rope needs its nominal diameter \[m\]"),
        ({"rope": "nilon", "diameter": 0.012}, r"^scene, cable .a-b.: Unknown rope 'nilon', did you mean \"nylon\""),
        ({"rope": "nylon", "diameter": "12mm"}, r"^scene, cable .a-b.: Argument `diameter` must be positive .* diameter='12mm'"),
        ({"rope": "nylon", "diameter": 0.012, "mas": 1.0}, r"^scene, cable .a-b.: unknown key `mas`"),
    ],
)
def test_messages_of_a_scene_file(cable, message):
    with pytest.raises(SceneError, match=message):
        scene_of(cable)
