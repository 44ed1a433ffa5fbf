"""The row of a segment: what is written by name is read by column, and by name again."""

import numpy as np
from numba import njit

from anet_lumped.mechanics.segment_row import LinearisedSegment, SegmentHistory, load_history, store_linearised
from anet_lumped.model import tables

ROW = LinearisedSegment(*map(float, range(1, 1 + tables.SEGMENT_COLUMNS)))
COLUMNS = {
    "ex": tables.SEGMENT_DIRECTION,
    "gx": tables.SEGMENT_GRADIENT,
    "geometric": tables.SEGMENT_GEOMETRIC,
    "stiffness": tables.SEGMENT_STIFFNESS,
    "tension": tables.SEGMENT_TENSION,
    "stretch_before": tables.SEGMENT_STRETCH_BEFORE,
    "stretch": tables.SEGMENT_STRETCH,
    "conservative": tables.SEGMENT_CONSERVATIVE,
    "last_change": tables.SEGMENT_LAST_CHANGE,
    "numerical_damper": tables.SEGMENT_NUMERICAL_DAMPER,
}


@njit
def write_and_read(segment, row):
    store_linearised(segment, tables.SEGMENT_COLUMNS, row)
    return load_history(segment, tables.SEGMENT_COLUMNS)


def test_a_row_is_read_by_the_columns_it_was_written_to():
    segment = np.zeros((3, tables.SEGMENT_COLUMNS))
    history = write_and_read(segment.ravel(), ROW)
    assert (segment[[0, 2]] == 0.0).all()
    assert tuple(segment[1]) == tuple(ROW)
    assert {name: segment[1, column] for name, column in COLUMNS.items()} == {name: getattr(ROW, name) for name in COLUMNS}
    assert history == SegmentHistory(ROW.stretch_before, ROW.stretch, ROW.last_change, ROW.numerical_damper)
