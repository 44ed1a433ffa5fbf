"""What the command `mismatch` compares a scene with: the catenary, markers of one shape, or a motion."""

import csv
from dataclasses import asdict

from anet_lumped.checks import quoted

FARTHEST = 8  # markers in the table
STILL = 0.01  # of the longest cable: how far markers of one shape may move while they are recorded


def compared(scene, markers, tension, shift, up, out):
    """Compare a scene.

    Parameters
    ----------
    scene : Scene
    markers, tension : paths of files, or None
    shift : float or None [s], for a motion
    up : "y", "z" or None, the axis of tracks that points up
    out : folder or None

    Returns
    -------
    found : dict, for `given.give`
    save : what writes pictures and files into the folder
    ok : bool, whether the run of a motion is done

    Raises
    ------
    InputError : a shift without a motion
    """
    from anet_lumped.checks import InputError
    from studies.shown import motion_mismatch

    tracks = _tracks_of_the_scene(scene, markers, up)
    if tension or tracks:
        run, found, left_out = motion_mismatch.motion_mismatch(scene, tension, tracks, shift)
        return (
            motion_mismatch.tables(run, found, left_out),
            lambda: motion_mismatch.plot(run, found).savefig(out / "mismatch.png", dpi=110),
            run.ok,
        )
    if shift is not None:
        raise InputError("A --shift is for a motion, but neither tensions nor tracks over time are given.")
    return (*(_with_markers(scene, markers, up, out) if markers else _with_the_catenary(scene, out)), True)


def _tracks_of_the_scene(scene, markers, up):
    """Tracks of a file whose names are those of points or of places on cables; None where it has none, so that it is one shape."""
    from anet_lumped.files.measured_series import holds_tracks, read_tracks

    if markers is None or not holds_tracks(markers):
        return None
    tracks = read_tracks(markers, up)
    names = {point.name for point in scene.all_points} | {body.name for body in scene.bodies}
    known = {name for name in tracks.channels if name in names or name.rpartition("@")[0] in scene.cable_numbers}
    return (tracks, sorted(set(tracks.channels) - known)) if known else None


def _with_the_catenary(scene, out):
    """The scene at rest against the elastic catenary net between the same supports."""
    from anet_lumped.advice.compare import compare
    from anet_lumped.statics.equilibrium import equilibrium

    rest = equilibrium(scene)
    found = compare(rest)
    return {
        "cables": [asdict(cable) for cable in found.cables],
        "error_of_points": [{"point": name} | _xyz(error) for name, error in found.points.items()],
    }, lambda: rest.plot().savefig(out / "mismatch.png", dpi=110)


def _with_markers(scene, file, up, out):
    """The scene at rest against measured markers, before and after its cables' lengths are fitted to them."""
    from anet_lumped.advice.markers import MarkerError, fit_markers, read_markers
    from anet_lumped.files.scene_file import save_scene

    markers = read_markers(file, scene, up=up)
    try:
        fit = fit_markers(markers.xyz, scene)
    except MarkerError as error:
        if markers.spread is None:
            raise
        raise MarkerError(
            f'{error} No track, as {quoted(markers.names[0])}, has the name of a point or of a place on a cable, "CABLE@ARC", so '
            "that the tracks are taken for one shape at rest."
        ) from None
    rows = _rows(markers, fit)
    warning = []
    if markers.spread is not None and markers.spread.max() > STILL * scene.longest:
        worst = markers.names[int(markers.spread.argmax())]
        warning = [f'The markers are taken for one shape at rest, but "{worst}" moves by {1e3 * markers.spread.max():.3g} mm.']

    def save():
        fit.plot().savefig(out / "mismatch.png", dpi=110)
        save_scene(fit.scene, out / "fitted.toml")
        with (out / "markers.csv").open("w", newline="", encoding="utf-8") as text:
            table = csv.DictWriter(text, [*rows[0]])
            table.writeheader()
            table.writerows(rows)

    on_cables = [row for row in rows if row["cable"]]
    return {
        "markers": len(markers.xyz),
        "unit": markers.unit,
        "rows_without_a_position": markers.empty_rows,
        "outliers": fit.outliers,
        "offset": [_xyz(fit.offset)],
        "cables": [asdict(cable) for cable in fit.cables],
        "farthest_markers": [_short(row) for row in sorted(on_cables, key=lambda row: -row["distance_m"])[:FARTHEST]],
        **({"warning": warning} if warning else {}),
    }, save


def _rows(markers, fit):
    """A row for each marker: where it is, on which cable, and how far from it; without a cable if it is an outlier."""
    rows = []
    for k, name in enumerate(markers.names):
        i = fit.sequence.cable[k]
        rows.append(
            {"marker": name}
            | {f"{axis}_m": place for axis, place in _xyz(fit.xyz[k].tolist()).items()}
            | {"cable": "" if i < 0 else fit.scene.cables[i].name, "arc_m": float(fit.sequence.arc[k])}
            | {"distance_m": float(fit.sequence.distance[k])}
            | {f"d{axis}_m": apart for axis, apart in _xyz(fit.residuals[k].tolist()).items()}
            | ({} if markers.spread is None else {"moves_m": float(markers.spread[k])})
        )
    return rows


def _short(row):
    """What a table tells of a marker: where it is on its cable, and how far from it."""
    apart = {f"{name}_mm": 1e3 * row[f"{name}_m"] for name in ("distance", "dx", "dy", "dz")}
    return {"marker": row["marker"], "cable": row["cable"], "arc_m": row["arc_m"]} | apart


def _xyz(vector):
    return dict(zip("xyz", vector, strict=True))
