"""The lumped model against the catenary: shape, length, sag and tension of each cable.

The catenary is the observation Y of Eqs. 4.1-4.4 of the thesis, the lumped model the prediction. Nodes are compared
with the catenary at the same unstretched arc length, and with the nearest point of its curve.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from anet_lumped.checks import InputError, shown
from anet_lumped.results.sag import below_chord
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Cable, Fixed, Free
from anet_lumped.statics.catenary_net import Turned, catenaries_between_ends, catenary_net

CURVE_POINTS = 4001  # chords of a curve drawn with 4,000 miss it by 1e-8 of its length


def rmse(observed: ArrayLike, predicted: ArrayLike) -> float:
    """Root mean square of the distance between observed and predicted values or points.

    RMSE = sqrt(sum |Y_i - Yhat_i|^2 / n).

    Parameters
    ----------
    observed, predicted : (n,) or (n, d) float64

    Returns
    -------
    float, in the unit of the values; NaN for n = 0

    Source
    ------
    Thesis, Eq. 4.1.
    """
    error = np.asarray(observed) - np.asarray(predicted)
    return float(np.sqrt((error**2).sum() / len(error))) if len(error) else np.nan


def r_squared(observed: ArrayLike, predicted: ArrayLike) -> float:
    """Coefficient of determination.

    R^2 = 1 - sum (Y_i - Yhat_i)^2 / sum (Y_i - Ybar)^2, with Ybar the mean of the observations. Y should be one
    coordinate, (n,). Of (n, d) points all coordinates are pooled around one mean: then Ybar has no meaning, R^2 changes
    with the origin of the frame and tends to 1 as it moves away; given to show just that.

    Parameters
    ----------
    observed, predicted : (n,) or (n, d) float64

    Returns
    -------
    float; NaN if the observations do not vary

    Source
    ------
    Thesis, Eqs. 4.2-4.4 (which takes Ybar from the predicted values; the mean of the observations is right).
    """
    observed, predicted = np.ravel(observed), np.ravel(predicted)
    spread = ((observed - observed.mean()) ** 2).sum() if len(observed) else 0.0
    # A coordinate that is constant but for round-off does not vary.
    if spread <= len(observed) * (1e-12 * np.abs(observed).max(initial=0.0)) ** 2:
        return np.nan
    return float(1 - ((observed - predicted) ** 2).sum() / spread)


def project(points: np.ndarray, curve: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nearest points of a polyline.

    Parameters
    ----------
    points : (m, 3) float64 [m]
    curve : (k + 1, 3) float64 [m]

    Returns
    -------
    distance : (m,) float64 [m]
    place : (m,) float64
        Number of the segment plus the fraction of it, 0 to k.
    nearest : (m, 3) float64 [m]
    """
    start, along = curve[:-1], np.diff(curve, axis=0)
    offset = points[:, None] - start
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    fraction = np.clip((offset * along).sum(axis=2) / square, 0.0, 1.0)
    distance = np.linalg.norm(offset - fraction[:, :, None] * along, axis=2)
    rows, segment = np.arange(len(points)), distance.argmin(axis=1)
    fraction = fraction[rows, segment]
    return distance[rows, segment], segment + fraction, start[segment] + fraction[:, None] * along[segment]


@dataclass(frozen=True)
class CableMismatch:
    """One cable of the lumped model against its catenary; errors are lumped minus catenary.

    Attributes
    ----------
    cable : str
    segments : int
    rmse, rmse_height, rmse_curve : float [m]
        Over the nodes: distance at the same unstretched arc length, its vertical part, distance to the nearest point.
    largest : float [m]
        Largest distance at the same arc length.
    r_squared_vertical, r_squared_pooled : float
        Y is the height; Y is x, y and z together (see `r_squared` for what that is worth).
    length, length_reference, length_error : float [m]
        Stretched.
    stretch : float
        length / unstretched length - 1.
    sag, sag_reference, sag_error : float [m]
        Largest distance below the chord, along gravity.
    tension, tension_reference : float [N]
        Largest; of the lumped model in a segment, of the catenary at the middle of a segment.
    tension_error : float [N]
        The difference in that segment where it is largest.
    end_force_error : float [N]
        Of the larger of the two end forces, with the weight of the half segment that an end node carries.
    """

    cable: str
    segments: int
    rmse: float
    rmse_height: float
    rmse_curve: float
    largest: float
    r_squared_vertical: float
    r_squared_pooled: float
    length: float
    length_reference: float
    length_error: float
    stretch: float
    sag: float
    sag_reference: float
    sag_error: float
    tension: float
    tension_reference: float
    tension_error: float
    end_force_error: float


@dataclass(frozen=True)
class Comparison:
    """A state of the lumped model against catenaries: `cables`, a list of CableMismatch, and `points`, for each free
    point the (3,) error of its place [m], lumped minus catenary."""

    cables: list[CableMismatch]
    points: dict[str, np.ndarray]


def compare(state: State, *, reference: str = "net", elastic: bool = True) -> Comparison:
    """Compare a state of the lumped model with the catenary.

    Parameters
    ----------
    state : State
    reference : "net" or "ends"
        "net": the continuous net between the same supports, whose free points rest by their own balance of forces.
        "ends": for each cable the catenary between the ends that it has in the lumped model.
    elastic : bool
        Each catenary has its cable's EA; False compares with cables that do not stretch.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        An unknown reference, or a scene without gravity.
    """
    if not isinstance(state, State):
        raise InputError(f"A state to compare must be a State, as equilibrium(scene) returns one, but it is {shown(state)}.")
    scene = state.scene
    places = {point.name: np.asarray(state.position(point.name)) for point in scene.all_points}
    if scene.bodies:
        held = [Fixed(point.name, tuple(places[point.name].tolist())) for body in scene.bodies for point in body.points]
        scene = replace(scene, points=(*scene.points, *held), bodies=())
    if reference == "net":
        net = catenary_net(scene, places, elastic=elastic)
    elif reference == "ends":
        net = catenaries_between_ends(scene, places, elastic=elastic)
    else:
        raise InputError(f'The reference must be "net" or "ends", but reference={shown(reference)} was given.')
    up = -scene.gravity / np.linalg.norm(scene.gravity)
    return Comparison(
        [_compare_cable(state, cable, net.cables[cable.name], up) for cable in scene.cables],
        {point.name: places[point.name] - net.points[point.name] for point in scene.points if isinstance(point, Free)},
    )


def _compare_cable(state: State, cable: Cable, catenary: Turned, up: np.ndarray) -> CableMismatch:
    nodes, tension = state.shape(cable.name), state.tension(cable.name)
    arc = np.linspace(0.0, cable.length, cable.segments + 1)
    exact, curve = catenary.point(arc), catenary.point(np.linspace(0.0, cable.length, CURVE_POINTS))
    error = nodes - exact
    middle = catenary.tension((arc[:-1] + arc[1:]) / 2)
    length = float(np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum())
    sag = float(below_chord(nodes, nodes[0], nodes[-1], up).max())
    tension_error = tension - middle
    return CableMismatch(
        cable.name,
        cable.segments,
        rmse=rmse(exact, nodes),
        rmse_height=rmse(exact @ up, nodes @ up),
        rmse_curve=float(np.sqrt((project(nodes, curve)[0] ** 2).mean())),
        largest=float(np.linalg.norm(error, axis=1).max()),
        r_squared_vertical=r_squared(exact @ up, nodes @ up),
        r_squared_pooled=r_squared(exact, nodes),
        length=length,
        length_reference=catenary.length,
        length_error=length - catenary.length,
        stretch=length / cable.length - 1,
        sag=sag,
        sag_reference=catenary.sag,
        sag_error=sag - catenary.sag,
        tension=float(tension.max()),
        tension_reference=float(middle.max()),
        tension_error=float(tension_error[np.abs(tension_error).argmax()]),
        end_force_error=_end_force_error(cable, nodes, tension, catenary, state.scene.gravity),
    )


def _end_force_error(cable: Cable, nodes: np.ndarray, tension: np.ndarray, catenary: Turned, gravity: np.ndarray) -> float:
    half = cable.half_segment_mass * gravity
    forces = []
    for end, inner, pull in ((nodes[0], nodes[1], tension[0]), (nodes[-1], nodes[-2], tension[-1])):
        along = inner - end
        forces.append(np.linalg.norm(pull * along / max(np.linalg.norm(along), np.finfo(float).tiny) + half))
    return float(max(forces) - catenary.tension(np.array([0.0, cable.length])).max())
