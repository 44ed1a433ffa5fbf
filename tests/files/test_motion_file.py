"""Motions of a platform from files of others and in words."""

import math

import numpy as np
import pytest

from anet_lumped import SceneError, SixMotions, read_motions, signals
from anet_lumped.files.motion_file import motions_of

CSV = "time,surge,heave,pitch (deg)\n0,0,0,0\n1,0.5,-0.1,2\n2,1.0,-0.3,4\n"
MOORDYN = (
    "# Time(s) PtfmSurge(m) PtfmSway(m) PtfmHeave(m) PtfmRoll(rad) PtfmPitch(rad) PtfmYaw(rad)\n0 0 0 0 0 0 0\n1 .5 0 -.1 0 .02 0\n"
)
OPENFAST = """\

Predictions were generated on 01-Jan-2020 at 00:00:00
linked with NWTC Subroutine Library; heave decay

Time     \tWind1VelX\tPtfmSurge \tPtfmHeave \tPtfmPitch \tPtfmTVxi
(s)      \t(m/s)    \t(m)       \t(m)       \t(deg)     \t(m/s)
   0.0000\t8.00E+00 \t0.000E+00 \t0.0        \t0.0       \t0.1
   1.0000\t8.00E+00 \t5.000E-01 \t-1.0E-01   \t2.0       \t0.1
   2.0000\t8.00E+00 \t1.000E+00 \t-3.0E-01   \t4.0       \t0.1
"""


@pytest.mark.parametrize(
    "text", [CSV, CSV.replace(",", ";"), CSV.replace(",", "  "), OPENFAST], ids=["csv", ";", "blank", "openfast"]
)
def test_columns_with_names(tmp_path, text):
    (tmp_path / "six.out").write_text(text)
    motions = read_motions(tmp_path / "six.out")
    for name, unit, values in (("surge", 1.0, (0, 0.5, 1)), ("heave", 1.0, (0, -0.1, -0.3)), ("pitch", math.pi / 180, (0, 2, 4))):
        (signal,) = getattr(motions, name)
        assert [signal.at(t)[0] for t in (0.0, 1.0, 2.0)] == pytest.approx([unit * value for value in values], rel=1e-12)
    assert motions.sway == motions.roll == motions.yaw == ()


@pytest.mark.parametrize(
    "names",
    ["Time (ms), Surge (mm), heave [cm], pitch (mrad)", "time_ms,PtfmSurge_[mm],platform_heave_cm,pitch_mrad",
     "time,surge,heave,pitch\n(ms),(mm),(cm),(mrad)"],
)  # fmt: skip
def test_units_of_columns(tmp_path, names):
    (tmp_path / "six.csv").write_text(f"{names}\n0,0,0,0\n1000,500,-10,35\n")
    at = read_motions(tmp_path / "six.csv").at(1.0)[0]
    assert np.allclose(at, (0.5, 0.0, -0.1, 0.0, 0.035, 0.0), rtol=1e-12)


@pytest.mark.parametrize("text", [MOORDYN, MOORDYN.partition("\n")[2]], ids=["names", "no names"])
def test_columns_of_moordyns_driver(tmp_path, text):
    (tmp_path / "PtfmMotions.dat").write_text(text)
    at = read_motions(tmp_path / "PtfmMotions.dat").at(1.0)[0]
    assert np.allclose(at, (0.5, 0.0, -0.1, 0.0, 0.02, 0.0), rtol=1e-12)


def test_words_and_files_add_up(tmp_path):
    (tmp_path / "six.csv").write_text(CSV)
    motions = motions_of(
        ["surge=1sin0.1", " Surge = 0.5 m cos 0.2 Hz", "pitch=-3degsin0.1", "yaw=1e-2radsin5e-2", str(tmp_path / "six.csv")]
    )
    swings = (signals.harmonic(0.0, 1.0, 0.1), signals.harmonic(0.0, 0.5, 0.2, 0.5 * math.pi))
    assert motions.surge[:2] == swings and motions.surge[2].kind == "samples"
    assert motions.pitch[0] == signals.harmonic(0.0, math.radians(-3.0), 0.1)
    assert motions.yaw == (signals.harmonic(0.0, 0.01, 0.05),)
    assert motions_of(["heave=-.5sin0.1ramp20", "sway = 1 m sin 0.1 Hz ramp 20 s"]) == SixMotions(
        heave=signals.harmonic(0.0, -0.5, 0.1, ramp=20.0), sway=signals.harmonic(0.0, 1.0, 0.1, ramp=20.0)
    )
    assert motions_of([]) == SixMotions()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("surge=1", 'A motion must be a file, or like "surge=1sin0.1" .* but it is "surge=1"'),
        ("surge=1degsin0.1", "The motion surge must have an amplitude in m"),
        ("pitch=1sin0.1", "The motion pitch must have deg or rad behind its amplitude, as in pitch=3degsin0.1"),
        ("pitch=1msin0.1", "The motion pitch must have deg or rad"),
        ("drift=1sin0.1", 'A motion must be one of surge, .*, yaw, but "drift=1sin0.1" is of "drift"'),
        ("surge=1.2.3sin0.1", "A motion must be a file, or like"),
        ("none.csv", "A file of motions must be readable, but none.csv: No such file"),
    ],
)
def test_words_that_are_refused(words, message):
    with pytest.raises(SceneError, match=message):
        motions_of([words])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hello\n", "must have rows of numbers, a time and motions, but six.csv has none"),
        ("0 1 2\n1 2 3\n", r"must have names above its columns, or 7 columns, .* but six.csv has 3 without names"),
        (CSV + "3,1\n", 'Rows of a file of motions must be 4 numbers each, as the first is, but row 4 of six.csv is "3 1"'),
        (
            CSV.replace("surge", "surge (ft)"),
            r'The unit of surge in a file of motions must be one of m, mm, cm, km, but .* has "ft"',
        ),
        (
            CSV.replace("time", "Time [h]"),
            r'The unit of time in a file of motions must be one of s, sec, ms, us, min, but .* has "h"',
        ),
        (CSV + "3,1,nan,2\n", "Rows of a file of motions must be 4 numbers each"),
        (CSV.replace(" (deg)", ""), r'Angles of a file of motions must have a unit, \(deg\) or \(rad\), but six.csv has "pitch"'),
        (CSV.replace("time", "x"), "must have a column of times"),
        (CSV.replace("time,surge", "surge"), "must have a name above each of 4 columns, but six.csv has 3 names"),
        ("time,surge\n0,1\n0,2\n", r"`t` \[s\] of samples must increase"),
    ],
)
def test_files_that_are_refused(tmp_path, text, message):
    (tmp_path / "six.csv").write_text(text)
    with pytest.raises(SceneError, match=message):
        read_motions(tmp_path / "six.csv")
