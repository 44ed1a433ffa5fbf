"""Scene → Model: masses, numbers of nodes and segments, cables turned about, fill and order of the elimination."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import Cable, Driven, Fixed, Free, Scene, SceneError
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.effects.signatures import SLOTS, addresses
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths


def cable(start, end, segments=4, **kwargs):
    return Cable(start, end, **dict(length=1.0, mass_per_length=0.1, EA=1e3, segments=segments) | kwargs)


def everything():
    """Each kind of point and cable: held, driven, junctions, loose end, parallel, one segment, backwards."""
    return Scene(
        [
            Free("x", 0.5),
            Driven("d", paths.line((1, 0, 0), (0.1, 0, 0), ramp=1.0)),
            Fixed("a", (0, 0, 0)),
            Free("y"),
            Free("loose", 0.01),
            Fixed("b", (0, 1, 0)),
        ],
        [
            cable("a", "x", 3, length=0.9, EA=2e3, zeta=0.1),
            cable("x", "b", 1, compression="linear"),
            cable("d", "y", 5, mass_per_length=0.3, compression="damped", BA=2.0),
            cable("x", "y", 4, name="there"),
            cable("y", "x", 2, name="back"),
            cable("loose", "y", 6),
            cable("a", "b", 7),
        ],
        [Gravity(), ViscousDamping(0.5)],
    )


# Masses --------------------------------------------------------------------------------------------------------------


def test_masses_add_up_to_the_scene():
    scene = everything()
    points = sum(p.mass for p in scene.points if isinstance(p, Free))
    cables = sum(c.mass_per_length * c.length for c in scene.cables)
    assert build(scene).mass.sum() == pytest.approx(points + cables, rel=1e-14)


def test_a_node_carries_half_of_each_segment_beside_it():
    scene = Scene([Fixed("a", (0, 0, 0)), Free("end")], [cable("a", "end", 4)])
    model = build(scene)
    assert model.mass[model.nodes("a-end")] == pytest.approx([0.0125, 0.025, 0.025, 0.025, 0.0125], rel=1e-14)


def test_a_junction_carries_its_own_mass_and_half_segments():
    model = build(everything())
    segments = {"a-x": 0.09 / 3, "x-b": 0.1, "there": 0.1 / 4, "back": 0.1 / 2}
    assert model.mass[model.node("x")] == pytest.approx(0.5 + 0.5 * sum(segments.values()), rel=1e-14)
    assert model.mass[model.node("loose")] == pytest.approx(0.01 + 0.5 * 0.1 / 6, rel=1e-14)


# Numbers -------------------------------------------------------------------------------------------------------------


def test_nodes_are_numbered_interior_free_fixed_driven():
    scene = everything()
    model = build(scene)
    interior = np.concatenate([model.nodes(c.name)[1:-1] for c in scene.cables])
    by_kind = {kind: [model.node(p.name) for p in scene.points if isinstance(p, kind)] for kind in (Free, Fixed, Driven)}
    assert sorted(interior) == list(range(model.n_interior)) and model.n_interior == 21
    assert sorted(by_kind[Free]) == list(range(model.n_interior, model.n_free))
    assert sorted(by_kind[Fixed]) == list(range(model.n_free, model.n_driven))
    assert by_kind[Driven] == list(range(model.n_driven, model.n))


def test_nodes_and_segments_run_from_start_to_end():
    scene = everything()
    model = build(scene)
    assert sorted(np.concatenate([np.arange(model.n_segments)[model.segments(c.name)] for c in scene.cables])) == list(
        range(model.n_segments)
    )
    for one in scene.cables:
        nodes, segments = model.nodes(one.name), np.arange(model.n_segments)[model.segments(one.name)]
        assert len(nodes) == one.segments + 1 and len(segments) == one.segments
        assert (nodes[0], nodes[-1]) == (model.node(one.start), model.node(one.end))
        for (i, j), s in zip(itertools.pairwise(nodes), segments, strict=True):
            assert {i, j} == set(model.ends[s])
        assert (model.cable_of[segments] == scene.cables.index(one)).all()


@pytest.mark.parametrize("ends", [("a", "end"), ("end", "a")])
def test_a_cable_is_eliminated_towards_its_free_end(ends):
    """Whichever way it is written; what is shown keeps the way it is written."""
    scene = Scene([Fixed("a", (0, 0, 0)), Free("end")], [cable(*ends, 3, name="c")])
    model = build(scene)
    assert model.ends.tolist() == [[3, 0], [0, 1], [1, 2]]
    assert model.nodes("c").tolist() == ([3, 0, 1, 2] if ends[0] == "a" else [2, 1, 0, 3])
    assert list(range(3))[model.segments("c")] == ([0, 1, 2] if ends[0] == "a" else [2, 1, 0])


def test_a_flipped_cable_that_comes_second_keeps_its_own_segments():
    scene = Scene([Fixed("a", (0, 0, 0)), Free("p"), Free("q")], [cable("p", "a", 2, name="1"), cable("q", "a", 3, name="2")])
    model = build(scene)
    assert list(range(5))[model.segments("1")] == [1, 0] and list(range(5))[model.segments("2")] == [4, 3, 2]


def test_law_of_each_cable():
    scene = everything()
    model = build(scene)
    one = model.axial[[c.name for c in scene.cables].index("a-x")]
    assert one[:5] == pytest.approx([0.3, 2e3 / 0.3, 0.1 * np.sqrt(2e3 * 0.1), 0, 0], rel=1e-14)  # c = BA/L0 = zeta sqrt(EA mu)
    assert model.axial[2, :5] == pytest.approx([0.2, 5e3, 10.0, 0, 1], rel=1e-14)
    assert model.axial[1, 3:5].tolist() == [1, 1]


def test_names_that_do_not_exist():
    model = build(everything())
    with pytest.raises(SceneError, match='The scene has no point "z"'):
        model.node("z")
    with pytest.raises(SceneError, match='The scene has no cable "a-z"'):
        model.nodes("a-z")


# Scratch and effects -------------------------------------------------------------------------------------------------


def test_a_net_has_scratch_of_its_own():
    model = build(everything())
    one, other = fresh_net(model), fresh_net(model)
    one.points.block[:] = one.newton_step[:] = 1.0
    assert not other.points.block.any() and not other.newton_step.any() and one.mass is other.mass


def test_effects_that_a_scene_lacks_take_no_room():
    bare = build(Scene([Fixed("a", (0, 0, 0)), Free("p")], [cable("a", "p")]))
    assert bare.effects.address.shape == (0, len(SLOTS)) and bare.effects.params.size == 0
    model = build(everything())
    assert model.effects.address.tolist() == [addresses(effect) for effect in model.scene.effects]
    assert model.effects.params_at.tolist() == [0, 3 + model.n_free, 3 + 2 * model.n_free]


def test_an_effect_not_asked_for_has_no_entry():
    scene = everything()
    for effects, n in (((), 0), ((Gravity(),), 1), ((ViscousDamping(1.0), Gravity()), 2)):
        table = build(Scene(scene.points, scene.cables, effects)).effects
        assert table.address.shape == (n, len(SLOTS)) and len(table.index_at) == len(table.params_at) == n + 1


# Elimination of the free points --------------------------------------------------------------------------------------


def grid(rows, columns):
    """A mesh of free points, whose elimination fills in."""
    free = [f"{i},{j}" for i in range(rows) for j in range(columns)]
    links = [(f"{i},{j}", f"{i},{j + 1}") for i in range(rows) for j in range(columns - 1)]
    links += [(f"{i},{j}", f"{i + 1},{j}") for i in range(rows - 1) for j in range(columns)]
    return free, [*links, ("a", free[0])]


@st.composite
def graphs(draw):
    """Free points in any graph that hangs together, parallel cables among them."""
    free = [f"p{i}" for i in range(draw(st.integers(1, 9)))]
    links = [("a", free[0])] + [(free[draw(st.integers(0, i - 1))], free[i]) for i in range(1, len(free))]
    pairs = list(itertools.combinations(free, 2))
    return free, links + (draw(st.lists(st.sampled_from(pairs), max_size=12)) if pairs else [])


def net_of(free, links):
    cables = [cable(a, b, 1 + i % 3, name=f"c{i}") for i, (a, b) in enumerate(links)]
    return build(Scene([Fixed("a", (0, 0, 0)), *(Free(p) for p in free)], cables))


def filled(model, free, links):
    """Blocks of the free points' matrix that a dense elimination in the model's order makes other than zero."""
    rank = {p: model.node(p) - model.n_interior for p in free}
    full = np.eye(len(free), dtype=bool)
    for a, b in links:
        if a in rank and b in rank:
            full[rank[a], rank[b]] = full[rank[b], rank[a]] = True
    for p in range(len(free)):
        rest = np.flatnonzero(full[p, p + 1 :]) + p + 1
        full[np.ix_(rest, rest)] = True
    return full


def check_symbolic(model, free, links):
    points, full = model.symbolic, filled(model, free, links)
    place = {(p, p): p for p in range(len(free))}
    for p in range(len(free)):
        row = slice(points.later_at[p], points.later_at[p + 1])
        later = points.later[row].tolist()
        assert later == (np.flatnonzero(full[p, p + 1 :]) + p + 1).tolist()
        for q, upper, lower in zip(later, points.upper[row], points.lower[row], strict=True):
            place[p, q], place[q, p] = upper, lower
    assert sorted(place.values()) == list(range(len(points.block))) and len(place) == full.sum()
    for p in range(len(free)):
        later = points.later[points.later_at[p] : points.later_at[p + 1]].tolist()
        updates = points.target[points.target_at[p] : points.target_at[p + 1]].tolist()
        assert updates == [place[i, j] for i in later for j in later]
    for c, (a, b) in enumerate(links):
        start, end, bordered, start_end, end_start = model.cable[c, 3:8]
        assert bordered == (a in free and b in free)
        if bordered:
            s, e = start - model.n_interior, end - model.n_interior
            assert (start_end, end_start) == (place[s, e], place[e, s])


@tried(100)
@given(graphs())
def test_symbolic_elimination_is_that_of_a_dense_one(graph):
    check_symbolic(net_of(*graph), *graph)


def test_symbolic_elimination_of_a_mesh():
    """Least degree first leaves a 12 x 12 mesh 1,908 blocks of 20,736; in the order of its rows it is 3,334."""
    free, links = grid(12, 12)
    model = net_of(free, links)
    check_symbolic(model, free, links)
    assert len(model.symbolic.block) <= 1908


def test_a_tree_fills_in_nothing():
    free = [f"p{i}" for i in range(15)]
    links = [("a", "p0")] + [(free[(i - 1) // 2], free[i]) for i in range(1, 15)]
    assert len(net_of(free, links).symbolic.block) == 15 + 2 * 14


def test_frequencies_beyond_all_numbers_are_refused():
    cable = Cable("a", "b", length=1e-99, mass_per_length=1e-99, EA=1e4, segments=4)
    with pytest.raises(
        SceneError, match=r'frequencies of a cable must be up to 1e\+100 rad/s, but cable "a-b" has segments of \S+ N/m on nodes of'
    ):
        build(Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.1)], [cable]))
