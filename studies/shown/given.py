"""A result that a command gives: saved first, then printed."""


def give(result, as_json=False, out=None, stem="", save=lambda: None, whole=False):
    """Save a result in the folder `out` if there is one, with what `save` writes there besides; then print it, long tables `whole`.

    In this order nothing is lost where stdout is closed or full.
    """
    from anet_lumped.regular_files import check_target

    from .show import as_json as to_json
    from .show import show

    if out:
        try:
            check_target(out / f"{stem}.json", "A result")
            (out / f"{stem}.json").write_text(to_json(result), encoding="utf-8")
            save()
        except OSError as error:  # that of a full disk names no file
            raise OSError(error.errno, error.strerror or str(error), error.filename or str(out)) from None
    if as_json:
        print(to_json(result))
    else:
        show(result, whole)
