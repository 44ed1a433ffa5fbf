"""A scene's motion beside measured tensions and tracks: the run, the tables and the picture of the command `mismatch`."""

from dataclasses import asdict

import numpy as np

from anet_lumped.views.palette import BLACK, VERMILION

MOST_PANELS = 8  # of the picture
FEWEST_STATES = 400  # that are saved, and more where more was measured
MOST_STATES = 5000
UNSURE = "What was measured hardly tells the shift of the clock: others are nearly as good. Give the right one by --shift."


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
        "warning": [*run.warnings, *([] if found.sure else [UNSURE])],
    }


def _row(channel, unit):
    row = asdict(channel)
    peak_error, phase = row.pop("peak_error"), row.pop("phase_error")
    quantities = {f"{name}_{unit}": row.pop(name) for name in ("rmse", "largest", "measured_peak", "model_peak")}
    return row | quantities | {"peak_error_percent": 100.0 * peak_error, "phase_error_s": phase}


def plot(run, found):
    """Figure of what was measured and of the model over time, a panel for each channel, those that differ most first."""
    from matplotlib.figure import Figure

    from anet_lumped.views.run_figure import mark_failures

    channels = [*found.tensions, *found.markers]
    shown = sorted(channels, key=lambda one: -one.rmse / max(one.measured_peak, 1e-300))[:MOST_PANELS]
    figure = Figure(figsize=(9.5, 0.8 + 1.9 * len(shown)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(len(shown), 1, sharex=True))
    for panel, channel in zip(panels, shown, strict=True):
        t, measured, model = found.curves[channel.name]
        marker = measured.shape[1] == 3
        for k in range(measured.shape[1]):
            panel.plot(t, measured[:, k], ".", color=BLACK, ms=2.5, label=None if k else "measured")
            panel.plot(t, model[:, k], color=VERMILION, lw=1.1, label=None if k else "model")
            if marker:
                panel.annotate("xyz"[k], (t[-1], model[-1, k]), xytext=(4, 0), textcoords="offset points", fontsize=8, va="center")
        panel.set_title(channel.name, fontsize=9, loc="left", parse_math=False)
        panel.set_ylabel("place [m]" if marker else "tension [N]")
        panel.spines[["top", "right"]].set_visible(False)
    panels[-1].set_xlabel("time of the run [s]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2, frameon=False, fontsize=9)
    mark_failures(figure, run)
    return figure
