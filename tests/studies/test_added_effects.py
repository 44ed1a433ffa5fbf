"""Effects that the command line adds to a scene, and fields of those that it sets."""

import pytest

from anet_lumped import Cable, Fixed, Free, InputError, Scene, load_scene, waves, wind
from anet_lumped.effects import Air, Gravity, Ground, Water
from studies.added_effects import with_effects
from studies.command_line import main
from studies.scenes import changed

CABLE = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=2, diameter=0.01)
SCENE = Scene([Fixed("a", (0, 0, 0)), Free("b")], [CABLE], [Gravity(9.81)])
SEA = Water(waves=[waves.Airy(1.0, 8.0), waves.Airy(0.5, 5.0)])


@pytest.mark.parametrize(
    ("texts", "effect"),
    [
        (["air"], Air()),
        (["air.wind.speed=10"], Air(wind=wind.Uniform((10.0, 0.0, 0.0)))),
        (["air.wind.speed=10", "air.wind.direction=[0,-3,4]"], Air(wind=wind.Uniform((0.0, -6.0, 8.0)))),
        (["air.wind.velocity=[1,2,3]", "air.density=1.1"], Air(1.1, wind=wind.Uniform((1.0, 2.0, 3.0)))),
        (["air.wind.speed=8", "air.wind.height=10", "air.wind.exponent=0.2"], Air(wind=wind.PowerLaw(8.0, 10.0, 0.2))),
        (["air.wind.speed=8", "air.wind.height=10", "air.wind.roughness=0.1"], Air(wind=wind.Logarithmic(8.0, 10.0, 0.1))),
        (["water.waves.height=1", "water.waves.period=8", "water.waves.depth=inf"], Water(waves=waves.Airy(1.0, 8.0))),
        (["water.waves.kind=jonswap", "water.waves.height=1", "water.waves.period=8", "water.waves.seed=3"],
         Water(waves=waves.Jonswap(1.0, 8.0, 3))),
        (["ground.height=-3", "ground.stiffness=1e4"], Ground(-3.0, 1e4)),
    ],
)  # fmt: skip
def test_an_effect_is_added(texts, effect):
    assert with_effects(SCENE, texts).effects == (Gravity(9.81), effect)


def test_an_effect_takes_what_it_lacks():
    wet = Scene(SCENE.points, SCENE.cables, [Gravity(9.81), Water(1000.0, 2.0)])
    sea = with_effects(wet, ["water.waves.height=1", "water.waves.period=8", "water.current.speed=0.5"])
    assert sea.effects[1] == Water(1000.0, 2.0, wind.Uniform((0.5, 0.0, 0.0)), waves=waves.Airy(1.0, 8.0))
    with pytest.raises(InputError, match=r'but it has "water.waves"; --set changes it'):
        with_effects(sea, ["water.waves.phase=1"])


def test_nothing_added_is_the_scene_itself():
    assert with_effects(SCENE, ()) is SCENE


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["gravity.g=3"], 'The scene must not have what --effect adds, but it has "gravity.g"; --set changes it'),
        (["gravity"], 'The scene must not have what --effect adds, but it has "gravity"; --set changes it'),
        (["air.wind"], r'must be NAME or NAME.KEY=VALUE, as in air.wind.speed=10, but "air.wind" was given'),
        (["air.density="], 'must be NAME or NAME.KEY=VALUE, as in air.wind.speed=10, but "air.density=" was given'),
        (["air..density=1"], "must be NAME or NAME.KEY=VALUE"),
        (["air=1"], "must be NAME or NAME.KEY=VALUE"),
        (["air.density=1", "air.density=2"], "A key of an effect must be given once, but air.density is given again"),
        (["air.wind=1", "air.wind.speed=2"], "A key of an effect must be given once, but air.wind.speed is given again"),
        (["air.wind.sped=1"], "The kind of air.wind must be given, as in --effect air.wind.kind=KIND; one of uniform, power_law, "),
        (["water.waves.height=1", "water.waves.period=8", "water.waves.seed=1"], "KIND; one of jonswap, pierson_moskowitz"),
        (["air.wind.speed=fast"], r"`speed` must be a finite number \[m/s\], but air.wind has speed='fast'"),
        (["air.density=much"], "effects.air: key `density` has the wrong type"),
        (["ari.density=1"], 'unknown effect .ari., did you mean "air"'),
        (["air.densty=1"], "effects.air: unknown key `densty`, did you mean `density`"),
    ],
)
def test_messages(texts, message):
    with pytest.raises(InputError, match=message):
        with_effects(SCENE, texts)


def test_fields_of_a_wave_are_set():
    """Of one wave by the name of the argument, of several by their place among them; and of an effect that was just added."""
    one = Scene(SCENE.points, SCENE.cables, [Gravity(9.81), Water(waves=waves.Airy(1.0, 8.0))])
    assert changed(one, ["water.waves.height=2"]).effects[1].waves.height == 2.0
    two = Scene(SCENE.points, SCENE.cables, [Gravity(9.81), SEA])
    assert [wave.height for wave in changed(two, ["water.waves.1.height=2"]).effects[1].waves] == [1.0, 2.0]
    added = changed(SCENE, ["water.waves.height=2"], ["water.waves.height=1", "water.waves.period=8"])
    assert added.effects[1].waves == waves.Airy(2.0, 8.0)


def test_a_diameter_may_be_set_where_there_is_none():
    bare = Scene(SCENE.points, [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=2)], [Gravity(9.81)])
    assert changed(bare, ["a-b.diameter=0.02"]).cables[0].diameter == 0.02 and changed(bare, ["EA=2e3"]).cables[0].diameter is None


def test_on_the_command_line(tmp_path, capsys):
    words = ["convert", "net_flown", str(tmp_path / "net.toml"), "--effect", "water.level=-9", "--effect", "water.waves.height=0.5"]
    with pytest.raises(SystemExit) as stopped:
        main([*words, "--effect", "water.waves.period=5", "--set", "water.waves.height=0.4"])
    assert stopped.value.code == 0, capsys.readouterr().err
    assert load_scene(tmp_path / "net.toml").effects[-1] == Water(level=-9.0, waves=waves.Airy(0.4, 5.0))
    with pytest.raises(SystemExit) as stopped:
        main([*words, "--effect", "gravity"])
    assert stopped.value.code == 2 and "--set changes it" in capsys.readouterr().err
