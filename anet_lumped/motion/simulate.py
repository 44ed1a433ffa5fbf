"""The one place where a Model meets an integrator: method and step, the march, and the account of it."""

import math
import time
import warnings
from dataclasses import replace
from functools import partial

import numpy as np

from anet_lumped.checks import nearest
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model import rest_lengths
from anet_lumped.model.build import build
from anet_lumped.model.remainder import lightest
from anet_lumped.results.audit import audited
from anet_lumped.results.run import STATUS, Run, RunInterrupt, State, Work
from anet_lumped.scene.scene import Driven, Fixed, SceneError
from anet_lumped.statics.equilibrium import equilibrium
from integrators import embedded_march as embedded
from integrators import schemes
from integrators.interruptible import interruptible
from integrators.march import adaptive_march, fixed_march
from integrators.system import BALANCE, placed

from . import extrapolation
from .caveats import caveats
from .choice import choose
from .extrapolation import extrapolated
from .failure_messages import stiff_for, why_it_stopped
from .gain import weighed
from .legs import in_legs
from .times import stops

SCIPY = ("RK45", "DOP853", "Radau", "BDF", "LSODA")
DIFFRAX = ("Tsit5", "Kvaerno3", "Kvaerno5")
METHODS = schemes.EXPLICIT + schemes.IMPLICIT + SCIPY + DIFFRAX


class StabilityWarning(UserWarning):
    """A step beyond the predicted limit of its method."""


class RunError(RuntimeError):
    """A run that is not "done"; ``run`` holds what there is of it."""

    def __init__(self, run):
        super().__init__(run.message)
        self.run = run


def simulate(
    scene, t_end, *, method=None, dt=None, start="equilibrium", save_every=None, rtol=None, atol=None, rho_inf=None,
    extrapolate=False, audit=False, check=False
):  # fmt: skip
    """Motion of a scene from rest or from a State, through its events and the breaks of its cables (`Run.events`).

    Parameters
    ----------
    scene : Scene
    t_end : float [s]
    method : str or None
        One of `METHODS`; None picks one from the predicted limits and the motion's time scale, see ``Run.reason``.
    dt : float or None [s]
        Step; None picks it. With rtol or atol, the first step of an adaptive march; `dop853` without dt is adaptive at
        rtol=1e-6, as the solvers of other packages are.
    start : "equilibrium", "straight" or State
        "straight" has the nodes evenly spaced between the places of the points, at rest.
    save_every : float or None [s]
        Time between saved states, a multiple of dt for a fixed step; None saves about 400 states, or every step if fewer.
    rtol, atol : float or None
        Adaptive steps by step doubling: the error of a step is kept below atol [m] + rtol times the largest coordinate.
        `dop853` has an estimate of its own, which counts an error of a velocity as that of a place a second later.
    rho_inf : float or None
        Spectral radius at infinite frequency, for `edmc` (default 0) and `generalised_alpha` (default 0.8).
    extrapolate : bool
        Run with half the step too, and take the limit that the two runs of `edmc` tend to: order 4 where the motion is smooth, for
        half as much again as the finer run.
    audit : bool or float [m]
        Run again with half the step or a tenth of the tolerance, and compare: ``Run.audit`` estimates the error of the run, and
        its status is "audit failed" if that is above the number given (True: 1 % of the longest cable) or if the energy
        does not balance. Costs two to three times the run.
    check : bool
        Raise `RunError` if the run is not "done", instead of returning what there is.

    Returns
    -------
    Run

    Raises
    ------
    ValueError : an argument out of its range
    RunError : with ``check=True``
    RunInterrupt : Ctrl-C; with what was done as its ``run``
    """
    _check(t_end, method, dt, save_every, rtol, atol, rho_inf, audit)
    if extrapolate:
        method = extrapolation.check(method, rtol, atol)
    begin = _start(build(scene), start)
    of_itself = method in SCIPY + DIFFRAX or (method in schemes.EMBEDDED and dt is None)
    adaptive = of_itself or rtol is not None or atol is not None
    if rest_lengths.changes(scene) and method in SCIPY + DIFFRAX:
        raise ValueError(
            f"Lengths that change in time need a method of this package, {', '.join(schemes.EXPLICIT + schemes.IMPLICIT)}, but the "
            f"method is {method}."
        )
    choice = choose(lightest(rest_lengths.at_shortest(scene, begin.t, begin.t + t_end)), method, dt, adaptive)
    _check_breaks(scene, choice.method, extrapolate)
    if dt is None and not adaptive:
        whole = save_every or t_end
        choice = replace(choice, dt=whole / math.ceil(whole / choice.dt))  # steps that end on what is saved
    tolerances = (1e-6 if rtol is None and atol is None else rtol or 0.0, atol or 0.0 if rtol else atol or 1e-9)
    for text in choice.warnings:
        warnings.warn(text, StabilityWarning, stacklevel=2)
    if choice.method in SCIPY:
        from .scipy_methods import march
    elif choice.method in DIFFRAX:
        march = _of_diffrax(choice.method)
    else:
        march = _march
    whole = partial(in_legs, march, scene, start=begin, t_end=begin.t + t_end, stepped=not adaptive)
    run = whole(choice, save_every=save_every, settings=(adaptive, tolerances, rho_inf))
    if extrapolate:
        every = run.t[1] - run.t[0] if len(run.t) > 2 else t_end
        half = replace(choice, dt=0.5 * choice.dt)
        run = extrapolated(run, whole(half, save_every=every, settings=(adaptive, tolerances, rho_inf)))
    if audit and run.ok:
        finer = dict(rtol=0.1 * tolerances[0] or None, atol=0.1 * tolerances[1] or None) if adaptive else dict(dt=0.5 * choice.dt)
        finer["save_every"] = save_every if adaptive or len(run.t) < 3 else run.t[1] - run.t[0]
        again = partial(simulate, scene, t_end, method=run.method, start=start, rho_inf=rho_inf, extrapolate=extrapolate, **finer)
        order = None if adaptive else extrapolation.ORDER if extrapolate else schemes.order(run.method)
        run = audited(run, again, order, None if audit is True else audit)
    if run.ok:
        run = weighed(run, choice.limit, adaptive)
    if run.ok:
        run = replace(run, warnings=run.warnings + caveats(run, adaptive))
    return _finish(run, check)


def _march(model, choice, leg, q, v, tension, adaptive, tolerances, rho_inf):
    """March a leg with a scheme of our own; returns a Run."""
    from anet_lumped.mechanics.bindings import system  # compiled on first use: a scene or its equilibrium need none of it

    scheme = schemes.scheme(choice.method)
    embedding = adaptive and choice.method in schemes.EMBEDDED
    stepping = embedded.embedded_march() if embedding else adaptive_march() if adaptive else fixed_march()
    net, bound = fresh_net(model), system(model)
    words = placed(bound)
    net.tension[:] = tension
    memory = np.zeros((scheme.memory, model.n, 3))
    options = scheme.options(rho_inf)
    counts, balance = np.zeros(6, np.int64), np.zeros(BALANCE)
    if adaptive:
        saves = leg.times()
    else:
        stride, rows = leg.stride(choice.dt)
        saves = np.empty(rows)
    k = len(saves)
    out = saves, np.empty((k, model.n, 3)), np.empty((k, model.n, 3)), np.zeros((k, 5)), np.empty((k, model.n_segments))
    began, error, stiff = time.perf_counter(), None, ()
    if embedding:
        (status, saved, t, node, error, *held), interrupted = interruptible(
            stepping, scheme.step, words.ctypes.data, net.address, leg.begin, leg.end, choice.dt, scheme.order, *tolerances,
            scheme.stiff, embedded.MOST, stops(model.scene), q, v, memory, options, counts, balance, *out
        )  # fmt: skip
        stiff = stiff_for(choice, tolerances, counts, *held)
    elif adaptive:
        (status, saved, t, node, error), interrupted = interruptible(
            stepping, scheme.step, words.ctypes.data, net.address, leg.begin, leg.end, choice.dt, scheme.order, *tolerances,
            scheme.kept, stops(model.scene), q, v, memory, options, counts, balance, *out
        )  # fmt: skip
    else:
        (status, saved, t, node), interrupted = interruptible(
            stepping, scheme.step, words.ctypes.data, net.address, leg.begin, leg.end, leg.run_begin, choice.dt, stride,
            scheme.kept, q, v, memory, options, counts, balance, *out
        )  # fmt: skip
    run = Run(
        model, *(rows[:saved] for rows in out[:4]), choice.method, choice.dt, choice.reason,
        status=STATUS[status],
        message=why_it_stopped(model, choice, status, t, node, tolerances if embedding else None, counts),
        work=Work(*map(int, counts)),
        error_estimate=error,
        wall_time=time.perf_counter() - began,
        warnings=(*choice.warnings, *stiff),
        segment_tension=out[4][:saved],
    )  # fmt: skip
    if interrupted:
        raise RunInterrupt(run)
    return run


def _of_diffrax(method):
    """The march of diffrax's solvers; has JAX compute in float64 from here on."""
    try:
        from anet_lumped.motion.jax.diffrax_methods import march
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            f'Method "{method}" needs the packages jax and diffrax, but there is no {missing.name}; '
            'pip install "anet-lumped[diffrax]" brings them.'
        ) from missing
    return march


def _finish(run, check):
    if check and not run.ok:
        raise RunError(run)
    return run


def _start(model, start):
    """State to start from, with arrays of its own."""
    if isinstance(start, State):
        return _adopt(model, start)
    still = np.zeros((model.n, 3))
    if start == "equilibrium":
        return equilibrium(model.scene)
    if start == "straight":
        return State(model, 0.0, straight(model), still, np.zeros(model.n_segments))
    raise ValueError(f'Argument `start` must be "equilibrium", "straight" or a State, but it is {start!r}.')


def straight(model):
    """(n, 3) places with every cable's nodes evenly spaced between its points' places [m]."""
    at = {}
    for point in model.scene.points:
        at[point.name] = point.path.at(0.0)[0] if isinstance(point, Driven) else point.at
        if at[point.name] is None:
            raise SceneError(f'start="straight" needs the place of every point, but free point "{point.name}" has no `at`.')
    q = np.empty((model.n, 3))
    for cable in model.scene.cables:
        a, b = np.asarray(at[cable.start], float), np.asarray(at[cable.end], float)
        q[model.nodes(cable.name)] = a + np.linspace(0.0, 1.0, cable.segments + 1)[:, None] * (b - a)
    for point in model.scene.points:
        q[model.node(point.name)] = at[point.name]
    return q


def _adopt(model, state):
    """A State of the same or of a like scene as one of this model, matched by names."""
    q, v, tension = np.zeros((model.n, 3)), np.zeros((model.n, 3)), np.zeros(model.n_segments)
    for cable in model.scene.cables:
        other = {c.name: c.segments for c in state.scene.cables}.get(cable.name)
        if other != cable.segments:
            raise ValueError(
                f'A State to start from must have the scene\'s cables, but of cable "{cable.name}" with {cable.segments} '
                f"segments it has {'none' if other is None else other}."
            )
        mine, theirs = model.nodes(cable.name), state.model.nodes(cable.name)
        q[mine], v[mine] = state.q[theirs], state.v[theirs]
        tension[model.segments(cable.name)] = state.tension(cable.name)
    for point in model.scene.points:
        if isinstance(point, Fixed):
            q[model.node(point.name)], v[model.node(point.name)] = point.at, 0.0
    return State(model, float(state.t), q, v, tension, events=state.events)


def _check_breaks(scene, method, extrapolate):
    """Cables that may break need a march that looks for it, and one motion."""
    brittle = next((cable.name for cable in scene.cables if cable.breaking_tension is not None), None)
    if brittle is not None and (method in DIFFRAX or extrapolate):
        given = "`extrapolate` is set" if extrapolate else f"the method is {method}"
        raise ValueError(
            f'A cable with a `breaking_tension` needs a method other than {", ".join(DIFFRAX)} and one run, but cable "{brittle}" '
            f"has one and {given}."
        )


def _check(t_end, method, dt, save_every, rtol, atol, rho_inf, audit):
    sizes = dict(t_end=t_end, dt=dt, save_every=save_every, rtol=rtol, atol=atol, audit=None if isinstance(audit, bool) else audit)
    for name, value in sizes.items():
        if value is not None and not (isinstance(value, int | float | np.number) and math.isfinite(value) and value > 0):
            unit = "" if name == "rtol" else " [m]" if name in ("atol", "audit") else " [s]"
            raise ValueError(f"Argument `{name}` must be positive and finite{unit}, but it is {value!r}.")
    if method is not None and method not in METHODS:
        known = ", ".join(METHODS)
        raise ValueError(f"Argument `method` must be one of {known}, but it is {method!r}" + (nearest(str(method), METHODS) or "."))
    if rho_inf is not None:
        if method not in (None, *schemes.RHO_INF):
            raise ValueError(f"Argument `rho_inf` belongs to {' and '.join(schemes.RHO_INF)}, but the method is {method}.")
        if not 0 <= rho_inf <= 1:
            raise ValueError(f"Argument `rho_inf` must lie between 0 and 1, but it is {rho_inf!r}.")
