"""What the command `mismatch` compares a scene with: the catenary, markers of one shape, or a motion."""


def compared(scene, markers, tension, shift, out):
    """Compare a scene.

    Parameters
    ----------
    scene : Scene
    markers, tension : paths of files, or None
    shift : float or None [s], for a motion
    out : folder or None

    Returns
    -------
    found : dict, for `given.give`
    save : what writes the picture into the folder
    ok : bool, whether the run of a motion is done

    Raises
    ------
    InputError : a shift without a motion
    """
    from anet_lumped.checks import InputError
    from anet_lumped.files.measured_series import holds_tracks
    from studies.shown import motion_mismatch
    from studies.shown.summary import catenary_comparison, marker_comparison

    if tension or (markers and holds_tracks(markers)):
        run, found = motion_mismatch.motion_mismatch(scene, tension, markers, shift)
        return (
            motion_mismatch.tables(run, found),
            lambda: motion_mismatch.plot(run, found).savefig(out / "mismatch.png", dpi=110),
            run.ok,
        )
    if shift is not None:
        raise InputError("A --shift is for a motion, but neither tensions nor tracks over time are given.")
    return (marker_comparison(scene, markers) if markers else catenary_comparison(scene)), lambda: None, True
