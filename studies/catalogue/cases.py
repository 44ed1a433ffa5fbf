"""All cases of the catalogue by name, and what the catalogue must cover."""

from studies.catalogue import falls, flights, silent, supports, surroundings, swings

CASES = swings.CASES | supports.CASES | falls.CASES | flights.CASES | surroundings.CASES | silent.CASES
"""Names of cases -> functions that make them."""

REQUIRED = {
    "EA from 1e2 to 1e9 N and inf": ("swing, EA", "whip, EA", "net, EA"),
    "dampers from zeta 0 to 1e4": ("swing, zeta", "whip, zeta 10000"),
    "5 to 10,000 segments": ("swing, 5 segments", "swing, 100 segments", "swing, 1000 segments", "swing, 10000 segments"),
    "payloads from 1e-3 to 1e6 times a node's mass": ("swing, payload",),
    "quadrotor masses at the ends": ("quadrotors",),
    "every law of compression": ("swing, compression",),
    "tension that follows a curve": ("climber's fall, stiffening", "climber's fall, yielding"),
    "taut, and near-taut by 1e-9": ("span,",),
    "hairpin, coincident supports": ("hairpin settles", "coincident supports", "settles as a catenary"),
    "slack turning taut": ("slack snaps at 10 m/s", "quadrotors apart", "climber's fall"),
    "snap loads whose first peak is v sqrt(EA mu)": ("slack snaps at 10 m/s", "yanked at 1 m/s", "stops dead at 10 m/s"),
    "a random crumple": ("crumple settles", "heap, crumple"),
    "nodes on top of each other": ("heap on one spot", "coincident supports", "climber's fall"),
    "a falling folded chain, and a falling chain's tip": ("folded chain falls", "tip of a U falls"),
    "no gravity, gravity turned round": ("ring in free turn", "cable in free flight", "quadrotors apart", "gravity upwards"),
    "supports that jump in velocity, stop dead, shake at the axial frequency, start at 5 m/s": (
        "yanked at 1 m/s", "stops dead at 10 m/s", "support stops midway", "shaken at resonance", "starts at 5 m/s",
    ),
    "a payload dropped or picked up, at rest and in mid-run": (
        "payload dropped", "payload picked up", "payload halved", "payload doubled",
    ),
    "steps of 0.1 s": ("net, steps of 0.1 s", "whip, steps of 0.1 s"),
    "an hour of swing": ("hour of swing",),
    "a loop of cables": ("ring in free turn",),
    "a net of 10 by 10 meshes": ("net 10 x 10",),
    "into and out of water at 2 m/s": ("water,",),
    "a gust on a slack cable": ("gust on a slack cable",),
    "drag much larger than weight": ("drag beyond weight",),
    "bending so stiff that it dominates": ("bending dominates",),
    "a falling chain on the ground": ("chain onto the ground",),
    "a cable breaking under load": ("a cable of a net breaks",),
    "pay-out to zero tension": ("paid out,",),
    "a string whose tension sets the pace, a slack damper, a fall with a closed form": (
        "plucked string", "weight on a slack damper", "climber's fall, massless rope",
    ),
    "a cable that is joined to nothing": ("cable in free flight", "swing and a cable apart"),
}  # fmt: skip
"""What the catalogue must cover -> how the names of the cases that cover it begin."""
