"""What put the thesis's p0 centimetres off, and what does p0 cost by force balance instead of sampling?

Section 5.1 of the thesis samples p0, draws the catenaries, adds up the potential energy of their points (Eq. 5.1) and
keeps the least. Here Table 5.1 is made again by that method, the cause of its errors is shown, and p0 is found by the
balance of forces, for the table's two cables and for the motion of section 5.1.5.
"""

from studies.questions.thesis_tables.figures import plot
from studies.questions.thesis_tables.tables import compute
from studies.questions.thesis_tables.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.FOUND,
    first_look="up to 100 points of a cable in place of 500 for the cause of the errors, timings in 6 turns in place of 15, and 20 "
    "poses of each motion, whose time is scaled to 400.",
    compares_times=True,
)
TABLES = {
    "table_5_1": "A line for each row of the thesis's Table 5.1: its error and time, and those of the same method made again.",
    "bias": "A line for each number of points of a cable: the error of p0's height that the masses of the points alone make.",
    "energy": "A line for each height of p0: the mean height of a cable's points, which the thesis takes for its energy.",
    "force_balance": "A line for each way to find p0: its error and the median of its times.",
    "turns": "A line for each turn in which sampling and the balances of forces were timed one after the other, in s.",
    "motion": "A line for each net and way: the time of the 400 poses of section 5.1.5, by that of as many as were solved.",
}
