"""A payload that swings on a cable: any stiffness, damper, number of segments and payload, coarse steps, an hour long.

Released from `ANGLE` with the very stretch that its tension gives it, so that nothing rings. As a rod with a mass at its end
it passes the lowest position with omega^2 = 2 g (1 - cos a) (M + m/2)/((M + m/3) L) and there pulls its support with
(M + m) g + (M + m/2) omega^2 L.
"""

import math
from dataclasses import replace

import numpy as np

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, State, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.results.state import segment_tensions
from studies.catalogue.case import ACCURACY, LOAD, MOMENTUM, Case, Statement, at_time, largest_tension, position_at_end

G, ANGLE = 9.81, math.radians(30.0)


def pendulum(*, EA=1e4, zeta=0.05, segments=20, payload=0.1, mu=0.01, compression="none"):
    """A metre of cable under a support, with a payload [kg]."""
    cable = Cable(
        "a", "b", length=1.0, mass_per_length=mu, EA=EA, zeta=zeta, segments=segments, compression=compression
    )  # fmt: skip
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=payload)], [cable], [Gravity(G)])


def released(scene, angle):
    """State of a scene at rest, turned by an angle about its support with the tensions that it has at once when let go.

    At rest under g cos(angle) along the turned cable: all forces along it are in balance.
    """
    aside = Gravity(G * math.cos(angle), (math.sin(angle), 0.0, -math.cos(angle)))
    return equilibrium(replace(scene, effects=(aside,)))


def rod_tension(scene, angle):
    """Pull of the swinging rod with a mass on its support at the lowest position [N]; see the module."""
    (cable,), M = scene.cables, scene.point("b").mass
    m, L = cable.length * cable.mass_per_length, cable.length
    square = 2.0 * G * (1.0 - math.cos(angle)) * (M + m / 2) / ((M + m / 3) * L)
    return (M + m) * G + (M + m / 2) * square * L


def swing(description, off=0.1, tolerance=5e-3, **kwargs):
    """A pendulum whose largest tension is that of a rod within `off` of it."""
    scene = pendulum(**kwargs)
    expected = rod_tension(scene, ANGLE)

    def judge(run):
        pull = largest_tension(run) / expected
        yield Statement(LOAD, "largest tension over that of a swinging rod", pull, most=1.0 + off)
        yield Statement(ACCURACY, "largest tension over that of a swinging rod", pull, least=1.0 - off)
        (cable,) = scene.cables
        bound = cable.length * (1.0 + (1.0 + off) * expected / cable.EA + 1e-7)  # and Newton's tolerance, where it cannot stretch
        yield Statement(LOAD, "length of the cable", run.length("a-b").max(), most=bound, unit="m")

    return Case(
        description,
        scene,
        0.8,
        judge,
        start=lambda: released(scene, ANGLE),
        measure=lambda run: run.position("b")[-1],
        tolerance=tolerance,
    )


def loose_end(EA, zeta=0.0, dt=None):
    """No payload, released level, without any damper or with a very stiff one: a whip.

    Nothing pulls a node faster than all the energy of the fall allows, nor tightens a segment by more.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=EA, zeta=zeta, segments=20)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], [Gravity(G)])
    model = build(scene)
    fall = 0.1 * G * 1.0  # at most, [J]: the whole cable a metre down, and what it stretches is lifted by
    bound = fall * (1.0 + math.sqrt(2.0 * fall / EA))

    def judge(run):
        if math.isfinite(EA) and not zeta:  # a damper pulls as hard as it has to
            most = math.sqrt(2.0 * cable.stiffness * bound)
            yield Statement(LOAD, "largest tension", largest_tension(run), most=1.05 * most, unit="N")
        kinetic = run.energy[:, 0].max()
        yield Statement(LOAD, "largest kinetic energy", kinetic, 0.1 * fall, 1.05 * bound, unit="J")
        deepest = -run.q[:, : model.n_free, 2].min()
        yield Statement(LOAD, "depth", deepest, 0.9, 1.0 + 1e-7 + math.sqrt(2.0 * bound / EA), unit="m")

    return Case(
        f"A whip with zeta = {zeta:g} at EA = {EA:.0e} N" + (f" and steps of {dt:g} s" if dt else "") + ": no more tension, speed "
        "or depth than the fall pays for.", scene, 1.2, judge, start="straight", dt=dt, step_is_given=dt is not None,
        measure=at_time(0.4, lambda run: run.position("b")), tolerance=0.05 if dt else 0.01,
    )  # fmt: skip


def net(EA, dt=None, **kwargs):
    """The thesis's net of four cables, carried off at 0.2 m/s; p0 stays near the middle of its corners."""
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    points = [Driven(f"s{i}", paths.line(at, (0.2, 0.0, 0.0), ramp=1.0)) for i, at in enumerate(corners)]
    cables = [
        Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=EA, segments=20, **({"zeta": 0.05} | kwargs)) for i in range(4)
    ]
    scene = Scene([*points, Free("p0", mass=0.036)], cables, [Gravity(G)])

    def judge(run):
        middle = np.mean([run.position(f"s{i}") for i in range(4)], axis=0)
        aside = run.position("p0") - middle
        # quasi-static lag a/g of the depth 0.71 m at the largest acceleration 1.875 v/ramp, and twice that when it rings
        sway = np.abs(aside[:, 0]).max()
        yield Statement(LOAD, "sway of p0", sway, 0.005, 0.06, unit="m")
        yield Statement(LOAD, "drift of p0 across", np.abs(aside[:, 1]).max(), most=1e-6, unit="m")
        rest = equilibrium(scene)
        still = max(rest.tension(cable.name).max() for cable in scene.cables)
        yield Statement(LOAD, "largest tension over that at rest", largest_tension(run) / still, 0.99, 1.25)

    return Case(
        f"The net carried off at EA = {EA:.0e} N" + (f" with steps of {dt:g} s" if dt else "") + ": p0 sways and does no more.",
        scene,
        4.0,
        judge,
        dt=dt,
        step_is_given=dt is not None,
        measure=lambda run: run.position("p0")[-1],
        tolerance=0.01 if dt else 1e-3,
    )


def hour():
    """An hour of swing: neither lost nor gained, and on time."""
    scene = pendulum(EA=200.0, zeta=0.0, segments=2)
    angle = math.radians(10.0)
    fall = float(0.1 * G * (1.0 - math.cos(angle)))

    def judge(run):
        x = run.position("b")[:, 0]
        last = run.t > 3580.0
        energy = run.energy[:, :3].sum(axis=1)
        yield Statement(LOAD, "reach of the swing in the last 20 s", np.abs(x[last]).max(), most=1.01 * np.abs(x[0]), unit="m")
        yield Statement(ACCURACY, "swing's energy lost in an hour over all of it", (energy[0] - energy[-1]) / fall, -0.1, 0.25)
        crossings = np.count_nonzero(np.diff(np.sign(x)))
        yield Statement(ACCURACY, "swings in an hour over those of a rod", crossings / 2 / rod_swings(scene, angle), 0.99, 1.01)

    return Case(
        "An hour of swing of 10 degrees without dampers: it neither dies nor grows, and keeps time.", scene, 3600.0, judge,
        start=lambda: released(scene, angle), save_every=0.2,
        measure=lambda run: run.energy[-1, :3].sum() / fall, tolerance=0.1, unit="",
    )  # fmt: skip


def rod_swings(scene, angle):
    """Swings in an hour of the rod with a mass, lengthened by its load: T = 2 pi sqrt(I/(S g)) (1 + a^2/16 + ...)."""
    (cable,), M = scene.cables, scene.point("b").mass
    m, L = cable.length * cable.mass_per_length, cable.length
    L *= 1.0 + (M + m / 2) * G / cable.EA
    period = 2 * math.pi * math.sqrt((M + m / 3) * L / ((M + m / 2) * G)) * (1 + angle**2 / 16 + 11 * angle**4 / 3072)
    return 3600.0 / period


def changed_payload(before, after):
    """At rest with one payload, which another takes the position of: dropped or picked up.

    From rest under one load to another: the pull overshoots its new value by no more than the change (the sudden load's
    factor of two), and the end comes to hang where the new load puts it.
    """
    scene = replace(pendulum(payload=before, zeta=1.0), events=(PayloadChange("b", 0.0, after),))

    def judge(run):
        low, high = (float(equilibrium(pendulum(payload=p, zeta=1.0)).tension("a-b").max()) for p in sorted((before, after)))
        if after > before:
            most = 2.0 * high - low
        else:
            most = high
        yield Statement(LOAD, "largest tension", largest_tension(run), most=1.02 * most, unit="N")
        mean = run.position("b")[run.t > 1.0, 2].mean()
        yield Statement(LOAD, "mean height of the end after 1 s", mean, -1.0 - 2e-3, -1.0 + 0.3, unit="m")
        aside = np.abs(run.position("b")[:, :2]).max()
        yield Statement(MOMENTUM, "way of the end to the side", aside, most=1e-9, unit="m")

    return Case(
        f"A payload of {before:g} kg at rest becomes {after:g} kg: no more pull than a sudden load.", scene, 2.0, judge,
        measure=lambda run: run.position("b")[run.t > 1.0].mean(axis=0), tolerance=0.02,
    )  # fmt: skip


def centre_of_mass(run):
    """Centre of mass of what moves (k, 3) [m]."""
    free = slice(0, run.model.n_free)
    return np.average(run.q[:, free], axis=1, weights=run.model.mass[free])


def changed_midway(before, after):
    """A payload let go, or picked up at the speed of the end, in the middle of a swing.

    No more energy than at the change: neither its weight is lifted higher nor the end driven deeper than that pays for, and all
    of it in one segment pulls with sqrt(2 k E).
    """
    scene = pendulum(payload=after, zeta=1.0)
    first = pendulum(payload=before, zeta=1.0)
    (cable,) = scene.cables
    mass = after + cable.length * cable.mass_per_length

    def start():
        return simulate(first, 0.35, method="edmc", dt=1e-3, start=released(first, ANGLE)).final

    def judge(run):
        lowest = -(after + 0.5 * cable.mass_per_length * cable.length) * G * (1.0 + mass * G / cable.EA)
        total = run.energy[0, :3].sum() - lowest
        pull = math.sqrt(2.0 * cable.stiffness * total)
        spring = cable.stiffness * (np.linalg.norm(np.diff(run.shape("a-b"), axis=1), axis=2) - cable.L0).max()
        yield Statement(LOAD, "largest spring force over what all the energy in one segment gives", spring / pull, 0.0, 1.01)
        yield Statement(LOAD, "largest kinetic energy over all of it", run.energy[:, 0].max() / total, 0.3, 1.01)
        deepest = -run.q[:, :, 2].min()
        most = 1.0 + math.sqrt(2.0 * total / cable.EA) + mass * G / cable.EA + 1e-6
        yield Statement(LOAD, "depth", deepest, 0.9, most, unit="m")
        if after:
            top = run.position("b")[:, 2].max()
            paid = run.position("b")[0, 2] + run.energy[0, 0] / (after * G)
            yield Statement(LOAD, "greatest height of the payload over what its speed pays for", top - paid, most=2e-3, unit="m")
        yield Statement(MOMENTUM, "way out of the plane", np.abs(run.q[:, :, 1]).max(), most=1e-9, unit="m")

    return Case(
        f"In mid-swing a payload of {before:g} kg becomes {after:g} kg: no more energy than there is.", scene, 1.0, judge,
        start=start, tolerance=0.01,
        measure=at_time(0.5, lambda run: run.position("b")) if after else at_time(0.05, centre_of_mass),  # the end recoils
    )  # fmt: skip


def changed_in_swing(before, after):
    """A payload that another one joins, at rest, or is dropped in part, at the lowest position of a swing.

    As a rod with a mass at its end, I the moment of inertia about the support: what is picked up leaves omega I/(I + m L^2), what
    is dropped leaves omega. From there the rod swings up to 1 - cos(a) = I omega^2/(2 g (M + mu L/2) L).
    """
    scene = pendulum(payload=before)
    (cable,) = scene.cables
    L, m = cable.length, cable.length * cable.mass_per_length
    quarter = 900.0 / rod_swings(scene, ANGLE)  # a quarter of a period [s]
    square = 2.0 * G * (1.0 - math.cos(ANGLE)) * (before + m / 2) * L
    inertia = [(payload + m / 3) * L**2 for payload in (before, after)]
    square /= inertia[0]
    if after > before:
        square *= (inertia[0] / inertia[1]) ** 2
    angle = math.acos(1.0 - inertia[1] * square / (2.0 * G * (after + m / 2) * L))
    eventful = replace(scene, events=(PayloadChange("b", quarter, after),))

    def judge(run):
        x, _, z = run.position("b").T
        reach = math.degrees(np.arctan2(-x, -z)[run.t > quarter].max())
        # the joint body passes its momentum on to a cable of a tenth of its mass by a wave, of which some keeps running
        yield Statement(ACCURACY, "reach of the swing after that over that of a rod", reach / math.degrees(angle), 0.99, 1.01)

    return Case(
        f"A payload of {before:g} kg becomes {after:g} kg in mid-swing: the swing goes on as the momentum says.", eventful,
        3.0 * quarter, judge, start=lambda: released(scene, ANGLE), measure=position_at_end("b"), tolerance=5e-3,
    )  # fmt: skip


def turned_round():
    """Gravity upwards is the mirror image of gravity downwards, to rounding."""
    scene = pendulum()
    up = replace(scene, effects=(Gravity(G, (0.0, 0.0, 1.0)),))

    def start():
        state = released(scene, ANGLE)
        q = state.q * (1.0, 1.0, -1.0)
        return State(build(up), 0.0, q, np.zeros_like(q), segment_tensions(build(up), q, np.zeros_like(q)))

    def judge(run):
        x, _, z = run.position("b").T
        tilt = math.atan(np.abs(x).max() / z[np.abs(x).argmax()])
        yield Statement(LOAD, "lowest height of the payload", z.min(), least=math.cos(ANGLE) * 0.999, unit="m")
        yield Statement(LOAD, "largest tilt over that at the start", tilt / ANGLE, 0.999, 1.001)
        rod = rod_tension(scene, ANGLE)
        yield Statement(LOAD, "largest tension over that of a swinging rod", largest_tension(run) / rod, 0.9, 1.1)

    return Case(
        "Gravity points up: the same swing upside down.", up, 0.8, judge, start=start, measure=position_at_end("b"), tolerance=5e-3
    )


STIFFNESSES = (1e2, 1e4, 1e7, 1e9, math.inf)  # EA [N]
ZETAS = (0.0, 1.0, 1e2, 1e4)
SEGMENTS = (5, 100, 1000, 10_000)
PAYLOADS = (1e-3, 1.0, 1e3, 1e6)  # times a node's mass, of 0.5 g
NODE = 0.01 / 20  # [kg]


def _cases():
    cases = {}
    for EA in STIFFNESSES:
        cases[f"swing, EA {EA:.0e} N"] = lambda EA=EA: swing(
            f"EA = {EA:.0e} N: the pull of a swinging rod.", EA=EA, off=0.1 if EA > 1e2 else 0.15
        )  # fmt: skip
        cases[f"whip, EA {EA:.0e} N"] = lambda EA=EA: loose_end(EA)
    for zeta in ZETAS:
        cases[f"swing, zeta {zeta:g}"] = lambda zeta=zeta: swing(
            f"Dampers of zeta = {zeta:g} in every segment do not touch the swing.", zeta=zeta
        )  # fmt: skip
    cases["whip, zeta 10000"] = lambda: loose_end(1e4, zeta=1e4)
    cases["whip, steps of 0.1 s"] = lambda: loose_end(1e6, dt=0.1)
    for n in SEGMENTS:
        cases[f"swing, {n} segments"] = lambda n=n: swing(f"{n} segments: the pull of a swinging rod.", segments=n)
    for ratio in PAYLOADS:
        cases[f"swing, payload {ratio:.0e} nodes"] = lambda ratio=ratio: swing(
            f"A payload of {ratio:g} times a node's mass: the pull of a swinging rod.",
            payload=ratio * NODE, EA=max(1e4, 1e3 * ratio * NODE * G), off=0.1 if ratio > 100 else 0.5,
        )  # fmt: skip
    for law in ("damped", "linear"):
        cases[f'swing, compression "{law}"'] = lambda law=law: swing(f'compression="{law}".', compression=law)
    for EA in (1e4, 1e6):
        cases[f"net, EA {EA:.0e} N"] = lambda EA=EA: net(EA)
    cases["net, steps of 0.1 s"] = lambda: net(1e6, dt=0.1)
    cases["hour of swing"] = hour
    cases["payload dropped"] = lambda: changed_payload(1.0, 0.0)
    cases["payload picked up"] = lambda: changed_payload(0.0, 1.0)
    cases["payload halved in mid-swing"] = lambda: changed_in_swing(0.2, 0.1)
    cases["payload doubled in mid-swing"] = lambda: changed_in_swing(0.1, 0.2)
    cases["payload dropped in mid-swing"] = lambda: changed_midway(1.0, 0.0)
    cases["payload picked up in mid-swing"] = lambda: changed_midway(0.0, 1.0)
    cases["gravity upwards"] = turned_round
    return cases


CASES = _cases()
