"""Nets: as many twines, as heavy and as hard to drag as the netting that they stand for, however coarse they are."""

import math

import numpy as np
import pytest

from anet_lumped import Driven, InputError, Scene, SceneError, State, equilibrium, nets, paths, rope, wind
from anet_lumped.effects import Gravity, Water
from anet_lumped.results.end_forces import effect_forces, rows_of_state
from anet_lumped.scene.as_dict import scene_from_dict

KIND = {"mass_per_length": 0.01, "EA": 5e3, "zeta": 0.05}
SQUARE = [(0, 0, 0), (1.2, 0, 0), (1.2, 0.8, 0), (0, 0.8, 0)]
UPRIGHT = [(0, 0, -1.0), (1.2, 0, -1.0), (1.2, 0, -1.8), (0, 0, -1.8)]
NETTING = nets.Netting(diameter=1.8e-3, bar=20e-3, EA=500.0, speed=0.5)


def mass_of(net):
    own = sum(cable.mass_per_length * cable.length for cable in net.cables)
    return own + sum(getattr(point, "mass", 0.0) for point in net.points)


def test_a_grid_and_its_edges_give_the_same_net():
    grid = nets.grid((3, 2), SQUARE, cable=KIND, knot_mass=0.002, slack=0.05)
    assert len(grid.points) == 12 and len(grid.cables) == 17
    places = {point.name: point.at for point in grid.points}
    edges = [(cable.start, cable.end) for cable in grid.cables]
    corners = ["p0_0", "p3_0", "p3_2", "p0_2"]
    assert nets.from_edges(places, edges, cable=KIND, held=corners, knot_mass=0.002, slack=0.05) == grid
    number = {name: i for i, name in enumerate(places)}
    by_number = nets.from_edges(list(places.values()), [(number[a], number[b]) for a, b in edges], cable=KIND, held=[0, 3, 11, 8])
    assert [cable.length for cable in by_number.cables] == pytest.approx([cable.length / 1.05 for cable in grid.cables])
    assert [type(point) for point in by_number.points] == [type(point) for point in grid.points]


@pytest.mark.parametrize("meshes", [(3, 2), (6, 4), (60, 40)])
def test_a_net_has_the_mass_and_the_volume_of_all_twines_and_knots(meshes):
    """61 twines of 0.8 m and 41 of 1.2 m, 61 x 41 knots: whether a cable stands for one twine or for twenty."""
    netting = nets.Netting(diameter=1.8e-3, bar=20e-3, EA=500.0, speed=0.5, knot_diameter=4e-3)
    net = nets.grid(meshes, SQUARE, netting=netting, held=())
    twine = 1140.0 * math.pi / 4 * 1.8e-3**2
    length, knots = 61 * 0.8 + 41 * 1.2, 61 * 41
    assert mass_of(net) == pytest.approx(twine * length + netting.knot_mass * knots, rel=1e-12)
    volume = sum(math.pi / 4 * cable.diameter**2 * cable.length for cable in net.cables) + sum(p.volume for p in net.points)
    assert volume == pytest.approx(mass_of(net) / 1140.0, rel=1e-12)
    strong = sum(cable.EA for cable in net.cables if cable.start.startswith("p0_") and not cable.end.startswith("p0_"))
    assert strong == pytest.approx(41 * 500.0, rel=1e-12)


def drag(net, speed):
    """Force of a stream along y on a net that is held flat across it [N]."""
    water = Water(density=1025.0, current=wind.Uniform((0.0, speed, 0.0)), g=0.0)
    state = State.of(Scene(net.points, net.cables, [water]), points={point.name: point.at for point in net.points})
    return effect_forces(state.model, rows_of_state(state))[0].sum(axis=0)


@pytest.mark.parametrize("meshes", [(3, 2), (6, 4)])
def test_the_drag_of_a_flat_net_is_that_of_the_screen(meshes):
    """rho/2 C_D A u^2, with the screen model's C_D: apart from the twines at the sides, half a mesh beyond the outline."""
    net = nets.grid(meshes, UPRIGHT, netting=NETTING, held=())
    force = drag(net, 0.5)
    area = 1.2 * 0.8 * (1.0 + 0.5 * 20e-3 / 1.2 + 0.5 * 20e-3 / 0.8)  # 61 x 0.8 m + 41 x 1.2 m of twine, over 2/bar
    assert force[1] == pytest.approx(0.5 * 1025.0 * NETTING.outline_drag * area * 0.25, rel=1e-12)
    assert abs(force[0]) < 1e-12 * force[1]


def test_netting_is_that_of_the_screen_model():
    """Sn = 2 d/b - (d/b)^2; thin twine far apart is a cylinder, whose drag at Re = 1e3 is 1.0 (Goldstein)."""
    assert NETTING.solidity == pytest.approx(0.18 - 0.0081, rel=1e-12)
    thin = nets.Netting(diameter=1e-4, bar=1.0, EA=1.0, speed=11.9)
    assert thin.cable(1.0)["Cdn"] == pytest.approx(1.0, abs=0.02)
    knotted = nets.Netting(diameter=1.8e-3, bar=20e-3, EA=500.0, speed=0.5, knot_diameter=4e-3)
    assert knotted.solidity == pytest.approx(NETTING.solidity + (math.pi / 4 * 4e-3**2 - 1.8e-3**2) / 20e-3**2, rel=1e-12)


def test_a_diagonal_net_hangs_from_its_side_and_is_as_heavy_as_its_square_one():
    """Bars across a field of squares: half as long as fine, twice as many; the border joins every other knot."""
    net = nets.grid((3, 2), SQUARE, cable=KIND, pattern="diagonal", border=KIND | {"EA": 1e4}, held="first side", knot_mass=0.001)
    assert len(net.points) == 4 * 3 + 3 * 2 and len(net.cables) == 4 * 6 + 2 * (3 + 2)
    bars = [cable for cable in net.cables if cable.EA == 5e3]
    assert {round(cable.length, 12) for cable in bars} == {round(math.hypot(0.2, 0.2), 12)}
    rest = equilibrium(Scene(net.points, net.cables, [Gravity(9.81)]))
    pull = sum(rest.reaction(f"p{i}_0")[2] for i in (0, 2, 4, 6))
    assert pull == pytest.approx(9.81 * mass_of(net), rel=1e-9)


def test_diagonal_meshes_have_as_much_twine():
    """Twine on an area: 2/bar in square meshes, whatever way they lie; 12 x 8 real meshes of 0.1 m, rotated by 45 degrees."""
    netting = nets.Netting(diameter=1e-3, bar=math.sqrt(2.0) * 0.05, EA=500.0, speed=0.5)
    coarse, fine = (nets.grid(meshes, SQUARE, netting=netting, pattern="diagonal", held=()) for meshes in ((3, 2), (12, 8)))
    assert mass_of(coarse) == pytest.approx(mass_of(fine), rel=1e-12)
    twine = 1140.0 * math.pi / 4 * 1e-3**2
    assert mass_of(fine) == pytest.approx(twine * 2.0 / netting.bar * 1.2 * 0.8, rel=1e-12)


def test_a_scoop_hangs_in_its_rim():
    net = nets.cone((6, 3), radius=0.5, depth=0.6, cable=KIND, slack=0.02, border=KIND | {"mass_per_length": 0.05})
    assert len(net.points) == 6 * 3 + 1 and len(net.cables) == 6 * 3 + 6 * 3
    rest = equilibrium(Scene(net.points, net.cables, [Gravity(9.81)]))
    assert rest.position("ptip") == pytest.approx([0, 0, rest.position("ptip")[2]], abs=1e-9)
    assert rest.position("ptip")[2] < -0.6
    blunt = nets.cone((4, 2), radius=0.5, depth=0.6, end_radius=0.2, cable=KIND)
    assert np.linalg.norm(blunt.points[-1].at[:2]) == pytest.approx(0.2)


def test_a_mesh_file_gives_each_side_once(tmp_path):
    meshio = pytest.importorskip("meshio")
    points = [[0, 0, 0], [1000, 0, 0], [1000, 1000, 0], [0, 1000, 0], [2000, 0, 0]]
    cells = [("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]]), ("line", [[0, 1]])]
    meshio.Mesh(np.array(points, float), [(kind, np.array(rows)) for kind, rows in cells]).write(tmp_path / "net.vtk")
    net = nets.from_file(tmp_path / "net.vtk", scale=1e-3, cable=KIND, held=[0, 3])
    assert len(net.cables) == 6 and net.points[4].at == (2.0, 0.0, 0.0)
    assert sorted(cable.length for cable in net.cables)[-1] == pytest.approx(math.sqrt(2.0))
    meshio.Mesh(np.array(points, float), [("vertex", np.array([[0]]))]).write(tmp_path / "dots.vtk")
    with pytest.raises(SceneError, match=r"must have lines, triangles, quadrilaterals or polygons, but .* has vertex"):
        nets.from_file(tmp_path / "dots.vtk", cable=KIND)
    with pytest.raises(SceneError, match="must be one that meshio reads"):
        nets.from_file(tmp_path / "none.vtk", cable=KIND)


def test_patches_of_a_mesh_file_hang_together_and_its_other_points_stay_away(tmp_path):
    """CAD programs write the corners of each surface anew, and middles of circles besides; a rim is of one surface alone."""
    meshio = pytest.importorskip("meshio")
    first = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    points = np.array([*first, *(np.add(first, [1, 1e-8, 0])), [9, 9, 9]])
    meshio.Mesh(points, [("quad", np.array([[0, 1, 2, 3], [4, 5, 6, 7]])), ("vertex", np.array([[8]]))]).write(tmp_path / "net.vtk")
    net = nets.from_file(tmp_path / "net.vtk", cable=KIND, border=KIND | {"EA": 1e4}, held=[0, 7])
    assert [point.name for point in net.points] == ["p0", "p1", "p2", "p3", "p5", "p6"]
    assert [point.name for point in net.points if hasattr(point, "mass")] == ["p1", "p3", "p5", "p6"]  # 7 is at the place of 2
    assert [{cable.start, cable.end} for cable in net.cables if cable.EA == 5e3] == [{"p1", "p2"}]
    assert len(net.cables) == 7
    with pytest.raises(SceneError, match="held points must be points of its edges, but 8 is of none"):
        nets.from_file(tmp_path / "net.vtk", cable=KIND, held=[8])
    meshio.Mesh(points[:8], [("quad", np.array([[0, 1, 2, 3]])), ("hexahedron", np.array([range(8)]))]).write(
        tmp_path / "solid.vtk"
    )
    with pytest.raises(SceneError, match=r"lines, triangles, quadrilaterals or polygons, but .* has hexahedron"):
        nets.from_file(tmp_path / "solid.vtk", cable=KIND)
    curved = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 0.1, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0]], float)
    meshio.Mesh(curved, [("quad8", np.array([range(8)]))]).write(tmp_path / "curved.vtk")
    sides = nets.from_file(tmp_path / "curved.vtk", cable=KIND).cables
    assert sum(cable.length for cable in sides) == pytest.approx(6.0 + 2.0 * math.hypot(1.0, 0.1), rel=1e-12)


def test_lines_and_polygons_of_an_obj_file_are_cables_too(tmp_path):
    """As Blender writes them: coordinates of textures, a pentagon, a line, numbers that count back from the last point."""
    lines = [
        "v 0 0 0",
        "v 1 0 0",
        "v 1.5 .5 0",
        "v 1 1 0",
        "v 0 1 0",
        "vt 0 0",
        "f 1/1 2/1 3/1 4/1 5/1",
        "v 0 2 0",
        "l -2 -1 # a line",
    ]
    path = tmp_path / "net.obj"
    path.write_text("\n".join(lines))
    net = nets.from_file(path, cable=KIND, held="p0")
    assert sum(cable.length for cable in net.cables) == pytest.approx(3.0 + 2.0 * math.hypot(0.5, 0.5) + 1.0, rel=1e-12)
    assert {(cable.start, cable.end) for cable in net.cables} >= {("p4", "p5"), ("p0", "p4")}
    with pytest.raises(SceneError, match="must have surfaces for a `border`"):
        path.write_text("v 0 0 0\nv 1 0 0\nl 1 2")
        nets.from_file(path, cable=KIND, border=KIND)
    path.write_text("v 0 0 0\nv 1 0 nan\nl 1 2")
    with pytest.raises(SceneError, match="Points of a mesh file must be finite"):
        nets.from_file(path, cable=KIND)
    for bad in ("f 1 2 9", "v 0 1", "l 0 1", "f one"):
        path.write_text(f"v 0 0 0\nv 1 0 0\n{bad}")
        with pytest.raises(SceneError, match=f'Line 3 of .* must be a point, a face or a line, but is "{bad}"'):
            nets.from_file(path, cable=KIND)


def test_a_scene_file_takes_nets_and_points_in_place_of_theirs():
    lifted = {"start": (0, 0, 0), "velocity": (0, 0, 1.0), "ramp": 1.0}
    entries = {
        "nets": [
            {"kind": "grid", "meshes": [3, 2], "corners": [list(map(float, at)) for at in SQUARE], "cable": KIND, "slack": 0.05},
            {"kind": "cone", "meshes": [4, 2], "radius": 0.5, "depth": 0.6, "cable": KIND, "name": "c"},
        ],
        "points": [{"name": "p0_0", "kind": "driven", "path": {"kind": "line"} | lifted}],
        "effects": {"gravity": {}},
    }
    scene = scene_from_dict(entries)
    grid, cone = nets.grid((3, 2), SQUARE, cable=KIND, slack=0.05), nets.cone((4, 2), radius=0.5, depth=0.6, cable=KIND, name="c")
    path = paths.line(**lifted)
    assert scene == Scene([Driven("p0_0", path), *grid.points[1:], *cone.points], grid.cables + cone.cables, [Gravity()])
    of_netting = {"kind": "grid", "meshes": [3, 2], "corners": entries["nets"][0]["corners"]}
    netting = {"diameter": 1.8e-3, "bar": 20e-3, "EA": 500.0, "speed": 0.5}
    woven = scene_from_dict({"nets": [of_netting | {"netting": netting}]})
    assert woven.cables == nets.grid((3, 2), SQUARE, netting=NETTING).cables
    with pytest.raises(SceneError, match=r"scene, nets\[0\].netting: unknown key `bars`, did you mean `bar`"):
        scene_from_dict({"nets": [of_netting | {"netting": netting | {"bars": 1.0}}]})
    with pytest.raises(SceneError, match=r"nets\[0\]: A cone must have at least 3 meshes around"):
        scene_from_dict({"nets": [entries["nets"][1] | {"meshes": [2, 2]}]})


def refusals():
    grid = {"meshes": (3, 2), "corners": SQUARE, "cable": KIND}
    edges = {"points": [(0, 0, 0), (1, 0, 0), (2, 0, 0)], "edges": [(0, 1), (1, 2)], "cable": KIND}
    cone = {"meshes": (6, 3), "radius": 0.5, "depth": 0.6, "cable": KIND}
    netting = {"diameter": 1.8e-3, "bar": 20e-3, "EA": 500.0, "speed": 0.5}
    return [
        (nets.grid, grid | {"meshes": 3}, "two numbers of meshes"),
        (nets.grid, grid | {"pattern": "round"}, "`pattern` must be one of square, diagonal, but"),
        (nets.grid, grid | {"corners": SQUARE[:3]}, r"`corners` must be \(4, 3\) numbers \[m\]"),
        (nets.grid, grid | {"corners": [(0, 0, math.nan)] * 4}, r"`corners` must be finite"),
        (nets.grid, grid | {"held": "side"}, '`held` must be "corners", "sides", "first side" or names of points'),
        (nets.grid, grid | {"held": ["p9_9"]}, "`held` must name points of the net, but"),
        (nets.grid, grid | {"cable": None}, "must have a `cable` or a `netting`"),
        (nets.grid, grid | {"cable": 3}, "`cable` of a net must be a dict of a cable's arguments"),
        (nets.grid, grid | {"cable": KIND | {"length": 1.0}}, "A net gives its cables length"),
        (nets.grid, grid | {"cable": KIND | {"ea": 1.0}}, "Cables have no argument `ea`, did you mean `EA`"),
        (nets.grid, grid | {"slack": -1.0}, "`slack` must be above -1"),
        (nets.from_edges, edges | {"edges": [(0, 3)]}, "A net's edges must be given by numbers from 0 to 2, but one is 3"),
        (nets.from_edges, edges | {"edges": [4]}, "A net's edges must be pairs of points, but one is 4"),
        (nets.from_edges, edges | {"edges": [(0, 1)]}, 'must be the end of an edge, but "p2" is of none'),
        (nets.from_edges, edges | {"held": ["p9"]}, "A net's held points must be given by numbers"),
        (nets.from_edges, edges | {"border_edges": [(0, 1)]}, "`border` must be given for border_edges"),
        (nets.from_edges, edges | {"border_edges": [(0, 2)], "border": KIND}, "border_edges must be among its edges, but p0 to p2"),
        (nets.from_edges, edges | {"border": KIND}, "`border_edges` must be given for a border"),
        (nets.from_edges, edges | {"edges": [(0, 1), (1, 2), (1, 0)]}, 'given once each, but "p1" to "p0" is there twice'),
        (nets.from_edges, edges | {"edges": [(0, 1), (1, 1)]}, 'one joins "p1" to itself'),
        (nets.from_edges, edges | {"edges": 5}, "A net's edges must be a list of them, but it has 5"),
        (nets.from_edges, edges | {"held": 0.5}, "held points must be a list of them, but it has 0.5"),
        (nets.grid, grid | {"cable": {"EA": 5e3}}, "`cable` of a net must have `mass_per_length`, but it does not"),
        (nets.grid, grid | {"border": {"EA": 5e3}}, "`border` of a net must have `mass_per_length`, but it does not"),
        (nets.grid, grid | {"corners": [SQUARE[k] for k in (0, 2, 1, 3)]}, "go around a field in one turn"),
        (nets.grid, grid | {"corners": [(0, 0, 0), (2, 0, 0), (0.5, 0.5, 0), (0, 2, 0)]}, "go around a field in one turn"),
        (nets.grid, grid | {"corners": [(k, 0, 0) for k in (0, 1, 3, 2)]}, "lie in one line"),
        (nets.grid, grid | {"meshes": (10**5, 10**5)}, "A grid of 100000 by 100000 meshes would take 2e.13 bytes"),
        (nets.cone, cone | {"meshes": (10**5, 10**5)}, "A cone of 100000 by 100000 meshes would take 2e.13 bytes"),
        (nets.cone, cone | {"meshes": (2, 3)}, "at least 3 meshes around, but it has 2"),
        (nets.cone, cone | {"meshes": 4}, "two numbers of meshes, but a cone"),
        (nets.Netting, netting | {"bar": 4e-3}, "must cover less than 0.5 of its outline"),
        (nets.Netting, netting | {"speed": 1e-3}, r"known from Re=32 to 10000, but twine of 0.0018 m"),
    ]  # fmt: skip


@pytest.mark.parametrize(("make", "arguments", "message"), refusals())
def test_what_is_no_net_is_refused(make, arguments, message):
    with pytest.raises(InputError, match=message):
        make(**arguments)


def test_one_name_is_enough_for_one_point_that_is_held():
    assert nets.grid((3, 2), SQUARE, cable=KIND, held="p3_0") == nets.grid((3, 2), SQUARE, cable=KIND, held=["p3_0"])
    places, edges = {"ab": (0, 0, 0), "a": (1, 0, 0), "b": (2, 0, 0)}, [("ab", "a"), ("a", "b")]
    assert nets.from_edges(places, edges, cable=KIND, held="ab") == nets.from_edges(places, edges, cable=KIND, held=["ab"])


def test_what_all_cables_of_a_file_share_holds_for_those_of_its_nets():
    """It is as if each net said it; lengths are those of the meshes, and the numbers of a netting its own."""
    shared = {"mass_per_length": 0.01, "EA": 5e3, "zeta": 0.05, "length": 7.0}
    net = {"kind": "grid", "meshes": [3, 2], "corners": [list(at) for at in SQUARE]}
    said = scene_from_dict({"nets": [net | {"cable": KIND, "border": KIND | {"EA": 1e4}}]})
    assert scene_from_dict({"cable_defaults": shared, "nets": [net | {"border": {"EA": 1e4}}]}) == said
    assert scene_from_dict({"cable_defaults": shared | {"EA": 1.0}, "nets": [net | {"cable": KIND, "border": {"EA": 1e4}}]}) == said
    netting = {"netting": {"diameter": 1.8e-3, "bar": 20e-3, "EA": 500.0, "speed": 0.5}}
    own = scene_from_dict({"nets": [net | netting | {"cable": {"zeta": 0.05}}]})
    assert scene_from_dict({"cable_defaults": shared, "nets": [net | netting]}) == own
    roped = scene_from_dict({"cable_defaults": {"rope": "nylon", "diameter": 0.01}, "nets": [net]})
    assert {cable.EA for cable in roped.cables} == {rope("nylon", 0.01)["EA"]}
    with pytest.raises(SceneError, match=r"nets\[0\]\.cable: must be a table of keys and values, but is 3"):
        scene_from_dict({"nets": [net | {"cable": 3}]})
