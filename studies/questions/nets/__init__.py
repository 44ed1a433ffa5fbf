"""What does a large net cost: the linear system of its junctions, its rest, and its motion beside other engines?

The junctions of a net are eliminated by fronts, see `model.fronts`; SuperLU, which scipy has, factors the same matrix. At rest a
net hangs by its corners, in air and in a current. It moves from the rest that it has in a tilted gravity; errors are those of all
points at all saved times, against an explicit method of order 8 with a far smaller tolerance. Times are the processor's.
"""

from studies.questions.nets.figures import plot
from studies.questions.nets.tables import compute
from studies.questions.nets.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.COST,
    first_look="nets of up to 20 by 20 points in place of 100 by 100, and a moved one of 10 by 10 in place of 30 by 30.",
    compares_times=True,
)
TABLES = {
    "solves": "A line for each size of a net and each way to solve for its junctions: medians of the processor's times.",
    "rests": "A line for each size of a net, in air and in a current: the processor's time of its rest.",
    "motions": "A line for each engine and setting: largest error of all points, and the processor's time of the march.",
}
