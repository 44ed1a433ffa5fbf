"""MoorDyn itself beside a test, with a file of which nothing is driven."""

from contextlib import contextmanager

import pytest

from studies.peers.moordyn import silence


@contextmanager
def begun(file):
    """MoorDyn's module and an engine that has begun with a file; silent. The test is skipped where MoorDyn is not installed."""
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    with silence():
        engine = moordyn.Create(str(file))
        try:
            moordyn.Init(engine, [], [])
            yield moordyn, engine
        finally:
            moordyn.Close(engine)


def march(moordyn, engine, t_end, apart):
    """March an engine from the start for a time [s], by calls that are so far apart [s]."""
    for k in range(round(t_end / apart)):
        moordyn.Step(engine, [], [], apart * k, apart)


def places_of_points(file, t_end, numbers):
    """Places (3,) [m] of points, by their numbers in the file, after a time [s]."""
    with begun(file) as (moordyn, engine):
        march(moordyn, engine, t_end, 0.01)
        return [moordyn.GetPointPos(moordyn.GetPoint(engine, number)) for number in numbers]


def nodes_of_line(moordyn, engine, segments):
    """Places (segments + 1, 3) [m] of the nodes of the first line."""
    line = moordyn.GetLine(engine, 1)
    return [moordyn.GetLineNodePos(line, i) for i in range(segments + 1)]
