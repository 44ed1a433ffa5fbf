"""Two effects of the user's own: the downwash of the four quadrotors that hold the net, and a magnet under what lies in it.

A hovering rotor of disc area A that carries a weight W blows air down at sqrt(2 W/(rho A)) far below it, in a jet of half its
area (momentum theory; Leishman, Principles of Helicopter Aerodynamics, 2nd ed. (2006), 2.2); the jet is given a smooth edge here.
Run it: python examples/own_effect.py
"""

import math

from anet_lumped import Cable, Fixed, Free, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity, node_energy, node_force

CORNERS = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
JET = math.sqrt(2 * 1.04 * 9.81 / (1.225 * 0.2)), math.sqrt(0.1 / math.pi)  # speed [m/s], radius [m] of 1.04 kg on 0.2 m2


@node_force
def downwash(t, q, v, area, at, speed, radius, density=1.225, Cd=1.2):
    """Drag on a node in the jets of air that blow down from the four corners of a square about the z axis."""
    x, y = abs(q[0]) - at[0], abs(q[1]) - at[1]
    below = 1.0 if q[2] <= at[2] else 0.0
    wind = -below * speed * math.exp(-((x * x + y * y) ** 2) / radius**4)
    ux, uy, uz = -v[0], -v[1], wind - v[2]
    push = 0.5 * density * Cd * area * math.sqrt(ux * ux + uy * uy + uz * uz + 1e-12)
    return push * ux, push * uy, push * uz


@node_energy
def magnet(t, q, strength, at):
    """A magnet far enough away to be a dipole."""
    x, y, z = q[0] - at[0], q[1] - at[1], q[2] - at[2]
    return -strength / (x * x + y * y + z * z) ** 1.5


def net(*effects):
    """The four cables, a bottle where they meet, and what acts on them."""
    cables = [
        Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.05, EA=1e4, zeta=0.05, segments=20, diameter=0.009) for i in range(4)
    ]
    points = [Fixed(f"s{i}", at) for i, at in enumerate(CORNERS)]
    return Scene([*points, Free("p0", mass=0.036)], cables, [Gravity(), *effects])


blown = downwash(at=CORNERS[2], speed=JET[0], radius=JET[1])
pulled = magnet(strength=0.02, at=(0.1, 0.0, -1.0), points=["p0"])
acting = {"weight alone": (), "downwash": (blown,), "magnet": (pulled,)}
rest = {name: equilibrium(net(*effects)) for name, effects in acting.items()}
run = simulate(net(blown, pulled), t_end=1.0, start=rest["weight alone"], method="edmc", dt=0.005)

if __name__ == "__main__":
    for name, state in rest.items():
        print(f"{name}: p0 rests at {state.position('p0').round(4)} m, s0-p0 pulls {state.tension('s0-p0')[0]:.3f} N at its corner")
    print(f"both at once, from there: {run.status}, {run.work}; p0 ends at {run.final.position('p0').round(4)} m")
