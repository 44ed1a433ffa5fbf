"""Do the input files of others run unchanged, and to MoorDyn's numbers?

Each file is read, brought to rest and moved: its coupled points surge by 1 m and heave by 0.5 m at 0.1 Hz. Tensions at both ends of
each line are set beside those of MoorDyn, where it is installed. What accuracy costs is asked of some of the files.
"""

from studies.questions.moorings.figures import plot
from studies.questions.moorings.tables import compute
from studies.questions.moorings.words import answer
from studies.study import Part, Record

__all__ = ["STUDY", "TABLES", "answer", "compute", "plot"]

STUDY = Record(
    question=__doc__.splitlines()[0],
    part=Part.MEASURED,
    first_look="the decks that the project writes itself, moved for a shorter time, and what accuracy costs on one of them.",
    compares_times=True,
    data="of MoorDyn input files (*.txt, *.dat), in place of the small ones that the study writes itself",
)
TABLES = {
    "decks": "A line for each file: whether it is read, rests and moves, and how far its tensions are from MoorDyn's.",
    "cost": "A line for each file, code, setting and tolerance: error over the range of the tension, and processor time.",
}
