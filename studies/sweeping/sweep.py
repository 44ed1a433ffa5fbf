"""One scene, many variants: vary any of its fields or the run's settings, measure each variant."""

from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from anet_lumped.checks import check_number, nearest, shown
from anet_lumped.scene.as_dict import scene_to_dict
from anet_lumped.scene.scene import Scene
from integrators import schemes
from studies.sweeping.measures import MEASURES, OF_CABLES, Measure, Source, read_measure
from studies.sweeping.own_measure import OwnMeasure
from studies.sweeping.parts import Shard
from studies.sweeping.rows import run_rows
from studies.sweeping.sampling import as_told, inputs_of, read_inputs, sampled
from studies.sweeping.units import with_units
from studies.sweeping.vary import SETTINGS, VaryError, apply, grid, read_values

AT_REST = ("stretch", "sag", "tension", "stable")
OF_RUN = ("end_stretch", "peak_tension", "energy_rise", "steps", "wall_time")


def sweep(
    scene: Scene,
    vary: dict[str, str | Iterable],
    measures: Iterable[str] = (),
    *,
    t_end: float | None = None,
    method: str | None = None,
    dt: float | None = None,
    start: str | None = None,
    since: float | None = None,
    sample: str | None = None,
    seed: int = 0,
    budget: float | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    shard: Shard | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    label: str | None = None,
):
    """Measure a scene for every combination of the varied values, or for a sample of them.

    With an executor and a folder `out`, the executor's workers write what they have done into the folder as parts, which every one
    of them must see; so does a `shard`. A sweep whose parts are there goes on with the others.

    Parameters
    ----------
    scene : Scene
    vary : name -> values, or "a:b:n", "a:b:nlog", "a,b,c" (see `vary.read_values`); of a sample, what each name is sampled from
        (see `sampling.read_inputs`)
    measures : names, "name:target" (see `measures.MEASURES`), or "module:function"; a usual few by default
    t_end : float [s], how long each variant runs; it only rests without one
    method, dt, start : as in `simulate`
    since : float or None [s], from when on measures over time look at each run; from its start on if None
    sample : None for a grid, or "sobol:n", "lhs:n", "saltelli:n" (see `sampling.KINDS`)
    seed : of the sample
    budget : float or None [s], that a variant may take; of one that takes longer the row says "over budget"
    executor, workers, out, resume, label : as in `run_rows`
    shard : Shard or None, which rows this process does

    Returns
    -------
    pandas.DataFrame : a line for each variant (of the shard): inputs, measures, status, reason

    Raises
    ------
    VaryError, MeasureError : an unknown name or word, a number that cannot be, or a measure or setting of a run without `t_end`
    RowsError : `out` holds rows already, or rows of another sweep
    FolderInUseError : another run writes to `out`
    WorkerError : workers that do not come up, or do not see `out`
    InputError : more variants than `limits.ROWS`, or workers that cannot be
    """
    given = {"t_end": t_end, "method": method, "dt": dt, "start": start}
    if sample is None:
        values = read_values(scene, vary)
        rows, specified = grid(values), {"vary": values}
    else:
        rows = sampled(sample, read_inputs(scene, vary), seed)
        specified = {"vary": {name: as_told(spec) for name, spec in vary.items()}, "sample": sample, "seed": seed}
    variant, identity = prepared(scene, specified["vary"], measures, given, since)
    if executor and out is not None and shard is None:
        shard = Shard()
    return run_rows(
        variant,
        rows,
        executor=executor,
        workers=workers,
        out=out,
        resume=resume,
        identity=identity | specified,
        columns=tuple(variant.measures),
        label=label,
        budget=budget,
        shard=shard,
        heads=with_units(scene, (*vary, *variant.measures)),
    )


def prepared(scene: Scene, vary: Mapping[str, Iterable], measures: Iterable[str], settings: dict, since: float | None):
    """What does a row of a sweep, and what else than its inputs its results depend on.

    Parameters
    ----------
    scene : Scene
    vary : name -> values or what they are sampled from
    measures : names; a usual few if there are none
    settings : of `simulate`, None for those that are not given
    since : as of `sweep`

    Returns
    -------
    Variant
    identity : dict

    Raises
    ------
    VaryError, MeasureError : as of `sweep`
    """
    settings = {name: value for name, value in settings.items() if value is not None}
    _check_settings(settings)
    runs = "t_end" in settings or "t_end" in vary
    texts = tuple(measures) or _usual(scene, runs)
    found = {text: read_measure(text, scene, runs) for text in texts}
    needing = [f"measure `{text}`" for text in texts if found[text][0].source == Source.RUN]
    needing += [f"setting `{name}`" for name in (*vary, *settings) if name in SETTINGS]
    if needing and not runs:
        raise VaryError(f"The time `t_end` [s] must be given for a run, which {needing[0]} needs, but it is not.")
    identity = {"scene": scene_to_dict(scene), "measures": texts, "settings": settings}
    own = {text: measure.function.stamp() for text, (measure, _) in found.items() if isinstance(measure.function, OwnMeasure)}
    if own:
        identity["own measures"] = own
    if since is not None:
        since = identity["since"] = _check_since(since, found, vary.get("t_end", [settings.get("t_end")]))
    return Variant(scene, settings if runs else None, found, since), identity


def _usual(scene, runs):
    """The measures of a scene for which none are asked: without cables, heights of what moves in place of those of cables."""
    if scene.cables:
        return AT_REST + OF_RUN * runs
    heights = tuple(f"{'end_' * runs}height:{one.name}" for one in (*scene.bodies, *scene.free_points))
    return heights + tuple(name for name in AT_REST + OF_RUN * runs if MEASURES[name].target not in OF_CABLES)


def _check_settings(settings):
    """Refuse what no run can have before every row fails by it."""
    for name in ("t_end", "dt"):
        if name in settings:
            check_number(name, settings[name], "s", "the sweep", sign="positive")
    for name, known in (("method", schemes.MODULES), ("start", ("equilibrium", "calm", "straight"))):
        given = settings.get(name)
        if isinstance(given, str) and given not in known:
            near = nearest(given, known) or f"; known are {', '.join(known)}."
            raise VaryError(f"No run can have {name}={shown(given)}{near}")


def _check_since(since, found, ends):
    """The time from which on measures look, if one of them does, and every run goes on beyond it."""
    since = check_number("since", since, "s", "the sweep", sign="non-negative")
    if not any(measure.over_time for measure, _ in found.values()):
        known = ", ".join(name for name, measure in MEASURES.items() if measure.over_time)
        raise VaryError(f"The time `since` [s] is for measures over time, but none was asked for; they are {known}.")
    for t_end in ends:
        if isinstance(t_end, int | float) and not since < t_end:
            raise VaryError(
                f"The time `since` [s] must be before the end of every run, but it is {since:g} and one ends at {t_end:g}."
            )
    return since


@dataclass(frozen=True)
class Variant:
    """Function of a row: apply the row's inputs to the scene, find its rest or run it, and measure."""

    scene: Scene
    settings: dict | None
    measures: dict[str, tuple[Measure, tuple]]
    since: float | None = None

    def __call__(self, inputs: dict) -> dict:
        """Measures, status and reason. Of a run that failed, those measures that its good part allows."""
        from studies.sweeping.rest_and_run import rest_and_run

        scene, varied = apply(self.scene, inputs_of(inputs))
        rests = any(measure.source == Source.REST for measure, _ in self.measures.values())
        rest, run = rest_and_run(scene, None if self.settings is None else self.settings | varied, rests)
        sources = {Source.REST: rest, Source.RUN: run}
        result = {} if run is None else {"status": run.status, "reason": run.message}
        for text, (measure, target) in self.measures.items():
            arguments = (*target, self.since) if measure.over_time else target
            try:
                result[text] = measure.function(sources[measure.source], *arguments)
            except Exception as error:  # the other measures are worth having
                if result.get("status", "done") == "done":
                    result |= {"status": "failed", "reason": f"measure {text}: {type(error).__name__}: {error}"}
        return result
