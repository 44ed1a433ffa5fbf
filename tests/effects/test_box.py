"""The part of a box under a surface: against sums over small cells, its slopes by differences, and Archimedes' lists."""

import math

import numpy as np
import pytest

from anet_lumped.effects.laws.box import box_immersed


def whole(H):
    """(4, 4) from the upper triangle."""
    full = np.zeros((4, 4))
    full[np.triu_indices(4)] = H
    return full + np.triu(full, 1).T


def drawn(seed):
    """Edges, height and vertical components of a box that the surface cuts, now and then along an axis."""
    rng = np.random.default_rng(seed)
    edges, n = rng.uniform(0.3, 2.0, 3), rng.normal(size=3) * rng.choice([1.0, 1.0, 0.0], 3)
    n = n if n.any() else np.array([0.0, 0.0, 1.0])
    n = n / np.linalg.norm(n)
    return edges, rng.uniform(-0.5, 0.5) * (np.abs(n) @ edges), n


@pytest.mark.parametrize("seed", range(12))
def test_against_small_cells(seed):
    """The midpoint rule of m^3 cells is off by a cell's share of the surface, and by its square where z is linear."""
    edges, c, n = drawn(seed)
    m = 80
    s = (np.arange(m) + 0.5) / m - 0.5
    places = np.stack(np.meshgrid(*(e * s for e in edges), indexing="ij"), -1)
    depth = np.maximum(0.0, -(c + places @ n))
    volume, found = np.prod(edges), box_immersed(c, tuple(n), tuple(edges))
    assert found.I == pytest.approx(depth.mean() * volume, abs=2e-4 * volume)
    assert -found.g[0] == pytest.approx((depth > 0.0).mean() * volume, abs=0.02 * volume)
    moments = ((depth > 0.0)[..., None] * places).mean(axis=(0, 1, 2)) * volume
    assert np.abs(np.array(found.g[1:]) + moments).max() < 0.02 * volume * edges.max()


@pytest.mark.parametrize("seed", range(12))
def test_slopes_by_differences(seed):
    """Central differences of 1e-5: 1e-10 of the third derivative, and rounding."""
    edges, c, n = drawn(seed)
    x, h = np.array([c, *n]), 1e-5

    def at(x):
        return box_immersed(x[0], tuple(x[1:]), tuple(edges))

    ahead, behind = [at(x + h * e) for e in np.eye(4)], [at(x - h * e) for e in np.eye(4)]
    size = np.prod(edges) * max(1.0, *edges)
    g = [(a.I - b.I) / (2.0 * h) for a, b in zip(ahead, behind, strict=True)]
    H = [(np.array(a.g) - b.g) / (2.0 * h) for a, b in zip(ahead, behind, strict=True)]
    assert np.abs(np.array(at(x).g) - g).max() < 1e-8 * size
    assert np.abs(whole(at(x).H) - H).max() < 2e-4 * size  # a corner or an edge in the surface is a kink


def test_level_box():
    """Upright: volume, centroid and waterplane in closed form."""
    a, b, c, draft = 2.0, 1.0, 0.8, 0.3
    found = box_immersed(0.5 * c - draft, (0.0, 0.0, 1.0), (a, b, c))
    assert -found.g[0] == pytest.approx(a * b * draft) and found.I == pytest.approx(0.5 * a * b * draft**2)
    assert -found.g[3] == pytest.approx(a * b * draft * (0.5 * draft - 0.5 * c))
    H = whole(found.H)
    assert (
        H[0, 0] == pytest.approx(a * b) and H[1, 1] == pytest.approx(a**3 * b / 12.0) and H[2, 2] == pytest.approx(a * b**3 / 12.0)
    )
    assert H[1, 2] == pytest.approx(0.0, abs=1e-14) and H[0, 1] == pytest.approx(0.0, abs=1e-14)


def test_dry_and_drowned():
    n = (0.6, 0.0, 0.8)
    assert box_immersed(1.0, n, (1.0, 1.0, 1.0)).I == 0.0
    assert box_immersed(-1.0, n, (1.0, 2.0, 1.0)).I == pytest.approx(2.0) and box_immersed(-1.0, n, (1.0, 2.0, 1.0)).g[0] == -2.0


def test_a_flat_surface_on_a_face_is_no_division_by_zero():
    for height in (-0.5, 0.5, 0.0):
        found = box_immersed(height, (0.0, 0.0, 1.0), (1.0, 1.0, 1.0))
        assert math.isfinite(found.I) and np.isfinite(found.g).all() and np.isfinite(found.H).all()
