"""How far is the model from measured tensions and flights, and from other codes?

A chain in a tank whose driven end makes it go slack and snap, two drones that carry a payload on cables, and a hanging cable for
which other codes have published their tensions. What is fitted is fitted to one part of the measurements and judged by the other.
"""

from studies.questions.measured.figures import plot
from studies.questions.measured.tables import compute
from studies.questions.measured.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.MEASURED,
    first_look="the chain as it is given and as it is fitted, and the sensitivity to six of its numbers in place of all.",
    data="of measured flights, a CSV file for each; the public logs are in IMRCLab/col-trans on GitHub (MIT licence)",
)
TABLES = {
    "chain": "A line for each setting and period: the fairlead's tension beside the measured one, folded on the period.",
    "folded": "A line for each period and phase: the tension measured, as the chain is given, and as it is fitted at 3.5 s.",
    "sensitivity": "A line for each number that is changed alone and each period: what becomes of the tension.",
    "fitted": "A line for each number that is fitted at 3.5 s: its given and its fitted value, and the standard error.",
    "hanging": "A line for each code: tensions of the hanging cable.",
    "flights": "A line for each flight: the payload's distance from where it was measured, of the model and of a guess.",
}
