"""At which steps, stiffnesses and dampers is each scheme stable, and why did the thesis's model fail when it was improved?

Two planes, (step, stiffness) and (step, damper), measured cell by cell for eleven schemes and drawn under the border that
`anet_lumped.motion.stability` predicts before any run. The judge is the energy, which nothing puts in here, so that it may
only fall: surviving to the end is not enough.
"""

from studies.questions.stability_map.figures import plot
from studies.questions.stability_map.planes import compute
from studies.questions.stability_map.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.WHY,
    first_look="every plane has 6 x 6 cells in place of 11 x 11, and the borders are measured at one stiffness in place "
    "of three and at two dampers in place of three.",
)
TABLES = {
    "planes": "A line for each cell of the two planes and each scheme: step, predicted limit, and what the energy did.",
    "borders": "A line for each explicit scheme, stiffness and damper: the largest stable step, over the predicted one.",
    "long_whip": "A line for each scheme, share of its limit and damping ratio: the rise of energy in a longer whip.",
    "thesis": "A line for each scheme and each change that the thesis tried: the limit, and what the energy about rest did.",
}
