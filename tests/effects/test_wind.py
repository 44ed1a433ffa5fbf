"""Winds: their closed forms, their gradients, the statistics of turbulence, files, and what they refuse."""

import math

import numpy as np
import pytest
from scipy.signal import welch

from anet_lumped import SceneError
from anet_lumped.effects import Air
from anet_lumped.effects.flow.wind import Dryden, Gridded, Gust, Logarithmic, PowerLaw, Recorded, Sampled, Uniform
from anet_lumped.effects.flow.wind.dryden import _sine_and_cosine, energy_below, wave_number
from anet_lumped.effects.flow.wind.kernel import pack, wind_at

EPS = np.finfo(float).eps
EAST = (1.0, 0.0, 0.0)


def at(wind, t=0.0, place=(0.0, 0.0, 0.0)):
    """Velocity (3,) of a wind, or of several."""
    return np.array(wind_at(t, *map(float, place), pack(wind if isinstance(wind, tuple) else (wind,)))[0])


def recording(tmp_path, function, t, name="wind.csv"):
    file = tmp_path / name
    rows = [",".join(map(repr, (float(x), *map(float, function(x))))) for x in t]
    file.write_text("\n".join(["t,u,v,w", *rows, ""]))
    return str(file)


def test_uniform_and_none():
    np.testing.assert_array_equal(at(Uniform((1, 2, -3)), 7.0, (3, 4, 5)), [1, 2, -3])
    np.testing.assert_array_equal(at(()), 0.0)


@pytest.mark.parametrize(
    ("z", "velocity", "slope"),
    [
        (-9.0, (0.1, 0.0), (0.0, 0.0)), (-5.0, (0.1, 0.0), (0.0, 0.0)), (-4.0, (0.2, -0.1), (0.1, -0.1)),
        (-1.5, (0.5, -0.35), (0.2, -0.1)), (-1.0, (0.6, -0.4), (0.4, 0.8)),
        (0.0, (1.0, 0.4), (0.0, 0.0)), (3.0, (1.0, 0.4), (0.0, 0.0)),
    ],
)  # fmt: skip
def test_sampled(z, velocity, slope):
    """Linear between its samples, held beyond them; one sample is uniform."""
    current = Sampled(((-5, 0.1, 0.0), (-2, 0.4, -0.3), (-1, 0.6, -0.4), (0, 1.0, 0.4)))
    found, gradient = wind_at(7.0, 1.0, 2.0, z, pack(current))
    np.testing.assert_allclose(found, [*velocity, 0.0], rtol=16 * EPS, atol=EPS)
    np.testing.assert_allclose(gradient, [0, 0, slope[0], 0, 0, slope[1], 0, 0, 0], rtol=16 * EPS, atol=EPS)
    np.testing.assert_array_equal(at(Sampled([(3, 1, 2)]), 0.0, (0, 0, z)), [1, 2, 0])


GRID = {"x": (-1.0, 2.0, 3.0), "y": (0.0, 4.0), "z": (-9.0, -2.0, 0.0), "t": (0.0, 1.0, 5.0)}


def many_linear(t, x, y, z):
    """A velocity that is linear in each of its arguments."""
    return 1.0 + x * y - 0.2 * z * t, x + y * z * t, t - 0.5 * z * x * y


def of_grid(axes, function):
    rows = [function(t, x, y, z) for t in axes["t"] for z in axes["z"] for y in axes["y"] for x in axes["x"]]
    return Gridded(rows, **axes)


@pytest.mark.parametrize("place", [(0.3, 0.5, 1.0, -4.0), (4.9, 2.5, 3.9, -0.1), (1.0, 2.0, 2.0, -2.0), (0.0, -1.0, 0.0, -9.0)])
def test_a_grid_is_linear_in_each_direction(place):
    t, x, y, z = place
    found, gradient = wind_at(t, x, y, z, pack(of_grid(GRID, many_linear)))
    np.testing.assert_allclose(found, many_linear(t, x, y, z), rtol=64 * EPS, atol=64 * EPS)
    if not (x in GRID["x"] or y in GRID["y"] or z in GRID["z"]):
        slopes = [y, x, -0.2 * t, 1.0, z * t, y * t, -0.5 * z * y, -0.5 * z * x, -0.5 * x * y]
        np.testing.assert_allclose(gradient, slopes, rtol=0, atol=256 * EPS)  # entries up to 30


def test_a_grid_is_held_beyond_its_ends():
    wind = of_grid(GRID, many_linear)
    for beyond, nearest in (
        ((9.0, 1.0, 1.0, -1.0), (5.0, 1.0, 1.0, -1.0)), ((2.0, -7.0, 9.0, 3.0), (2.0, -1.0, 4.0, 0.0)),
        ((-1.0, 9.0, -1.0, -99.0), (0.0, 3.0, 0.0, -9.0)),
    ):  # fmt: skip
        found, gradient = wind_at(*beyond, pack(wind))
        np.testing.assert_allclose(found, many_linear(*nearest), rtol=64 * EPS)
        assert gradient[2::3] == (0.0, 0.0, 0.0) or beyond[3] == -1.0  # of those that leave z


def test_a_profile_that_changes_in_time():
    """An axis of one number is one along which nothing changes; of one place and time it is uniform."""
    profile = of_grid({"x": (3.0,), "y": (1.0,), "z": (-4.0, 0.0), "t": (0.0, 2.0)}, lambda t, x, y, z: (z * t, 1.0, 0.5 * t))
    assert profile.same_at_each_height and not of_grid(GRID, many_linear).same_at_each_height
    found, gradient = wind_at(1.5, -70.0, 80.0, -1.0, pack(profile))
    np.testing.assert_allclose(found, [-1.5, 1.0, 0.75], rtol=8 * EPS)
    np.testing.assert_allclose(gradient, [0, 0, 1.5, 0, 0, 0, 0, 0, 0], rtol=8 * EPS, atol=EPS)
    np.testing.assert_array_equal(at(Gridded([(1, 2, 3)]), 4.0, (5, 6, 7)), [1, 2, 3])


@pytest.mark.parametrize("height", [0.5, 10.0, 40.0])
def test_power_law(height):
    wind = PowerLaw(speed=8.0, height=10.0, exponent=0.2, direction=(0, 3, 4), ground=-2.0)
    expected = 8.0 * (height / 10.0) ** 0.2
    np.testing.assert_allclose(at(wind, 0.0, (5, 6, height - 2.0)), [0, 0.6 * expected, 0.8 * expected], rtol=8 * EPS)
    for below in (-2.0, -2.1, -50.0):
        np.testing.assert_array_equal(at(wind, 0.0, (5, 6, below)), 0.0)


def test_logarithmic():
    """Two friction heights: the speed at the reference, and equal steps for equal ratios of height; nothing below z0."""
    wind = Logarithmic(speed=8.0, height=10.0, roughness=0.03, ground=1.0)
    assert at(wind, 0.0, (0, 0, 11.0))[0] == pytest.approx(8.0, rel=8 * EPS)
    per_e = 8.0 / math.log(10 / 0.03)
    assert at(wind, 0.0, (0, 0, 41.0))[0] == pytest.approx(8.0 + per_e * math.log(4.0), rel=8 * EPS)
    assert at(wind, 0.0, (0, 0, 1.03))[0] == pytest.approx(0.0, abs=64 * EPS * 8.0)
    np.testing.assert_array_equal(at(wind, 0.0, (0, 0, 1.02)), 0.0)
    np.testing.assert_array_equal(at(wind, 0.0, (0, 0, -5.0)), 0.0)


@pytest.mark.parametrize(
    ("t", "share", "stays"), [(0.9, 0, 0), (1, 0, 0), (1.5, 0.5, 0.5), (2, 1, 1), (2.5, 0.5, 1), (3, 0, 1), (9, 0, 1)]
)
def test_gust(t, share, stays):
    """CS-25.341 falls as it rose, MIL-F-8785C stays: half the top in the middle of the rise."""
    for wind, expected in ((Gust((4, 0, -2), 1.0, 1.0), share), (Gust((4, 0, -2), 1.0, 1.0, stays=True), stays)):
        np.testing.assert_allclose(at(wind, t), np.array([4, 0, -2]) * expected, rtol=0, atol=4 * EPS)


def test_winds_add_up(tmp_path):
    file = recording(tmp_path, lambda t: (t, 2 * t, 3.0), [0.0, 1.0])
    winds = (
        Uniform((1, 0, 0)), PowerLaw(3.0, 10.0, 0.14), Logarithmic(2.0, 10.0, 0.03, (0, 1, 0)), Gust((1, 1, 1), 0.0, 1.0),
        Dryden(1.0, 5.0, (3, 0, 0), seed=1, modes=20), Recorded(file),
    )  # fmt: skip
    place, t = (1.0, 2.0, 3.0), 0.4
    np.testing.assert_allclose(at(winds, t, place), sum(at(wind, t, place) for wind in winds), rtol=16 * EPS)


def test_gradient():
    """Slopes in place against central differences, of every wind that has any."""
    rng = np.random.default_rng(2)
    turbulence = Dryden(2.0, 5.0, (3, 1, 0), seed=1, modes=40)
    winds = pack((PowerLaw(3.0, 10.0, 0.14), Logarithmic(2.0, 10.0, 0.03, (0, 1, 1)), turbulence))
    modes = turbulence.numbers()[3:].reshape(9, -1).T
    k, amplitude = np.linalg.norm(modes[:, :3], axis=1), np.linalg.norm(modes[:, 3:], axis=1)
    h = 1e-5  # [m]; differences leave h^2/6 of the third derivative, and rounding of places of 10 m, (10 eps/h) of the first
    error = h**2 / 6 * (k**3 @ amplitude) + 10 * EPS / h * (k @ amplitude) + 1e-9
    assert error < 1e-3 * (k @ amplitude)
    for _ in range(5):
        place, t = rng.uniform(1.0, 9.0, 3), 0.3
        gradient = np.reshape(wind_at(t, *place, winds)[1], (3, 3))
        for axis in range(3):
            low, high = (np.array(wind_at(t, *(place + s * np.eye(3)[axis]), winds)[0]) for s in (-h, h))
            np.testing.assert_allclose(gradient[:, axis], (high - low) / (2 * h), rtol=0, atol=error)


def test_energy_of_wave_numbers():
    """`energy_below` is the integral of E(k)/(3 sigma^2/2), and `wave_number` its inverse."""
    from scipy.integrate import quad

    for x in (0.01, 0.3, 1.0, 3.0, 40.0):
        integral = quad(lambda y: 16 / (3 * math.pi) * y**4 / (1 + y * y) ** 3, 0.0, x, epsabs=1e-14)[0]
        assert energy_below(x) == pytest.approx(integral, abs=1e-13)
    for share in (1e-6, 0.1, 0.5, 0.999, 1 - 1e-6):
        assert energy_below(wave_number(share)) == pytest.approx(share, abs=1e-11)


def test_turbulence_has_no_divergence_and_is_carried():
    wind, rng = pack((Dryden(2.0, 5.0, (3, 1, -0.5), seed=4),)), np.random.default_rng(0)
    for _ in range(5):
        place, t = rng.uniform(-9.0, 9.0, 3), rng.uniform(0.0, 5.0)
        here, gradient = wind_at(t, *place, wind)
        # 200 modes of up to 1e3 rad/m and 0.3 m/s, each at right angles to its wave vector but for rounding
        assert abs(gradient[0] + gradient[4] + gradient[8]) < 1e-11
        there, _ = wind_at(0.0, *(place - t * np.array([3, 1, -0.5])), wind)
        np.testing.assert_allclose(there, here, rtol=0, atol=1e-10)  # phases of up to 1e4 rad are rounded at 1e-12


def test_sine_and_cosine_of_a_phase():
    """Against those of the C library; a phase that has no digits left must give no velocity beyond all bounds."""
    x = np.concatenate([np.linspace(-20.0, 20.0, 4001), np.random.default_rng(0).uniform(-1e5, 1e5, 2000)])
    found = np.array([_sine_and_cosine.py_func(one) for one in x])
    # 2 units in the last place, and what is left of the multiple of pi/2: three parts have 33 + 33 + 53 digits
    np.testing.assert_allclose(found, np.column_stack([np.sin(x), np.cos(x)]), rtol=0, atol=4e-16)
    assert np.abs([_sine_and_cosine.py_func(one) for one in (1e17, -3e25, 1e90)]).max() <= 1.0 + 1e-9
    assert np.isnan(at(Dryden(1.0, 5.0, (3, 0, 0), seed=7, modes=3), place=(math.nan, 0.0, 0.0))).all()


def test_the_steady_part_of_winds():
    turbulence, shear = Dryden(1.0, 5.0, (3, 0, 0), seed=7), PowerLaw(3.0, 10.0, 0.14)
    assert Air(wind=[shear, turbulence]).steady() == Air(wind=shear) and Air(wind=turbulence).steady() == Air()
    assert (calm := Air(wind=shear)).steady() is calm


def moments(seed, offsets, sigma=2.0, length=5.0):
    """Mean over all space of u_i(x) u_i(x + r e_1), (len(offsets), 3), of the modes that a seed gives."""
    modes = Dryden(sigma, length, (0, 0, 0), seed=seed).numbers()[3:].reshape(9, -1).T
    k, a, b = modes[:, :3], modes[:, 3:6], modes[:, 6:]
    return np.array([0.5 * np.cos(r * k[:, :1]).T @ (a * a + b * b) for r in offsets])[:, 0]


def test_correlation_and_variance_of_turbulence():
    """f(r) along the line of separation and g(r) = f + r f'/2 across it; the variance of each component is sigma^2."""
    r = np.array([0.0, 0.5, 2.0, 5.0, 12.0])
    seeds = np.array([moments(seed, r) for seed in range(120)]) / 4.0
    f = np.exp(-r / 5.0)
    for component, expected in enumerate((f, (1 - r / 10.0) * f, (1 - r / 10.0) * f)):
        of = seeds[:, :, component]
        error = of.std(axis=0, ddof=1) / math.sqrt(len(of))
        # four standard errors of the mean of 120 independent fields, one in 16,000 beyond them
        assert (np.abs(of.mean(axis=0) - expected) < 4 * error + 1e-12).all(), component
        # the directions spread evenly, so that a single field has nearly the variance: two phases at random leave some
        assert of[:, 0].std() < 0.06


@pytest.fixture(scope="module")
def felt():
    """(40, 4096, 3) velocities of 40 fields at a point, every 0.01 s."""
    winds = [pack((Dryden(2.0, 5.0, (10.0, 0, 0), seed=seed),)) for seed in range(40)]
    return np.array([[wind_at(i / 100.0, 0.0, 0.0, 0.0, wind)[0] for i in range(4096)] for wind in winds])


@pytest.mark.parametrize("component", [0, 1, 2])
def test_power_spectrum_of_turbulence(felt, component):
    """What a point feels in the mean wind: the power in bands of frequency against the integral of the one-sided spectrum."""
    sigma, length, V, rate, count = 2.0, 5.0, 10.0, 100.0, 4096
    bands = [(0.1, 0.3), (0.3, 1.0), (1.0, 3.0), (3.0, 10.0)]  # [Hz]; the corner V/(2 pi L) is at 0.32
    ratios = []
    for series in felt[:, :, component]:
        frequency, power = welch(series, rate, nperseg=count)
        W = 2 * math.pi * frequency / V
        square = (length * W) ** 2
        shape = 2 / (1 + square) if component == 0 else (1 + 3 * square) / (1 + square) ** 2
        exact = sigma**2 * length / math.pi * shape * 2 * math.pi / V
        inside = [(frequency >= low) & (frequency < high) for low, high in bands]
        ratios.append([power[band].sum() / exact[band].sum() for band in inside])
    mean, error = np.mean(ratios, axis=0), np.std(ratios, axis=0, ddof=1) / math.sqrt(len(ratios))
    # four standard errors of the mean of 40 fields, and 2 % that the window moves between bands
    assert (np.abs(mean - 1.0) < 4 * error + 0.02).all(), (mean, error)
    assert (error < 0.12).all()  # so that the statement says something


def test_same_seed_same_field():
    wind = Dryden(1.0, 5.0, (3, 0, 0), seed=7)
    np.testing.assert_array_equal(wind.numbers(), Dryden(1.0, 5.0, (3, 0, 0), seed=7).numbers())
    assert np.abs(at(wind) - at(Dryden(1.0, 5.0, (3, 0, 0), seed=8))).max() > 1e-3


@pytest.mark.parametrize(("interpolation", "degree"), [("linear", 1), ("cubic", 3)])
def test_recorded(tmp_path, interpolation, degree):
    """Polynomials up to the degree come back exactly; the ends are held."""

    def function(t):
        return 1 + t - 0.2 * t**degree, 2 - t, t**degree

    times = [0.5, 1.0, 2.0, 2.5, 4.0]
    wind = Recorded(recording(tmp_path, function, times), interpolation)
    for t in (0.5, 0.6, 1.0, 1.7, 2.2, 3.9, 4.0):
        np.testing.assert_allclose(at(wind, t), function(t), rtol=0, atol=1e-13)  # splines of values up to 64
    np.testing.assert_allclose(at(wind, -3.0), function(0.5), rtol=0, atol=1e-15)
    np.testing.assert_allclose(at(wind, 9.0), function(4.0), rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Uniform((1, 2)), r"`velocity` must be three finite numbers \(x, y, z\) \[m/s\], but wind Uniform"),
        (lambda: PowerLaw(-1.0, 10.0, 0.2), r"`speed` must be non-negative and finite \[m/s\], but wind PowerLaw has speed=-1.0"),
        (lambda: PowerLaw(1.0, 0.0, 0.2), r"`height` must be positive and finite \[m\]"),
        (lambda: PowerLaw(1.0, 10.0, -0.2), "`exponent` must be non-negative"),
        (lambda: PowerLaw(1.0, 10.0, 0.2, (0, 0, 0)), "`direction` must not be zero, but wind PowerLaw"),
        (lambda: Logarithmic(1.0, 10.0, 0.0), "`roughness` must be positive"),
        (lambda: Logarithmic(1.0, 10.0, 10.0), r"`roughness` must be smaller than `height` \[m\], but wind Logarithmic"),
        (lambda: Gust(EAST, math.nan, 1.0), "`start` must be a finite number"),
        (lambda: Gust(EAST, 0.0, 0.0), "`rise` must be positive"),
        (lambda: Sampled(()), r"`samples` must be at least one row \(z, u, v\), but wind Sampled has \(\)"),
        (lambda: Sampled("deep"), "but wind Sampled has 'deep'"),
        (lambda: Sampled(((0, 1, 2), (0, 1))), r"`samples\[1\]` must be three finite numbers .*, but wind Sampled has"),
        (lambda: Sampled(((0, 1, 2), (0, 2, 3))), r"must increase \[m\], but wind Sampled has z=0.0 in row 0 and then 0.0"),
        (lambda: Gust(EAST, 0.0, 1.0, stays=1), "`stays` must be True or False, but wind Gust has stays=1"),
        (lambda: Dryden(-1.0, 5.0, EAST, seed=1), "`sigma` must be non-negative"),
        (lambda: Dryden(1.0, 0.0, EAST, seed=1), "`length` must be positive"),
        (lambda: Dryden(1.0, 5.0, EAST, seed=-1), "`seed` must be an integer of at least 0, but wind Dryden has seed=-1"),
        (lambda: Dryden(1.0, 5.0, EAST, seed=1, modes=0), "`modes` must be an integer of at least 1"),
        (
            lambda: Gridded([]),
            r"`velocity` must be 1 rows \(u, v, w\), one for each t, z, y and x, of which there are 1, 1, 1, 1, but wind",
        ),
        (lambda: Gridded([(0, 0, 0)] * 3, (0, 1)), "`velocity` must be 2 rows .* are 1, 2, 1, 1, but wind Gridded has 3 rows"),
        (lambda: Gridded(3.0), "`velocity` must be 1 rows .* but wind Gridded has 3.0"),
        (lambda: Gridded([(0, 0, 0)], z=()), r"`z` must be at least one number \[m\], but wind Gridded has \(\)"),
        (lambda: Gridded([(0, 0, 0)], t=(1, 1)), r"Numbers of `t` must increase \[s\], but wind Gridded has 1.0 and then 1.0"),
        (lambda: Gridded([(0, 0, math.nan)]), r"`velocity\[0\]` must be three finite numbers"),
        (lambda: Recorded(3), "`file` must be the path of a file, a string, but wind Recorded has file=3"),
        (lambda: Recorded("nowhere.csv"), "A recorded wind must be readable, but nowhere.csv: No such file"),
        (lambda: Recorded("nowhere.csv", "quintic"), '`interpolation` must be "linear" or "cubic", but wind Recorded has'),
    ],
)
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,x\n0,1\n", 'must begin with the line "t,u,v,w"'),
        ("t,u,v,w\n0,1,2,x\n", "must hold four numbers"),
        ("t,u,v,w\n0,1,2,3\n", "at least two lines of four finite numbers"),
        ("t,u,v,w\n0,1,2\n1,2,3\n", "has shape"),
        ("t,u,v,w\n0,1,2,3\n1,2,3,nan\n", "with entries that are not finite"),
        ("t,u,v,w\n0,1,2,3\n0,1,2,3\n", r"times of a recorded wind must increase, but in .* t=0.0 is followed by t=0.0"),
    ],
)
def test_messages_of_files(tmp_path, text, message):
    file = tmp_path / "wind.csv"
    file.write_text(text)
    with pytest.raises(SceneError, match=message):
        Recorded(str(file))
