"""What does an effect cost: one that a scene has, and one that only the library has?"""

import itertools
import json
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pandas as pd

from anet_lumped import equilibrium, simulate
from anet_lumped.effects import REGISTRY
from anet_lumped.effects.effect import PAID_OUT
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.views.palette import BLUE, ORANGE
from integrators.stage import LAW_BETWEEN, Stage
from studies.accuracy_cost.motions import net
from studies.accuracy_cost.paired_timing import FEWEST, in_words, ratio, take_turns
from studies.shown.sentences import listed
from studies.shown.show import as_text
from studies.study import Drawing, Part, Record

STUDY = Record(
    question=__doc__,
    part=Part.COST,
    first_look="air, temperature and viscous damping in place of all effects, each timed in 6 turns in place of 60, and the whole "
    "library against one without other effects in one pair of processes in place of 12, which tells no times.",
    compares_times=True,
)
TABLES = {
    "marginal": "A line for each effect: what it adds to a step, to an iteration and to the memory of a run, beside another scene.",
    "turns": "A line for each turn in which a step and an iteration of each scene were timed one after the other, in ns a node.",
    "libraries": "A line for each turn of each process: times of the plain net with the whole library, without all other effects, "
    "and with all of them imported.",
}

CABLES = {"diameter": 0.01, "EI": 1e-5, "compression": "linear"}
"""Of its cables: what effects may need [m], [N·m²], and that no segment slackens, for which an iteration would solve twice."""
QUICK_EFFECTS = ("air", "temperature", "viscous_damping")
OWN = "weight of one's own"
WHAT = {"verlet": "a step of verlet", "newton": "a Newton iteration of edmc"}
DT = {"verlet": 2e-5, "newton": 0.01}  # steps [s]
TIMES = {"verlet": 2000, "newton": 50}  # steps or iterations that are timed as one: few, so that most are not interrupted
TURNS, QUICK_TURNS = 60, 6
LIBRARIES = {"whole": "the whole library", "stripped": "none of the other effects", "imported": "all of them imported"}
QUICK_LIBRARIES = ("whole", "stripped")
PROCESSES, QUICK_PROCESSES = 12, 1  # of each library, a pair each: where a process has its arrays makes some per cent
TURNS_A_PROCESS = 3
TURN = 5  # repeats of one process before it is the next one's turn
ALIKE = 3.0  # [%] by which a step may differ where an effect that a scene lacks costs nothing


def plain():
    """The carried net with its weight, whose cables have what effects may need."""
    return net("net_carried", **CABLES)


def joins_others(effect, scene):
    """Whether an effect goes with all others: one that pays out length takes none whose numbers are not linear in a length."""
    return all(change.quantity != PAID_OUT for change in effect.length_changes(scene))


def step_of_verlet(scene, start):
    """Time of a step [s], of a run that saves its end only."""
    t_end = TIMES["verlet"] * DT["verlet"]
    return simulate(scene, t_end, method="verlet", dt=DT["verlet"], start=start, save_every=t_end).wall_time / TIMES["verlet"]


def newton_iteration(scene, start):
    """Time of an iteration of Newton's method [s], repeated at one state: what an effect changes in the motion costs nothing."""
    from studies.accuracy_cost.compiled_loops import newton_iterations

    h, arrays, q = DT["newton"], fresh_net(build(scene)), start.q.copy()
    arrays.tension[:] = start.segment_tension
    stage = Stage(LAW_BETWEEN, 0.5 * h, 2.0 / h**2, 0.5, h, 0.5)
    began = time.perf_counter()
    newton_iterations(stage, start.q, start.q, q, arrays.address, TIMES["newton"])
    return (time.perf_counter() - began) / TIMES["newton"]


TIMED = {"verlet": step_of_verlet, "newton": newton_iteration}


def timed_in_turns(scenes, turns):
    """Times a node [ns] of what is in WHAT, for each scene by name: a list for each (scene, what), whose k-th are of one turn."""
    start = equilibrium(plain())
    timed = {
        (name, what): lambda scene=scene, time_of=time_of: 1e9 * time_of(scene, start) / start.model.n
        for (name, scene), (what, time_of) in itertools.product(scenes.items(), TIMED.items())
    }
    return take_turns(timed, turns)


def memory(scene):
    """Bytes of the arrays of a run, but for what it saves."""
    return sum(array.nbytes for array in _arrays(fresh_net(build(scene))))


def _arrays(value):
    if isinstance(value, np.ndarray):
        return [value]
    return [array for part in value for array in _arrays(part)] if isinstance(value, tuple) else []


def entries(scene, effect):
    """Entries of the tangent that an effect changes, in a moving state of a scene that has it."""
    if "tangent" not in effect.kernels():
        return 0
    model, random = build(scene), np.random.default_rng(0)
    state = equilibrium(plain())
    q, v = state.q + 1e-3 * random.normal(size=state.q.shape), random.normal(size=state.q.shape)
    index, params = effect.table(model)
    blocks = [np.zeros((model.n_free, 3, 3)), *np.zeros((2, model.n_segments, 2, 3, 3))]
    effect.kernels()["tangent"](0.0, q, v, np.asarray(index, np.int64), np.asarray(params, float), 1.0, 1.0, *blocks)
    return int(sum(np.count_nonzero(block) for block in blocks))


def own_weight():
    """Gravity as its user would write it."""
    from anet_lumped.effects import node_energy

    @node_energy(dead=True)
    def weight(t, q, mass, g=9.81):
        return mass * g * q[2]

    return weight()


def marginal(turns, names):
    """A row for each effect beside the weight, for all together, and for the weight itself and one of one's own; and the turns."""
    base = plain()
    gravity, bare = base.effects, replace(base, effects=())
    effects = {name: REGISTRY[name].example(base) for name in names if name != "gravity"}
    known = REGISTRY.classes
    REGISTRY.classes = dict(known)  # an effect of one's own comes and goes with it
    try:
        own = own_weight()
        scenes = {"none": bare, "gravity": base, OWN: replace(base, effects=(own,))}
        scenes |= {name: replace(base, effects=(*gravity, effect)) for name, effect in effects.items()}
        together = [effect for effect in effects.values() if joins_others(effect, base)]
        scenes["all together"] = replace(base, effects=(*gravity, *together))
        timed = timed_in_turns(scenes, turns)
        rows = []
        for name, scene in scenes.items():
            beside = "none" if name in ("none", "gravity", OWN) else "gravity"
            row = {"effect": name, "beside": "" if name == "none" else beside}
            for what in WHAT:
                found = ratio(timed[name, what], timed[beside, what])
                row[f"{what}_ns"] = float(np.median(timed[name, what]))
                row[f"{what}_more_percent"] = found.percent
            row["memory_bytes"] = memory(scene)
            row["more_bytes"] = row["memory_bytes"] - memory(scenes[beside])
            row["entries"] = sum(entries(scene, effect) for effect in scene.effects if effect not in scenes[beside].effects)
            rows.append(row)
    finally:
        REGISTRY.classes = known
    return rows, {f"{name}, {what}": times for (name, what), times in timed.items()}


def answer_in(library, ask=sys.stdin, tell=sys.stdout):
    """Be a process with a library: for each number of repeats that is asked for, tell the median times of the plain net.

    Besides, the memory of a run, and the effects whose modules have been imported.
    """
    effects = REGISTRY.library
    if library == "stripped":
        REGISTRY.classes = {"gravity": REGISTRY.classes["gravity"]}
        for name in effects:
            if name != "gravity":
                sys.modules[f"anet_lumped.effects.{name}"] = None  # importing it fails: it is not there
    elif library == "imported":
        list(REGISTRY.values())
    for line in ask:
        times = timed_in_turns({"plain": plain()}, int(line))
        row = {f"{what}_ns": float(np.median(times["plain", what])) for what in WHAT} | {"memory_bytes": memory(plain())}
        imported = [name for name in effects if sys.modules.get(f"anet_lumped.effects.{name}") is not None]
        print(json.dumps(row | {"effects_imported": " ".join(imported)}), file=tell, flush=True)


def _process(library):
    code = f"import sys; sys.path[:0] = {[path for path in sys.path if path]!r}\n"
    code += f"from studies.questions.effects_cost import answer_in; answer_in({library!r})"
    return subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def libraries(processes, names):
    """A row for each turn of each process: times of the plain net in each library, whose processes take turns."""
    rows = []
    for number in range(processes):
        children = {library: _process(library) for library in names}
        try:
            for turn, (library, child) in itertools.product(range(TURNS_A_PROCESS), children.items()):
                print(TURN, file=child.stdin, flush=True)
                line = child.stdout.readline()
                if not line:
                    raise RuntimeError(f"The process with the {library} library ended; its error is above.")
                rows.append({"process": number, "turn": turn, "library": library} | json.loads(line))
        finally:
            for child in children.values():
                child.communicate()  # no more is asked, so that it ends
    return rows


def compute(quick=False, executor=None, out=None):
    """The tables, from one process after the other: timings in parallel would measure each other."""
    turns, processes, effects, named = TURNS, PROCESSES, tuple(REGISTRY.library), tuple(LIBRARIES)
    if quick:
        turns, processes, effects, named = QUICK_TURNS, QUICK_PROCESSES, QUICK_EFFECTS, QUICK_LIBRARIES
    rows, timed = marginal(turns, effects)
    compared = libraries(processes, named)
    return {"marginal": pd.DataFrame(rows), "turns": pd.DataFrame(timed), "libraries": pd.DataFrame(compared)}


def ratios(table):
    """Times in each other library over those in the whole one: a `Ratio` for each (library, what), a pair from each two "
    "processes."""
    times = table.pivot_table(index="process", columns="library", values=[f"{what}_ns" for what in WHAT], aggfunc="median")
    others = [library for library in LIBRARIES if library != "whole" and library in set(table["library"])]
    return {
        (library, what): ratio(times[f"{what}_ns", library], times[f"{what}_ns", "whole"]) for library in others for what in WHAT
    }


def plot(rows):
    """Drawings of the study, by name."""
    return {
        "effects_cost": Drawing(
            _plot_cost(rows["marginal"]),
            "What a step of verlet and a Newton iteration of edmc cost a node, in a scene with each effect beside the weight. The "
            "scenes without any effect, with the weight alone and with a weight of one's own stand above.",
        )
    }


def _plot_cost(table):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.8), layout="constrained")
    for axes, (what, words), colour in zip(figure.subplots(1, 2, sharey=True), WHAT.items(), (BLUE, ORANGE), strict=True):
        axes.barh(table.effect.str.replace("_", " "), table[f"{what}_ns"], color=colour)
        axes.set(xlabel=f"{words}, a node [ns]")
        axes.invert_yaxis()
    return figure


def answer(rows):
    """The answer in words, every number and claim from `rows`."""
    return "\n\n".join([
        _lacking(rows["libraries"]), _having(rows["marginal"], rows["turns"]), _own(rows["turns"]), LEFT_OUT,
    ])  # fmt: skip


def _lacking(table):
    """Whether an effect that a scene lacks costs time or memory."""
    found, same = ratios(table), table["memory_bytes"].nunique() == 1
    told = listed(f"{in_words(one)} for {WHAT[what]} with {LIBRARIES[library]}" for (library, what), one in found.items())
    resolved = [one.percent for one in found.values() if one.resolved]
    large = [percent for percent in resolved if abs(percent) > ALIKE]
    if large:
        most = max(large, key=abs)
        change = f"{as_text(abs(most), 2)} % {'more' if most > 0.0 else 'less'}"
        claim = f"is not free here: with another library a step or an iteration of the plain net takes {change} time"
    elif resolved:
        claim = f"costs next to nothing: a step of the plain net differs by {as_text(max(map(abs, resolved)), 2)} % at most"
    elif all(one.pairs < FEWEST for one in found.values()):
        claim = "takes no memory" if same else "takes memory"
    else:
        claim = "costs no time that is seen here"
    imported = listed(table.loc[table["library"] == "whole", "effects_imported"].iloc[0].split(), none="no effect")
    compared = listed(LIBRARIES[library] for library in dict.fromkeys(table["library"]))
    return (
        f"An effect that a scene lacks {claim}. The plain net takes {'the same memory' if same else 'another memory'} with "
        f"{compared} ({_bytes(table['memory_bytes'])}), and imports {imported} only.\n\nTimes of the plain net over "
        f"those with the whole library, pair by pair of processes: {told}."
    )


def _bytes(values):
    """The bytes of a run's arrays, all digits of them."""
    least, most = min(values), max(values)
    return f"{least:.0f} bytes" if least == most else f"{least:.0f} to {most:.0f} bytes"


def _having(table, turns):
    """What each effect adds."""

    def added(row, what):
        found = ratio(turns[f"{row.effect}, {what}"], turns[f"{row.beside}, {what}"])
        return f"{found.percent:+.0f} %" if found.resolved else "not resolved"

    told = [
        f"{row.effect.replace('_', ' ')} {added(row, 'verlet')} and {added(row, 'newton')}, {row.more_bytes:.0f} bytes, "
        f"{row.entries:.0f} entries"
        for row in table.itertuples()
        if row.effect != "none"
    ]
    return (
        f"What each adds to {WHAT['verlet']} and to {WHAT['newton']}, to the memory of a run, and the entries of the matrix that "
        f"it changes, beside the weight (gravity and the weight of one's own: beside no effect): {'; '.join(told)}."
    )


def _own(turns):
    """What a law of one's own costs beside the library's."""
    newton, verlet = (in_words(ratio(turns[f"{OWN}, {what}"], turns[f"gravity, {what}"])) for what in ("newton", "verlet"))
    return (
        f"A weight written as a law of one's own over Gravity, pair by pair: an iteration of edmc {newton}, a step of verlet "
        f"{verlet}. Effects that couple nodes pay for an elimination with more blocks, which all of them share."
    )


LEFT_OUT = (
    "Left out: compile time, which a machine spends once for the library's effects and a process once for those of one's own; what "
    "an effect changes in the motion, and so in the number of Newton iterations."
)
