"""Outlines of obstacles: circles and edges that show a solid, as far as it lies in a box."""

import itertools

import numpy as np

from .surroundings import Solid

AROUND = 73  # places on a circle
RINGS = 7  # circles along a cylinder


def outline(solid: Solid, box: np.ndarray) -> list[np.ndarray]:
    """Lines (k, 3) [m] that show a solid within a box (2, 3); NaN where they leave it."""
    half, middle = 0.5 * solid.widths, box.mean(axis=0)
    centre = 0.0
    if not np.isfinite(half[2]):  # a cylinder without ends: the part that is near
        half, centre = np.array([*half[:2], np.linalg.norm(np.ptp(box, axis=0))]), float(solid.axes[2] @ (middle - solid.at))
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND)
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    if solid.kind == "sphere":
        lines = [half * np.roll(ring, k, axis=1) for k in range(3)]
    elif solid.kind == "cylinder":
        lines = [half * (ring + np.array([0.0, 0.0, z])) for z in np.linspace(-1.0, 1.0, RINGS)]
        along = np.linspace(-1.0, 1.0, AROUND)[:, None] * (0.0, 0.0, 1.0)
        lines += [half * (along + ring[k]) for k in range(0, AROUND - 1, 9)]
    else:
        corners = [np.array(signs, float) for signs in itertools.product((-1.0, 1.0), repeat=3)]
        pairs = [(a, b) for a, b in itertools.combinations(corners, 2) if np.sum(a != b) == 1]
        lines = [half * np.linspace(a, b, AROUND) for a, b in pairs]
    found = []
    for line in lines:
        places = solid.at + (line + np.array([0.0, 0.0, centre])) @ solid.axes
        places[((places < box[0]) | (places > box[1])).any(axis=1)] = np.nan
        found.append(places)
    return [places for places in found if np.isfinite(places).any()]
