"""The rest and the run of a row of a sweep, on arrays that rows with the same names and segments share."""

import threading

from anet_lumped.motion.plan import Asked, check_arguments
from anet_lumped.motion.repeated import Repeated
from anet_lumped.motion.simulate import simulate
from anet_lumped.results.run import Run
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene
from anet_lumped.scene.varied import SETTINGS

_of_thread = threading.local()
KINDS = 8  # of settings, of which arrays are kept


def rest_and_run(scene: Scene, settings: dict | None, rests: bool) -> tuple[State | None, Run | None]:
    """What a row measures.

    Parameters
    ----------
    scene : Scene
    settings : of `simulate`, words and numbers, for a run; None for none
    rests : bool, whether the scene at rest is measured

    Returns
    -------
    rest : State or None
    run : Run or None, whose arrays the next row of this thread may overwrite
    """
    repeated, start = _repeated(settings or {}), (settings or {}).get("start", "equilibrium")
    rest = repeated.rest(scene) if rests else None
    if settings is None:
        return rest, None
    begin = rest if start == "equilibrium" else None
    run = repeated.run(scene, begin)
    if run is None:
        run = simulate(scene, **(settings if begin is None else settings | {"start": begin}))
    return rest, run


def _repeated(settings: dict) -> Repeated:
    """Arrays of this thread for runs with some settings."""
    known = vars(_of_thread).setdefault("repeated", {})
    key = tuple((name, settings.get(name)) for name in SETTINGS)
    if key not in known:
        given = [settings.get(name) for name in ("t_end", "method", "dt")]
        tolerances = [settings.get(name) for name in ("rtol", "atol")]
        if settings:
            check_arguments(*given, None, *tolerances, settings.get("rho_inf"), False, None, None)
        while len(known) >= KINDS:
            known.pop(next(iter(known)))
        known[key] = Repeated(Asked(*given, None, *tolerances), settings.get("start", "equilibrium"), settings.get("rho_inf"))
    return known[key]
