"""How much longer than its cord is the lumped cable, how far is it from the catenary, and why was the thesis's 1.1 m long?

The static shape of a cable of 1 m and 0.1 kg against the inextensible and the elastic catenary, over stiffness and
number of segments; the springs that make it 1.1 m long; and the least stretch that an explicit step leaves possible,
predicted and measured.
"""

from studies.questions.length_error.figures import plot
from studies.questions.length_error.stretch import compute
from studies.questions.length_error.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.FOUND,
    first_look="every third stiffness, cables of up to 20 segments in place of 160, the floor of two arrangements in place of "
    "five, and two stiffnesses in place of five for the cure.",
)
TABLES = {
    "shape": "A line for each arrangement, stiffness and number of segments: stretch at rest, and distance from both catenaries.",
    "springs": "A line for each arrangement: the spring of a segment that makes the cable 1.1 m long, and its largest steps.",
    "refinement": "A line for each number of segments: errors of the sag and of the first frequency that the segments make alone.",
    "floor": "A line for each arrangement, scheme, step and number of segments: least stretch, predicted and measured.",
    "cure": "A line for each scheme, step and stiffness: how far the hung cable stretches as it swings, and what its energy does.",
}
