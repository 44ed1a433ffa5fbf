"""A scene's motion beside measured tensions and tracks: the run, the tables and the picture of the command `mismatch`."""

from dataclasses import asdict

FEWEST_STATES = 400  # that are saved, and more where more was measured
MOST_STATES = 5000
UNSEEN = 0.01  # of the measured time, up to which nothing is said where it is not compared
FAR = 10.0  # lengths of the longest cable, which no marker is off by that is in metres and along the axes of the scene
UNSURE = "What was measured hardly tells the shift of the clock: others are nearly as good. Give the right one by --shift."
AT_END = (
    "The shift found is the largest that is tried, a quarter of the measured time: the run may begin elsewhere, or times are not "
    "in s. Give the right one by --shift."
)
AWAY = (
    'Marker "{}" is {:.3g} m from its place in the run, {:.3g} times the longest cable: places must be in m, along the axes of the '
    "scene."
)


def motion_mismatch(scene, tension, tracks, shift=None):
    """Run a scene for as long as was measured, from its rest, and compare.

    Parameters
    ----------
    scene : Scene
    tension : path of a file, or None
    tracks : Series and names of those of its channels that the scene has not, or None
    shift : float or None [s], time of the run at the first sample; sought if None

    Returns
    -------
    run : Run
    found : MotionMismatch
    left_out : names of markers
    """
    from anet_lumped.advice.motion_mismatch import compare_motion
    from anet_lumped.files.measured_series import Series, read_tensions
    from anet_lumped.motion.simulate import simulate

    tensions, left_out = tension and read_tensions(tension), []
    if tracks:
        series, left_out = tracks
        tracks = Series(series.t, {name: xyz for name, xyz in series.channels.items() if name not in left_out})
    given = [series for series in (tensions, tracks) if series]
    span = max(series.t[-1] for series in given) - min(series.t[0] for series in given)
    states = min(max(FEWEST_STATES, *(len(series.t) for series in given)), MOST_STATES)
    t_end = float(span + max(shift or 0.0, 0.0))
    run = simulate(scene, t_end, save_every=t_end / states)
    return run, compare_motion(run, tensions, tracks, shift), left_out


def tables(run, found, left_out=()) -> dict:
    """What a comparison says, as tables."""
    return {
        "status": run.status,
        **({"message": run.message} if run.message else {}),
        "shift_s": found.shift,
        "shift_is": "found by least squares" if found.found else "given",
        "compared_s": found.overlap,
        "tensions": [_row(one, "N") for one in found.tensions],
        "markers": [_row(one, "m") for one in found.markers],
        **({"left_out": ", ".join(left_out)} if left_out else {}),
        "warning": [
            *run.warnings,
            *([] if found.sure else [UNSURE]),
            *([AT_END] if found.at_end and found.sure else []),
            *_not_compared(run, found),
            *(
                AWAY.format(one.name, one.rmse, one.rmse / run.scene.longest)
                for one in found.markers
                if run.scene.longest and one.rmse > FAR * run.scene.longest
            ),
        ],
    }


def _not_compared(run, found):
    """What was measured before the run begins or after it ends, as sentences."""
    least = UNSEEN * (found.overlap + found.before + found.after)
    if found.before > least:
        yield f"The first {found.before:.3g} s that were measured are before the run and are not compared: it begins at t = 0."
    if found.after > least:
        yield (
            f"The last {found.after:.3g} s that were measured are after the run, which ends at t = {run.t[-1]:.4g} s, and are not "
            f"compared; with --shift {found.shift:.4g} it runs so much longer."
        )


def _row(channel, unit):
    row = asdict(channel)
    peak_error, phase = row.pop("peak_error"), row.pop("phase_error")
    quantities = {f"{name}_{unit}": row.pop(name) for name in ("rmse", "largest", "measured_peak", "model_peak")}
    return row | quantities | {"peak_error_percent": 100.0 * peak_error, "phase_error_s": phase}


def plot(run, found):
    """The figure of a comparison, with what is wrong with its run."""
    from anet_lumped.views.run_figure import mark_failures

    figure = found.plot()
    mark_failures(figure, run)
    return figure
