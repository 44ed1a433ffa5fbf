"""A scene with other values of its fields, by the names that sweeps have for them, is the scene that its table describes."""

import threading

import pytest
from hanging import held_net

from anet_lumped import CableCut, PayloadChange, SceneError, load_scene, wind
from anet_lumped.effects import Air, Gravity
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from anet_lumped.scene.scene import Scene
from anet_lumped.scene.varied import Varied, VaryError, found, known_fields

SCENES = ["net_carried", "mooring", "tether", "quadrotors_scoop"]


@pytest.mark.parametrize("name", SCENES)
def test_the_same_values_give_the_same_scene(name):
    """Every field that has one value, put in as it is."""
    scene = load_scene(name)
    for field, places in known_fields(scene_to_dict(scene)).items():
        values = [place.value for place in places]
        if values[0] is not None and all(value == values[0] for value in values) and "EA" not in field:
            made = Varied(scene, [field]).with_values({field: values[0]})
            assert scene_to_dict(made) == scene_to_dict(scene), field


@pytest.mark.parametrize("name", [*SCENES[:3], pytest.param(SCENES[3], marks=pytest.mark.slow)])
def test_other_numbers_are_those_of_the_table(name):
    """Each number half as large again, where the scene takes it, or refused as the table is."""
    scene = load_scene(name)
    for field, places in known_fields(scene_to_dict(scene)).items():
        if not all(isinstance(place.value, float) for place in places):
            continue
        value, table = 1.5 * places[0].value + 0.01, scene_to_dict(scene)
        for place in found(known_fields(table), field):
            place.container[place.key] = value
        for cable in table["cables"]:
            for key in ("BA", "diameter"):
                if cable[key] is None:
                    del cable[key]
            if field.rpartition(".")[2] == "BA" and cable.get("BA") == value:
                del cable["zeta"]
        try:
            expected = scene_to_dict(scene_from_dict(table))
        except SceneError:
            with pytest.raises(SceneError):
                Varied(scene, [field]).with_values({field: value})
            continue
        assert scene_to_dict(Varied(scene, [field]).with_values({field: value})) == expected, field


def test_zeta_and_BA_exclude_each_other():
    damped = held_net(BA=3.0)
    assert {one.zeta for one in Varied(damped, ["zeta"]).with_values({"zeta": 0.2}).cables} == {0.2}
    assert {one.BA for one in Varied(held_net(zeta=0.1), ["BA"]).with_values({"BA": 2.0}).cables} == {2.0}
    one = Varied(damped, ["s1-p0.zeta"]).with_values({"s1-p0.zeta": 0.2})
    assert [cable.BA for cable in one.cables] == [3.0, None, 3.0, 3.0]


def test_cables_that_are_alike_stay_so_and_keep_their_names():
    net = held_net(lengths=(1.0, 1.2, 1.0, 1.2))
    made = Varied(net, ["EA", "s3-p0.length"]).with_values({"EA": 5.0, "s3-p0.length": 1.4})
    assert [(one.name, one.start, one.EA, one.length) for one in made.cables] == [
        (f"s{i}-p0", f"s{i}", 5.0, length) for i, length in enumerate((1.0, 1.2, 1.0, 1.4))
    ]
    with pytest.raises(SceneError, match=r'cable "s0-p0" has EA=-1\.0'):
        Varied(net, ["EA"]).with_values({"EA": -1.0})


def test_a_cut_of_a_segment_that_is_no_more_is_refused():
    net = held_net(segments=4)
    net = Scene(net.points, net.cables, net.effects, [CableCut("s0-p0", 0.1, 3)])
    with pytest.raises(SceneError, match="A cut must be of a segment of its cable"):
        Varied(net, ["segments"]).with_values({"segments": 2})


def test_events_and_winds_vary():
    net = held_net(segments=2, diameter=0.01)
    net = Scene(net.points, net.cables, [Gravity(), Air(wind=wind.Uniform((1.0, 0.0, 0.0)))], [PayloadChange("p0", 0.1, 0.2)])
    made = Varied(net, ["events.0.mass", "air.wind.velocity.y"]).with_values({"events.0.mass": 0.7, "air.wind.velocity.y": 3.0})
    assert made.events[0].mass == 0.7 and made.effects[1].wind.velocity == (1.0, 3.0, 0.0)


def test_threads_get_what_they_ask_for():
    varied, found_in = Varied(held_net(), ["EA", "p0.mass"]), {}

    def ask(k):
        for n in range(100):
            value = 1.0 + 1000.0 * k + n
            scene = varied.with_values({"EA": value, "p0.mass": value})
            assert {one.EA for one in scene.cables} == {scene.point("p0").mass} == {value}
        found_in[k] = True

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found_in) == 4


def test_a_name_that_nothing_has_is_refused_with_the_nearest():
    with pytest.raises(VaryError, match="Nothing called `massper_length` can be varied here, did you mean `mass_per_length`"):
        Varied(held_net(), ["massper_length"])


def test_of_two_names_of_a_number_that_of_fewer_numbers_counts_whatever_their_order():
    """The later one counted, so that a table told a value that its run had not."""
    scene = load_scene("net_held")
    for names in (("EA", "s0-p0.EA"), ("s0-p0.EA", "EA")):
        made = Varied(scene, names).with_values({"EA": 1e3, "s0-p0.EA": 2e3})
        assert [one.EA for one in made.cables] == [2e3, 1e3, 1e3, 1e3]


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (("s0.at", "s0.at.z"), "`s0.at.z` is a part of `s0.at`"),
        (("s0.at.z", "s0.at"), "`s0.at.z` is a part of `s0.at`"),
        (("s0.at", "at.z"), "`at.z` is a part of `s0.at`"),
        (("p0.mass", "mass"), "`p0.mass` and `mass` are the same in this scene"),
        (("s0.at.z", "s0.at.2"), "`s0.at.z` and `s0.at.2` are the same in this scene"),
    ],
)
def test_a_number_that_varies_twice_is_refused(names, told):
    with pytest.raises(VaryError, match=f"What varies must be given once, but {told}"):
        Varied(load_scene("net_held"), names)
