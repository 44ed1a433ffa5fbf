"""A segment's row of ``Net.segment``: its linearised tension, and numbers that its next linearisation reads."""

from typing import Any, NamedTuple

from anet_lumped.compiled.jit import inlined
from anet_lumped.compiled.lanes import load, load_four, shifted, store, store_four
from anet_lumped.model.tables import (
    SEGMENT_DIRECTION,
    SEGMENT_LAST_CHANGE,
    SEGMENT_NUMERICAL_DAMPER,
    SEGMENT_STRETCH,
    SEGMENT_STRETCH_BEFORE,
    SEGMENT_TENSION,
)


class SegmentHistory(NamedTuple):
    """Numbers in a segment's row of ``Net.segment`` that its next linearisation reads; `LinearisedSegment` says what they are."""

    stretch_before: Any
    stretch: Any
    last_change: Any
    numerical_damper: Any


class LinearisedSegment(NamedTuple):
    """A segment's row of ``Net.segment``, in the order of its columns in `tables`.

    Parameters
    ----------
    ex, ey, ez : direction e in which the tension acts
    gx, gy, gz : gradient g of the length in the displacement of its second node
    geometric : geometric stiffness a [N/m]
    stiffness : slope k [N/m]
    tension : constant part T_0 of the linearised tension [N]
    stretch_before : stretch at the base [m]
    stretch : stretch at the current positions [m]
    conservative : part of the tension by the law that has an energy [N]
    last_change : change of the stretch in the step before [m]
    numerical_damper : numerical damper that acts [N/m]
    """

    ex: Any
    ey: Any
    ez: Any
    gx: Any
    gy: Any
    gz: Any
    geometric: Any
    stiffness: Any
    tension: Any
    stretch_before: Any
    stretch: Any
    conservative: Any
    last_change: Any
    numerical_damper: Any


@inlined
def load_history(segment, row):
    """`SegmentHistory` at the address of a row of ``Net.segment``, flat."""
    stretch, _, last_change, numerical_damper = load_four(segment, shifted(row, 0, 1, SEGMENT_STRETCH))
    return SegmentHistory(load(segment, shifted(row, 0, 1, SEGMENT_STRETCH_BEFORE)), stretch, last_change, numerical_damper)


@inlined
def store_linearised(segment, row, new):
    """Write a `LinearisedSegment` at the address of a row of ``Net.segment``, flat."""
    store_four(segment, shifted(row, 0, 1, SEGMENT_DIRECTION), (new.ex, new.ey, new.ez, new.gx))
    store_four(segment, shifted(row, 0, 1, SEGMENT_DIRECTION + 4), (new.gy, new.gz, new.geometric, new.stiffness))
    store_four(segment, shifted(row, 0, 1, SEGMENT_TENSION), (new.tension, new.stretch_before, new.stretch, new.conservative))
    store(segment, shifted(row, 0, 1, SEGMENT_LAST_CHANGE), new.last_change)
    store(segment, shifted(row, 0, 1, SEGMENT_NUMERICAL_DAMPER), new.numerical_damper)
