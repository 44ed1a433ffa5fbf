"""Waves and currents of MoorDyn files, against what MoorDyn 2.7.2 itself says of the same files (`GetWavesKin`)."""

import math

import numpy as np
import pytest

from anet_lumped import waves, wind
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.waves.kernel import wave_at
from anet_lumped.effects.flow.wind.kernel import pack, wind_at
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError

DECK = """\
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rode 0.1 40 6.0E6 -0.8 0 1.8 1.0 0.3 0.2
--- POINTS ---
ID Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 50 0 -40 0 0 0 0
2 Fixed 0 0 -2 0 0 0 0
--- LINES ---
ID Type NodeA NodeB Length Segs Flags
(-) (-) (-) (-) (m) (-) (-)
1 rode 1 2 66 12 -
--- OPTIONS ---
50 WtrDpth
0 kBot
0 cBot
%s
--- OUTPUTS ---
"""
FREQUENCIES = "0.0 0 0\n0.6 0.8 0.3 0.2\n0.9 0.0 0.5 -0.4\n"
PROFILE = "a\nb\nc\n-40 0.1 0.2 0\n-10 0.5 0.3 0.05\n0 1.0 0.1 0\n"
STARTS = (
    "A run starts from a rest in the water at t = 0, which waves move already; MoorDyn's starts in still water. With a `ramp` the "
    "waves grow from nothing: --set water.waves.ramp=20."
)
TIMES = (
    "Line 18: the current is linear between the times of %s, and stays as it is after the last, %g s; MoorDyn 2.7 takes equal "
    "steps, and begins anew."
)
IN_TIME = "a\nb\n\n\n -40 -10 0\n\n0 0.1 0.2 0.3 0 0.1 0.2\n2 0.3 0.5 0.7 0.1 0.1 0.1\n4 0 0 0 0 0 0.4\n"


def read(folder, options, **files):
    for name, content in files.items():
        (folder / f"{name}.txt").write_text(content)
    return deck_from_text(DECK % options, folder=folder)


def water(deck):
    return deck.scene.effects[1]


def wave(deck, t, place):
    """Elevation, velocity and acceleration."""
    surface, velocity, _, acceleration, _ = wave_at(t, *place, pack_waves(water(deck).all_waves, 9.80665, 0.0))
    return surface[0], velocity, acceleration


def current(deck, t, place):
    return wind_at(t, *place, pack(water(deck).current))[0]


@pytest.mark.parametrize(
    ("t", "place", "elevation", "velocity", "acceleration"),
    [
        (0.0, (3.0, 2.0, -5.0), 0.6887676884597282, (0.3553177487202064, -0.08898778333288741, 0.4438564134921991),
         (0.28827698291586207, 0.03445769904051316, -0.3072784884041763)),
        (1.5, (10.0, -4.0, -20.0), 1.1244052381328344, (0.27146285694822914, 0.012560265591710314, 0.09374585177603986),
         (0.06397578360409924, 0.03191057618702182, -0.16615745983654634)),
        (1.5, (0.0, 0.0, 5.0), 0.9226478617297224, (0.5901311669966555, 0.06281723056681644, -0.2817015699850036),
         (-0.26752598635912783, 0.17355393145911674, -0.38142973481864534)),
        (3.0, (7.0, 1.0, -49.0), 0.5177350519483492, (0.13578305528480009, 0.03243590628300822, -0.0027826459668245504),
         (-0.03802955921894656, -0.0016283548521315071, -0.0027085234607080373)),
    ],
)  # fmt: skip
def test_frequencies_by_node(tmp_path, t, place, elevation, velocity, acceleration):
    """WaveKin 7, where MoorDyn interpolates nothing; its wave numbers have seven digits and more."""
    deck = read(tmp_path, "7 WaveKin", wave_frequencies=FREQUENCIES)
    found = wave(deck, t, place)
    assert found[0] == pytest.approx(elevation, abs=1e-9)
    np.testing.assert_allclose(found[1], velocity, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found[2], acceleration, rtol=0, atol=1e-9)
    assert water(deck).waves.depth == 50.0
    assert deck.remarks == (STARTS,)


def test_frequencies_on_a_grid(tmp_path):
    """WaveKin 2 at a point of MoorDyn's grid and at t = 0, where it interpolates nothing; components of one spacing."""
    given = {6: (0.8, 0.3), 9: (0.0, 0.5), 12: (-0.3, 0.2)}
    rows = "".join("{:.1f} {} {} 0.3\n".format(0.1 * i, *given.get(i, (0, 0))) for i in range(201))
    deck = read(tmp_path, "2 WaveKin", wave_frequencies=rows)
    found = wave(deck, 0.0, (10.0, -4.0, -20.0))
    assert found[0] == pytest.approx(1.260708087150408, abs=1e-9)
    assert wave(deck, 0.0, (0.0, 0.0, 0.0))[0] == pytest.approx(0.5, abs=1e-13)  # frequencies of 0.1 and its rounding
    assert "the waves of WaveKin 2 are evaluated at each node, where MoorDyn interpolates linearly" in deck.remarks[0]


def test_frequencies_are_made_evenly_spaced(tmp_path):
    """WaveKin 2 interpolates amplitudes at the smallest spacing, and the ends count half (an inverse FFT)."""
    deck = read(tmp_path, "2 WaveKin", wave_frequencies="0 0.2 0\n0.5 1 1\n0.75 0 0.8 0.4\n")
    a, omega, phase, heading = np.array(water(deck).waves.components).T
    np.testing.assert_allclose(omega, [0.0, 0.25, 0.5, 0.75], rtol=1e-15)
    np.testing.assert_allclose(a * np.exp(-1j * phase), [0.1, 0.6 + 0.5j, 1 + 1j, 0.4j], rtol=0, atol=1e-15)
    np.testing.assert_allclose(heading, [0.0, 0.0, 0.0, 0.4], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("t", "place", "elevation"),
    [
        (0.0, (10.0, -4.0, -20.0), 0.4377597054699208), (1.5, (0.0, 0.0, 5.0), 0.458206723881124),
        (4.1, (7.0, 1.0, -49.0), -0.7171674030722103),
    ],
)  # fmt: skip
def test_elevation(tmp_path, t, place, elevation):
    """WaveKin 3 at times and places of MoorDyn's grid; its wave numbers have seven digits."""
    rows = [
        (t, 0.7 * math.cos(2 * math.pi * 8 * t / 80.0 + 0.4) + 0.3 * math.sin(2 * math.pi * 13 * t / 80.0))
        for t in (0.1 * i for i in range(801))
    ]
    deck = read(tmp_path, "3 WaveKin\n0.1 dtWave", wave_elevation="\n".join(f"{t:.1f} {eta}" for t, eta in rows))
    assert wave(deck, t, place)[0] == pytest.approx(elevation, abs=1e-6)
    assert water(deck).waves.highest_frequency <= math.pi


def test_profile(tmp_path):
    """Currents 1; beyond its ends it is held. A profile of two components is one of the usual kind."""
    deck = read(tmp_path, "1 Currents", current_profile=PROFILE)
    np.testing.assert_allclose(current(deck, 1.0, (3.0, 2.0, -5.0)), [0.75, 0.2, 0.025], rtol=1e-14)
    np.testing.assert_allclose(current(deck, 1.0, (3.0, 2.0, -45.0)), [0.1, 0.2, 0.0], rtol=1e-14)
    flat = read(tmp_path, "1 Currents", current_profile="a\nb\nc\n-10 1.25\n0 0.5 0.1\n")
    assert water(flat).current == wind.Sampled([(-10.0, 1.25, 0.0), (0.0, 0.5, 0.1)])


def test_profile_in_time(tmp_path):
    """Currents 2, of x and y components, at a time between two."""
    deck = read(tmp_path, "2 Currents", current_profile_dynamic=IN_TIME)
    np.testing.assert_allclose(current(deck, 1.0, (9.0, 2.0, -5.0)), [(0.25 + 0.6) / 2, (0.15 + 0.1) / 2, 0.0], rtol=1e-14)
    assert current(deck, 9.0, (9.0, 2.0, -5.0)) == current(deck, 4.0, (9.0, 2.0, -5.0))
    assert deck.remarks == (TIMES % ("current_profile_dynamic.txt", 4),)


def test_current_on_a_grid(tmp_path):
    """Currents 5, whose rows come in any order, and with -0 for 0."""
    at = [(x, y, z, t) for t in (0, 2) for z in (-30, 0) for y in (-5, 5) for x in (-1, 20)]
    rows = [" ".join(map(str, (*place, place[0] + place[3], place[1] * place[2], place[3]))) for place in at[::-1]]
    rows[0] = rows[0].replace(" 0 2 ", " -0 2 ", 1)
    deck = read(tmp_path, "5 Currents", current_profile_4d="\n".join(["2 2 2 2", "-1 20", "-5 5", "-30 0", "0 2", *rows]))
    np.testing.assert_allclose(current(deck, 0.5, (4.0, 2.0, -9.0)), [4.5, -18.0, 0.5], rtol=1e-14)
    assert deck.remarks == (
        "Line 18: all rows of current_profile_4d.txt are read; MoorDyn 2.7 takes the first for a current of 0.",
        TIMES % ("current_profile_4d.txt", 2),
    )


def test_waves_and_current_together(tmp_path):
    deck = read(tmp_path, "7 WaveKin\n1 Currents", wave_frequencies=FREQUENCIES, current_profile=PROFILE)
    assert isinstance(water(deck).waves, waves.Components) and isinstance(water(deck).current, wind.Gridded)


def test_no_waves_of_no_height_and_none_without_water(tmp_path):
    assert water(read(tmp_path, "7 WaveKin", wave_frequencies="0 0 0\n1 0 0\n")).waves is None
    deck = read(tmp_path, "7 WaveKin\n0 rho", wave_frequencies=FREQUENCIES)
    assert deck.remarks == (STARTS, "No use is made of waves and currents: rho is 0.")


@pytest.mark.parametrize(
    ("option", "name", "content", "message"),
    [
        ("7 WaveKin", "wave_frequencies", "0 0 0\n1 0.5\n", 
         r'line 18, "7 WaveKin": wave_frequencies.txt, line 2: must begin with 3 finite'),
        ("7 WaveKin", "wave_frequencies", "0 0 0\n-1 0.5 0\n", "wave_frequencies.txt, line 2: a frequency must not be negative"),
        ("7 WaveKin", "wave_frequencies", "\0", "wave_frequencies.txt must be a table. It must be UTF-8 text"),
        ("2 WaveKin", "wave_frequencies", "0.1 0 0\n1 0.5 0\n", "line 1: for WaveKin 2 frequencies must begin with 0 and increase"),
        ("3 WaveKin", "wave_elevation", "0 0\n0 1\n", "wave_elevation.txt, line 1: the times of an elevation must be at least two"),
        ("3 WaveKin\n0 dtWave", "wave_elevation", "0 0\n1 1\n", 'line 19, "0 dtWave": dtWave must be a positive number'),
        ("3 WaveKin\n9 dtWave", "wave_elevation", "0 0\n1 1\n",
         "line 2: an elevation must last longer than one step of dtWave, 9 s"),
        ("1 Currents", "current_profile", "a\nb\nc\n", "current_profile.txt must hold numbers from line 4 on, but it ends before"),
        ("1 Currents", "current_profile", "a\nb\nc\n0 1\n-1 1\n", "Heights z of `samples` must increase"),
        ("2 Currents", "current_profile_dynamic", "a\nb\nc\nd\n\n0\n", "line 6: the heights must stand on line 5"),
        ("2 Currents", "current_profile_dynamic", "a\nb\nc\nd\n0\n\n", "must have rows of a time and velocities from line 7 on"),
        ("2 Currents", "current_profile_dynamic", "a\nb\nc\nd\n0 1\n\n0 1\n",
         "line 7: must begin with 3 finite numbers, but it is 0 1"),
        ("5 Currents", "current_profile_4d", "1 1 2 1\n0\n0\n0 1\n0\n" + "0 0 0 0 1 1 1\n" * 2,
         r"must have a row for each place and time, but none at \(0.0, 0.0, 1.0"),
        ("5 Currents", "current_profile_4d", "1 1 1 1\n0\n0\n0\n0\n",
         "a row for each of 1 x 1 x 1 x 1 places and times, but has 0"),
        ("5 Currents", "current_profile_4d", "1 1 1 1\n0\n0\n0\n0\n1 0 0 0 1 1 1\n",
         "line 6: a row must be at a place and a time of the"),
        ("2 Currents", "current_profile_dynamic", "a\nb\nc\nd\nz\n",
         "current_profile_dynamic.txt, line 5: must begin with 1 finite"),
        ("5 Currents", "current_profile_4d", "1 1 1 1\n0\n", "a row for each of 1 x 1 x 1 x 1 places and times, but has -3"),
    ],
)  # fmt: skip
def test_messages(tmp_path, option, name, content, message):
    with pytest.raises(DeckError, match=message):
        read(tmp_path, option, **{name: content})


def test_waves_need_a_depth(tmp_path):
    (tmp_path / "wave_frequencies.txt").write_text(FREQUENCIES)
    flat = (DECK % "7 WaveKin").replace("50 0 -40", "50 0 0").replace("0 0 -2", "0 0 0").replace("50 WtrDpth\n", "")
    with pytest.raises(DeckError, match="waves need the depth of the water; WtrDpth must be positive"):
        deck_from_text(flat, folder=tmp_path)


WATER_FILE = """\
Waves and currents
notes
--- WAVES ---
%s WaveKinMod - type of wave input
"waves.txt" WaveKinFile - elevation at the origin
0.5 dtWave - step
90 WaveDir - heading (deg)
2 - X wave input type
-800, 10, 101 - X wave grid point data
--- CURRENT ---
%s CurrentMod - type of current input
2 - Z wave input type
-600, 0, 50 - Z wave grid point data
z-depth x-current y-current
(m) (m/s) (m/s)
%s
--- need this line ---
"""


@pytest.mark.parametrize("table", ["-40 0.1 0.2\n-10 0.5 0.3\n0 1.0 0.1", "0.0 1.0 0.1\n10 0.5 0.3\n40 0.1 0.2"])
def test_a_current_of_the_fortran_version(tmp_path, table):
    """By heights or, as in MoorDyn's documentation, by depths."""
    deck = read(tmp_path, '"flow.txt" WaterKin', flow=WATER_FILE % (0, 1, table))
    assert water(deck).current == wind.Sampled(((-40.0, 0.1, 0.2), (-10.0, 0.5, 0.3), (0.0, 1.0, 0.1)))
    assert any("are read as depths" in said for said in deck.remarks) == table.startswith("0.0")
    assert not water(deck).all_waves


@pytest.mark.parametrize("kind", [1, 3])
def test_waves_of_the_fortran_version(tmp_path, kind):
    """The elevation at the origin is that of the file at its times, and a quarter of a wave on the waves have come from -y."""
    t = np.arange(0.0, 60.0, 0.5)
    elevation = 0.8 * np.cos(2.0 * np.pi * t / 10.0) + 0.2 * np.sin(2.0 * np.pi * t / 4.0)
    waves_file = "time elevation\n" + "\n".join(f"{a} {b}" for a, b in zip(t, elevation, strict=True))
    deck = read(tmp_path, "flow.txt WaterKin", flow=WATER_FILE % (kind, 2, ""), waves=waves_file)
    assert [wave(deck, at, (0.0, 0.0, 0.0))[0] for at in t[:9]] == pytest.approx(elevation[:9].tolist(), abs=1e-9)
    assert abs(wave(deck, 1.0, (0.0, 0.0, 0.0))[1][0]) < 1e-12 < abs(wave(deck, 1.0, (0.0, 0.0, 0.0))[1][1])
    assert "Line 18: CurrentMod 2 of flow.txt is given by the program that calls MoorDyn. Nothing flows by it here." in deck.remarks


@pytest.mark.parametrize(
    ("flow", "message"),
    [
        (WATER_FILE % (0, 1, ""), r"line 18, .*flow\.txt must have a table of heights and velocities behind CurrentMod"),
        (WATER_FILE % (0, 7, ""), r"line 18, .*CurrentMod of flow\.txt must be one of 0, 2, 1, but is 7"),
        (WATER_FILE.replace("0.5 dtWave", "0 dtWave") % (1, 0, ""), r"line 18, .*dtWave of flow\.txt must be a positive number"),
    ],
)
def test_refused_flow_of_the_fortran_version(tmp_path, flow, message):
    with pytest.raises(DeckError, match=message):
        read(tmp_path, "flow.txt WaterKin", flow=flow, waves="0 0\n1 0\n2 0\n")


def test_waves_that_grow(tmp_path):
    deck = read(tmp_path, "7 WaveKin\n20 waveKin_rampT", wave_frequencies=FREQUENCIES)
    assert [wave.ramp for wave in water(deck).all_waves] == [20.0]
    assert "Line 19: waves grow over 20 s by a smoothstep, where MoorDyn's grow linearly." in deck.remarks
    with pytest.raises(DeckError, match=r"line 19, .*waveKin_rampT must be a number of at least 0"):
        read(tmp_path, "7 WaveKin\n-1 waveKin_rampT")
    assert "No use is made of options of MoorDyn's own run: waveKin_rampT (line 18)." in read(tmp_path, "9 waveKin_rampT").remarks
