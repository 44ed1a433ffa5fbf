"""EXUDYN, a multibody code in C++: mass points and spring-dampers."""

import time

import numpy as np

from anet_lumped.checks import InputError, shown
from anet_lumped.prescribed.smoothstep import smoothstep
from anet_lumped.scene.scene import Driven
from studies.peers.problem import explicit_limit, problem, raise_if_refused, unsupported, version_of

NAME = "EXUDYN"
DESCRIPTION = (
    "Nodes are mass points, segments its spring-dampers, fixed points ground, and driven points are held to their path by "
    "constraints whose functions are symbolic, so that no Python runs while it marches. Its best setting is generalised-alpha "
    "(spectral radius 0.9, sparse LU, a new Jacobian a step on stiff cables, a kept one on soft ones) with its own two-way "
    "spring, the same law while a cable is taut but not once it slackens, because with springs that only pull Newton stalls "
    "on stiff cables; where no point is driven its explicit schemes run too, and there the springs only pull."
)

TOLERANCE = 1e-6  # of Newton, relative and absolute: tighter ones cannot be met on stiff cables, and it stalls
RHO_INF = 0.9  # spectral radius at infinite frequency; below 1, or the constraints ring
STEPS = (40e-3, 20e-3, 10e-3, 5e-3, 2.5e-3, 1e-3, 5e-4, 2.5e-4)  # [s] of the implicit scheme
STIFF = 5e4  # [rad/s] bound of the axial frequencies above which a kept Jacobian costs more than it saves
HALVINGS = 64  # a step that Newton fails on is cut to no less than this part
LIMITS = {"VelocityVerlet": 2.0, "RK44": 2.78}  # of omega·dt
LAWS = ("pull", "both")


def version():
    """Version of the installed engine, or None."""
    return version_of("exudyn")


def refuses(scene):
    """Why it cannot do a scene, in one sentence, or None."""
    return unsupported(scene, NAME, compression=("none", "damped", "linear"))


def limit(scene, solver):
    """Largest stable step of an explicit scheme by the bound of the axial frequencies [s]."""
    return explicit_limit(scene, LIMITS[solver])


def settings(scene):
    """Steps of generalised-alpha with two-way springs, then explicit ones that pull only where no point is driven."""
    fresh = max(cable.omega_max for cable in scene.cables) > STIFF
    found = [{"dt": dt, "solver": "GeneralizedAlpha", "law": "both", "fresh": fresh} for dt in STEPS]
    if not any(isinstance(point, Driven) for point in scene.points):
        for solver, fractions in (("VelocityVerlet", (0.9, 0.3)), ("RK44", (0.95,))):
            found += [{"dt": part * limit(scene, solver), "solver": solver, "law": "pull", "fresh": False} for part in fractions]
    return found


def run(scene, t_end, save_every, start=None, *, dt, solver="GeneralizedAlpha", law="both", fresh=True):
    """March a scene.

    Parameters
    ----------
    scene, t_end, save_every, start : as in `studies.peers.problem.problem`
    dt : float [s], step, shortened to divide what is saved
    solver : "GeneralizedAlpha", or "VelocityVerlet" or "RK44" where no point is driven
    law : "both" for springs that push as they pull, "pull" for springs that only pull; dampers always act
    fresh : bool, a new Jacobian for each step instead of one kept while it serves

    Returns
    -------
    Outcome
    """
    raise_if_refused(refuses(scene))
    if solver not in ("GeneralizedAlpha", *LIMITS):
        raise InputError(f"Argument `solver` must be one of GeneralizedAlpha, {', '.join(LIMITS)}, but it is {shown(solver)}.")
    if law not in LAWS:
        raise InputError(f"Argument `law` must be one of {', '.join(LAWS)}, but it is {shown(law)}.")
    import exudyn

    began = time.perf_counter()
    task = problem(scene, t_end, save_every, start)
    if solver in LIMITS and task.driven:
        raise InputError(f"Solver {solver} of EXUDYN takes no constraints, but the scene has driven points.")
    model, times = task.model, task.t
    # the symbolic functions must live as long as the system that calls them, the container as long as the system
    container, system, sensors, functions = _system(exudyn, task, law)
    options = _options(exudyn, task, dt, fresh)
    spoke, exudyn.config.printToConsole = exudyn.config.printToConsole, False
    ready, cpu = time.perf_counter(), time.process_time()
    try:
        done = system.SolveDynamic(options, solverType=getattr(exudyn.DynamicSolverType, solver), showCausingItems=False)
    except (RuntimeError, ValueError):
        done = False
    finally:
        ended, cpu = time.perf_counter(), time.process_time() - cpu
        exudyn.config.printToConsole = spoke
    q = np.tile(task.q, (len(times), 1, 1))
    for name, sensor in sensors.items():
        rows = system.GetSensorStoredData(sensor)[: len(times)]
        q[: len(rows), model.node(name)] = rows[:, 1:]
        q[len(rows) :, model.node(name)] = np.nan
    del container, functions
    message = "" if done else f"EXUDYN did not converge, even with its step cut to dt/{HALVINGS}, or met numbers too large."
    return task.outcome(q, ended - ready, ready - began, message, cpu)


def _system(exudyn, task, law):
    """Its system, assembled, with a sensor for each point by name, and what must be kept alive for it."""
    from exudyn import itemInterface as items

    model, scene = task.model, task.model.scene
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    origin = system.AddNode(items.NodePointGround())
    origin = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=origin, coordinate=0))
    nodes, markers, functions = [], [], []
    for i, position in enumerate(task.q.tolist()):
        moves, mass = i < model.n_free or i in task.driven, float(model.mass[i])
        if moves:
            node = system.AddNode(items.NodePoint(referenceCoordinates=position, initialVelocities=task.v[i].tolist()))
            system.AddObject(items.MassPoint(mass=mass, nodeNumber=node))
        else:
            node = system.AddNode(items.NodePointGround(referenceCoordinates=position))
        nodes.append(node)
        markers.append(system.AddMarker(items.MarkerNodePosition(nodeNumber=node)))
        if i < model.n_free:
            system.AddLoad(items.Force(markerNumber=markers[i], loadVector=(mass * scene.gravity).tolist()))
        for axis in range(3 if i in task.driven else 0):
            marker = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=axis))
            functions.append(_drive(exudyn, system, [origin, marker], _offset(exudyn, task, i, axis)))
    for (a, b, L0, k, c), cable in zip(task.segments, model.cable_of, strict=True):
        pull = law == "pull" and scene.cables[cable].compression != "linear"
        functions.append(_segment(exudyn, system, [markers[a], markers[b]], L0, k, c, pull))
    sensors = {}
    for point in scene.points:
        kind, node = exudyn.OutputVariableType.Position, nodes[model.node(point.name)]
        sensor = items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=kind)
        sensors[point.name] = system.AddSensor(sensor)
    system.Assemble()
    return container, system, sensors, functions


def _options(exudyn, task, dt, fresh):
    """Its settings: no files, no words."""
    options = exudyn.SimulationSettings()
    every, saves = float(task.t[1] - task.t[0]), len(task.t) - 1
    steps = saves * max(1, int(np.ceil(every / dt - 1e-9)))
    marching = options.timeIntegration
    marching.endTime, marching.numberOfSteps = every * saves, steps
    marching.minimumStepSize = every * saves / steps / HALVINGS
    marching.newton.relativeTolerance = marching.newton.absoluteTolerance = TOLERANCE
    marching.newton.modifiedNewtonJacUpdatePerStep = fresh
    marching.generalizedAlpha.spectralRadius = RHO_INF
    marching.verboseMode = 0
    options.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    options.solution.file.write = False
    options.solution.sensors.writePeriod = every
    return options


def _segment(exudyn, system, markers, L0, k, c, pull):
    """Add a spring-damper; returns the symbolic law of one that only pulls."""
    from exudyn.advancedUtilities import CreateSymbolicUserFunction
    from exudyn.itemInterface import ObjectConnectorSpringDamper as SpringDamper

    law, larger = 0, exudyn.symbolic.max
    if pull:

        def tension(mbs, t, itemNumber, deltaL, deltaL_t, stiffness, damping, force):
            return larger(stiffness * deltaL, 0.0) + damping * deltaL_t

        law = CreateSymbolicUserFunction(system, tension, "springForceUserFunction", itemTypeName="ObjectConnectorSpringDamper")
    values = {"referenceLength": L0, "stiffness": k, "damping": c}
    system.AddObject(SpringDamper(markerNumbers=markers, springForceUserFunction=law, **values))
    return law


def _drive(exudyn, system, markers, offset):
    """Hold a coordinate to a function of time; returns the symbolic function."""
    from exudyn.advancedUtilities import CreateSymbolicUserFunction
    from exudyn.itemInterface import ObjectConnectorCoordinate

    law = CreateSymbolicUserFunction(system, offset, "offsetUserFunction", itemTypeName="ObjectConnectorCoordinate")
    system.AddObject(ObjectConnectorCoordinate(markerNumbers=markers, offsetUserFunction=law))
    return law


def _offset(exudyn, task, node, axis):
    """Displacement of a driven point along an axis, as a function that can be traced: the pieces of its path and its sine."""
    path, t0, at = task.driven[node], float(task.t[0]), float(task.q[node, axis])
    choose, sin = exudyn.symbolic.IfThenElse, exudyn.symbolic.sin

    def offset(mbs, t, itemNumber, lOffset):
        value = 0.0 * t + float(path.coefficients[0, 0, axis])
        for begins, row in zip(path.breaks.tolist(), path.coefficients[:, :, axis].tolist(), strict=True):
            tau, piece = t + (t0 - begins), 0.0 * t
            for factor in reversed(row):
                piece = piece * tau + factor
            value = choose(tau >= 0.0, piece, value)
        if path.sine is not None and path.sine.amplitude[axis]:
            amplitude, omega, phase, ramp = path.sine
            swing = amplitude[axis] * sin(omega * (t + t0) + phase)
            if ramp:
                s = (t + t0) * (1.0 / ramp)
                swing = choose(s >= 1.0, swing, swing * smoothstep(s)[0])
            value = value + swing
        return value - at

    return offset
