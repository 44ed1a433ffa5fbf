"""What is timed: every method of this package and every engine installed beside it, called alike."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from anet_lumped import InputError, simulate
from anet_lumped.motion.simulate import StabilityWarning
from anet_lumped.motion.stability import predict
from integrators import schemes
from studies.accuracy_cost.motions import SHARED_LAW, fitting
from studies.peers import installed
from studies.shown.sentences import power

OURS = "anet-lumped"
OWN_CHOICE = "own choice"  # method and step that the library picks
ADAPTIVE, EXTRAPOLATED = "edmc, adaptive", "edmc, extrapolated"
SHARES = (0.9, 0.3)  # of an explicit method's predicted limit
GROWING_SHARES = (0.1, 0.02)  # of verlet's limit, for a method that is stable at no step: it still grows
EDMC_RTOL = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
EMBEDDED_RTOL = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
RTOL = (1e-3, 1e-5, 1e-7)  # of solvers that choose their steps
EXTRA_SETTINGS = {"MuJoCo": ({"dt": 0.04 / 3, "integrator": "discrete"},)}  # coarser than its own settings, and it holds
LINK_RTOL = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
STIFF = 1e6  # [N], from which on cables stretch so little that links are tried in their place
RIGID = ", EA inf"  # added to a method's name, where the motion's own cables stretch
ELASTIC = "Of nets it takes elastic ones only."
PUSHED = "linear"  # law of links where a cable slackens, as that of other engines' rigid links
LAW_OF_SETTING = {"both": "linear", "pull": "damped"}  # of compression, by what EXUDYN calls it
LAW_OF_ENGINE = {"Drake": "linear"}  # rigid links push as they pull; other engines' springs only pull and their dampers always act


@dataclass(frozen=True, eq=False)
class Attempt:
    """What came of one run: positions (k, 3) [m] of the judged point, time of the march and of what came before [s]."""

    position: np.ndarray
    wall: float
    setup: float
    status: str
    reason: str


@dataclass(frozen=True, eq=False)
class Contestant:
    """A method of an engine, with its settings from coarse to fine.

    ``run(t_end, setting)`` gives an `Attempt`; ``law`` says by which law of compression a setting moves cables.
    """

    engine: str
    method: str
    settings: tuple[dict, ...]
    run: Callable
    law: str


def of_another_package(method):
    """Whether a method is a solver of another package, which pays for each step what a compiled march does not."""
    return method in schemes.MODULES and not schemes.scheme(method).own


def ours(motion, only=None):
    """Contestants of this package; ``only`` some methods."""
    found = [_own(motion, method, _settings(motion, method)) for method in schemes.names()]
    found += _by_links(motion)
    found += [_own(motion, ADAPTIVE, [{"rtol": rtol} for rtol in EDMC_RTOL]), _own(motion, OWN_CHOICE, [{}])]
    found += [_own(motion, EXTRAPOLATED, [{"dt": dt, "extrapolate": True} for dt in motion.steps])]
    return [one for one in found if only is None or one.method in only]


def _by_links(motion):
    """Methods that take the stiffness out, on the same motion of cables that do not stretch."""
    if motion.EA < STIFF or not motion.from_lengths:
        return []
    law = PUSHED if motion.law == SHARED_LAW else motion.law
    rigid = motion.with_law(law).with_stiffness(np.inf)
    settings = {"links": [{"rtol": rtol} for rtol in LINK_RTOL], "links5": [{"dt": dt} for dt in motion.steps]}
    found = []
    for method, own in settings.items():
        name = method if np.isinf(motion.EA) else method + RIGID
        found.append(Contestant(OURS, name, tuple(own), partial(_run_own, rigid, method), law))
    return found


def peers(motion):
    """Contestants of the engines that are installed and take the scene, one for each scheme of an engine."""
    found = []
    refused = refusals(motion)
    for module in installed():
        if module.NAME in refused:
            continue
        by_scheme = {}
        for setting in (*EXTRA_SETTINGS.get(module.NAME, ()), *module.settings(motion.scene)):
            by_scheme.setdefault(_scheme(setting), []).append(setting)
        for (scheme, law), settings in by_scheme.items():
            run = partial(_run_peer, module, motion)
            found.append(Contestant(module.NAME, scheme, tuple(settings), run, law or LAW_OF_ENGINE.get(module.NAME, "damped")))
    return found


def refusals(motion):
    """Reasons of the engines that are installed and do not take the scene, by name."""
    said = {module.NAME: ELASTIC if np.isinf(motion.EA) else module.refuses(motion.scene) for module in installed()}
    return {name: reason for name, reason in said.items() if reason}


def setting_in_words(setting):
    """A setting in words, such as "10 ms" or "rtol 1e-5"."""
    if "dt" in setting:
        return f"{1e3 * setting['dt']:.4g} ms"
    return ", ".join(f"{name} {power(value)}" for name, value in setting.items() if isinstance(value, float)) or "auto"


def _own(motion, method, settings):
    return Contestant(OURS, method, tuple(settings), partial(_run_own, motion, method), motion.law)


def _settings(motion, method):
    if of_another_package(method):
        return [{"rtol": rtol} for rtol in RTOL]
    scheme = schemes.scheme(method)
    if scheme.embedded and np.isfinite(motion.EA):
        return [{"rtol": rtol} for rtol in EMBEDDED_RTOL]
    if not scheme.explicit or np.isinf(motion.EA):
        return [{"dt": dt} for dt in motion.steps]
    bound, shares = (method, SHARES) if scheme.stable_undamped else ("verlet", GROWING_SHARES)
    limit = predict(motion.scene, schemes=(bound,)).limits[bound].step
    return [{"dt": fitting(share * limit, motion.save_every)} for share in shares]


def _run_own(motion, method, t_end, setting):
    method = {ADAPTIVE: "edmc", EXTRAPOLATED: "edmc", OWN_CHOICE: None}.get(method, method)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StabilityWarning)
        try:
            every = min(motion.save_every, t_end)
            run = simulate(motion.scene, t_end, method=method, start=motion.start, save_every=every, **setting)
        except (InputError, ImportError) as error:  # a scene that the method does not take, a package that is not there
            return Attempt(np.zeros((0, 3)), np.nan, np.nan, "refused", str(error))
    reason = run.message or (f"{run.method} at {1e3 * run.dt:.4g} ms" if method is None else "")
    return Attempt(run.position(motion.point), run.wall_time, 0.0, run.status, reason)


def _scheme(setting):
    """Scheme of a peer's setting, and the law of compression that it names, if any."""
    scheme = next((value for name, value in setting.items() if name in ("solver", "integrator", "scheme")), "")
    return scheme, LAW_OF_SETTING.get(setting.get("law"))


def _run_peer(module, motion, t_end, setting):
    start = None if motion.start == "straight" else motion.start
    try:
        outcome = module.run(motion.scene, t_end, motion.save_every, start, **setting)
    except Exception as error:  # whatever an engine raises is its row's reason
        return Attempt(np.zeros((0, 3)), np.nan, np.nan, "failed", f"{type(error).__name__}: {error}".splitlines()[0][:300])
    return Attempt(outcome.position[motion.point], outcome.wall_time, outcome.setup_time, outcome.status, outcome.message)
