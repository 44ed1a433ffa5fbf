"""What does each of the thesis's three models of the net cost, and how far is each from the right answer?

Table 5.2 of the thesis compares energy optimisation by sampling, the lumped masses and the links of a physics engine in words. Here
they find the same nets at rest, carried and flown, and the numbers stand side by side; so do the thesis's two root finders for the
catenary and that of this library.
"""

from studies.questions.three_models.figures import plot
from studies.questions.three_models.tables import compute
from studies.questions.three_models.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.COST,
    first_look="all nets at rest, but two motions in place of six, fewer brackets and poses, rigid links at steps of 4 ms alone, "
    "and a reference of cables of 16 and 32 segments in place of 20 and 40.",
    compares_times=True,
)
TABLES = {
    "rest": "A line for each net, load and model at rest: p0's distance from the elastic catenaries', and times.",
    "motions": "A line for each motion and model: p0's largest distance from the reference, times, and the change of energy.",
    "turns": "A line for each turn in which edmc and the rigid links were timed one after the other, a second of motion of each.",
    "steps": "A line for each method: its largest stable step in one motion, and how that is known.",
    "roots": "A line for each cable, bracket and root finder: iterations, the root, and why there is none.",
    "starts": "A line for each cable and start of a search without a bracket: where it ended.",
}
