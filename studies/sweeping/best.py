"""The inputs for which a measure is least or largest, with bounds on other measures, by scipy's differential evolution.

Source: R. Storn and K. Price, J. Global Optim. 11 (1997) 341; J. Lampinen, Proc. CEC 2002, 1468, for constraints.
"""

import contextlib
import logging
import math
import re
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, shown
from anet_lumped.limits import ROWS, check_most
from anet_lumped.scene.scene import Scene
from studies.quantities import amount
from studies.sweeping.batch import BatchRunner, check_budget
from studies.sweeping.folder_lock import locked
from studies.sweeping.row_log import key, line_of, open_log, plain, rows_again, standing
from studies.sweeping.rows import save_table, table_of, with_done
from studies.sweeping.sampling import as_told, read_inputs
from studies.sweeping.sweep import prepared
from studies.sweeping.vary import sizes_of
from studies.sweeping.workers import OwnPool, WorkerError, check_workers, through_executor

LOG = logging.getLogger(__name__)
CONSTRAINT = re.compile(r"\s*(?P<measure>[^<>=\s]+)\s*(?P<sign><=|>=)\s*(?P<bound>\S+)\s*")
PER_INPUT, GENERATIONS = 10, 200  # members of a generation for each input, and generations at most
ALIKE = 1e-3  # of a generation: the spread of the measure over its mean, or of each input over its range, at which it is over


class BestError(InputError):
    """A question for the best that cannot be asked."""


class Constraint(NamedTuple):
    """A bound on a measure: `largest` says whether it is the largest that is allowed, or the least."""

    measure: str
    largest: bool
    bound: float

    def is_met(self, line: dict) -> bool:
        """Whether a line of a row meets it."""
        value = _number(line.get(self.measure))
        return value <= self.bound if self.largest else value >= self.bound

    def __str__(self) -> str:
        bound = repr(self.bound).removesuffix(".0")  # all digits: it is read again
        return f"{self.measure}{'<=' if self.largest else '>='}{bound}"


class _Question(NamedTuple):
    """A measure that is to be small, or ``large``, within bounds on others."""

    measure: str
    large: bool
    bounds: list[Constraint]

    def cost(self, lines: list[dict]) -> np.ndarray:
        """What is to be least, of the lines of rows (s,); infinite of rows that failed."""
        found = [_number(line.get(self.measure)) if line["status"] == "done" else math.nan for line in lines]
        return np.nan_to_num(np.multiply(-1.0 if self.large else 1.0, found), nan=np.inf)

    def excess(self, lines: list[dict]) -> np.ndarray:
        """By how much the lines of rows miss each bound, (bounds, s); at most 0 where it is met."""
        missed = [
            np.multiply(1.0 if bound.largest else -1.0, [_number(line.get(bound.measure)) - bound.bound for line in lines])
            for bound in self.bounds
        ]
        return np.nan_to_num(missed, nan=1e30, posinf=1e30)

    def best_of(self, lines: list[dict]) -> dict | None:
        """The best line that meets all bounds; None if none does."""
        good = [line for line in lines if line["status"] == "done" and all(bound.is_met(line) for bound in self.bounds)]
        good = [line for line in good if math.isfinite(_number(line.get(self.measure)))]
        return (max if self.large else min)(good, key=lambda line: line[self.measure], default=None)


class _AskedRows:
    """Rows that a search asks for, in that order: what is known of them, and how others are done.

    Parameters
    ----------
    inputs : name -> distribution of its values
    lines : of rows that were done before, by their keys; those that are to be done again with this budget are not counted
    budget : float or None [s], that a row may take
    log : where lines go that are done, or None
    do : callable(rows) -> iterator of the number of a row and its result
    """

    def __init__(
        self, inputs: dict[str, Any], lines: dict[str, dict], budget: float | None, log: Any, do: Callable[[list[dict]], Any]
    ) -> None:
        self.inputs, self.names, self.lines, self.log, self.do = inputs, list(inputs), lines, log, do
        self.budget, self.earlier = budget, rows_again(lines, budget)
        self.order: dict[str, None] = {}

    def at(self, shares: np.ndarray) -> list[dict]:
        """Lines of the rows at shares, (d, s) of the inputs' ranges; those that are not there yet are done."""
        columns = [found.values(shares[i]) for i, found in enumerate(self.inputs.values())]
        rows = [plain(dict(zip(self.names, values, strict=True))) for values in zip(*columns, strict=True)]
        keys = [key(row, self.names) for row in rows]
        self.order.update(dict.fromkeys(keys))
        check_most(ROWS, len(self.order), "This search")
        todo = list({one: row for one, row in zip(keys, rows, strict=True) if one not in self.lines}.values())
        with contextlib.closing(self.do(todo)) as results:
            for number, result in results:
                line = line_of(todo[number], result, self.budget)
                if self.log:
                    self.log.append(number, line)
                one = key(line, self.names)
                self.lines[one] = max(line, self.earlier.get(one, line), key=standing)
        return [self.lines[one] for one in keys]

    def asked(self) -> list[dict]:
        """Lines of all rows asked for so far."""
        return [self.lines[one] for one in self.order]


class Best(NamedTuple):
    """What was found.

    Parameters
    ----------
    row : dict, inputs and measures of the best row that meets all constraints; None if none does
    table : DataFrame, all rows in the order in which they were asked for
    """

    row: dict[str, Any] | None
    table: Any


def read_objective(text: str) -> tuple[str, bool]:
    """The measure of "peak_tension", "min peak_tension" or "max height:p0", and whether it is to be large.

    Raises
    ------
    BestError
    """
    words = text.split()
    if len(words) == 1 and words[0] not in ("min", "max"):
        return words[0], False
    if len(words) == 2 and words[0] in ("min", "max"):
        return words[1], words[0] == "max"
    raise BestError(
        f"What is best must be a measure, min MEASURE or max MEASURE, as in min peak_tension, but {shown(text)} was given."
    )


def read_constraint(text: str, scene: Scene | None = None) -> Constraint:
    """The bound that "sag<=0.1" means, and with a scene, which tells units of measures, "sag<=10cm".

    Raises
    ------
    BestError
    """
    found = CONSTRAINT.fullmatch(text)
    if found:
        sizes = {} if scene is None else sizes_of(scene, found["measure"])
        bound = amount(found["bound"], sizes)
        if math.isfinite(bound):
            return Constraint(found["measure"], found["sign"] == "<=", bound)
    raise BestError(f"A constraint must be MEASURE<=NUMBER or MEASURE>=NUMBER, as in sag<=0.1, but {shown(text)} was given.")


def best(
    scene: Scene,
    vary: dict[str, Any],
    objective: str,
    *,
    constraints: Iterable[str] = (),
    measures: Iterable[str] = (),
    t_end: float | None = None,
    method: str | None = None,
    dt: float | None = None,
    start: str | None = None,
    since: float | None = None,
    seed: int = 0,
    budget: float | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    out: str | Path | None = None,
    resume: bool = False,
) -> Best:
    """Search the inputs for which a measure is least or largest.

    Generations of rows run in parallel. The search ends when a generation is alike, or after `GENERATIONS`. Its seed makes it the
    same each time: one that is resumed asks for the same rows, and finds them.

    Parameters
    ----------
    scene : Scene
    vary : name -> what it may be, with ends: "a:b", "a:b:log", "a,b,c" or a bounded distribution (see `sampling.read_inputs`)
    objective : "peak_tension", "min peak_tension" or "max height:p0"
    constraints : "sag<=0.1", "sag<=10cm", "height:p0>=-2"; a row that fails meets none
    measures : further ones for the table
    seed : of the search
    t_end, method, dt, start, since, budget, executor, workers, out, resume : as in `sweep`

    Returns
    -------
    Best

    Raises
    ------
    BestError : an objective or constraint that cannot be read, an input without ends
    VaryError, MeasureError, RowsError, InputError : as in `sweep`
    """
    check_workers(workers, elsewhere=executor is not None)
    question = _Question(*read_objective(objective), [read_constraint(text, scene) for text in constraints])
    inputs = read_inputs(scene, vary)
    for name, found in inputs.items():
        if math.isinf(found.low) or math.isinf(found.high):
            raise BestError(f"What is searched must have ends, but `{name}` ~ {vary[name]} has none.")
    told = {name: as_told(spec) for name, spec in vary.items()}
    settings = {"t_end": t_end, "method": method, "dt": dt, "start": start}
    columns = tuple(dict.fromkeys([question.measure, *(bound.measure for bound in question.bounds), *measures]))
    variant, identity = prepared(scene, told, columns, settings, since)
    identity |= {"vary": told, "best": objective, "constraints": [str(bound) for bound in question.bounds], "seed": seed}
    run, names, out = BatchRunner(variant, check_budget(budget)), list(inputs), None if out is None else Path(out)
    with contextlib.ExitStack() as stack:
        stack.enter_context(locked(out))
        lines, log = {}, None
        if out is not None:
            lines, log = open_log(out, names, None, resume=resume, identity=plain(identity), columns=columns)
            stack.enter_context(log)
        do = partial(through_executor, executor, run) if executor else stack.enter_context(OwnPool(run, workers)).results
        rows = _AskedRows(inputs, lines, run.budget, log, do)
        try:
            _search(question, rows, seed)
        except (KeyboardInterrupt, WorkerError) as stopped:
            raise with_done(stopped, list(rows.lines.values()), names, log) from None
        table = table_of(rows.asked(), names)
        if out is not None:
            save_table(table, out / "rows")
    line = question.best_of(rows.asked())
    return Best(None if line is None else {name: line[name] for name in (*names, *columns)}, table)


def _search(question: _Question, rows: _AskedRows, seed: int) -> None:
    """Ask for rows, a generation at a time, until one is alike."""
    from scipy.optimize import NonlinearConstraint, differential_evolution

    def tell(intermediate_result):
        """Whether the members of a generation are alike in every input."""
        least = (-1 if question.large else 1) * intermediate_result.fun
        LOG.info("%d rows are done; the best has %s = %.6g", len(rows.order), question.measure, least)
        return bool((np.ptp(intermediate_result.population, axis=0) < ALIKE).all())

    excess = _of_columns(lambda shares: question.excess(rows.at(shares)))
    differential_evolution(
        _of_columns(lambda shares: question.cost(rows.at(shares))),
        [(0.0, 1.0)] * len(rows.names),
        constraints=NonlinearConstraint(excess, -np.inf, 0.0) if question.bounds else (),
        popsize=PER_INPUT,
        maxiter=GENERATIONS,
        tol=ALIKE,
        init="sobol",
        polish=False,
        vectorized=True,
        updating="deferred",
        callback=tell,
        rng=np.random.default_rng(seed),
    )


def _of_columns(function):
    """A function of shares (d, s), called with those of one member (d,) too."""
    return lambda shares: function(shares) if shares.ndim == 2 else function(shares[:, np.newaxis])[..., 0]


def _number(value):
    """The value as a number, NaN for what is none."""
    return float(value) if isinstance(value, int | float) else math.nan
