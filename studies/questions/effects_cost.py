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
from anet_lumped.effects import REGISTRY, node_energy
from anet_lumped.effects.effect import PAID_OUT
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from integrators.stage import LAW_BETWEEN, Stage
from studies.accuracy_cost.cases import net
from studies.questions.speed import newton_iterations

QUESTION = "What does an effect cost: one that a scene has, and one that only the library has?"

CABLES = {"diameter": 0.01, "EI": 1e-5, "compression": "linear"}
"""Of its cables: what effects may need [m], [N·m²], and that no segment slackens, for which an iteration would solve twice."""
OWN = "weight of one's own"
WHAT = {"verlet": "a step of verlet", "newton": "a Newton iteration of edmc"}
DT = {"verlet": 2e-5, "newton": 0.01}  # steps [s]
TIMES = {"verlet": 2000, "newton": 50}  # steps or iterations that are timed as one: few, so that most are not interrupted
REPEATS, QUICK_REPEATS = 100, 5  # of which the shortest counts
PROCESSES, QUICK_PROCESSES = 5, 1  # for each library; where a process happens to have its arrays makes some per cent
LIBRARIES = ("whole", "stripped", "imported")
TURN = 10  # repeats of one process before it is the next one's turn
ALIKE = 0.03  # two libraries whose steps differ by less are alike


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
    """Time of what Newton's method does in an iteration [s], at one place: what an effect changes in the motion costs nothing."""
    h, arrays, q = DT["newton"], fresh_net(build(scene)), start.q.copy()
    arrays.tension[:] = start.segment_tension
    stage = Stage(LAW_BETWEEN, 0.5 * h, 2.0 / h**2, 0.5, h, 0.5)
    began = time.perf_counter()
    newton_iterations(stage, start.q, start.q, q, arrays.address, TIMES["newton"])
    return (time.perf_counter() - began) / TIMES["newton"]


TIMED = {"verlet": step_of_verlet, "newton": newton_iteration}


def shortest(scenes, repeats):
    """A row for each scene by name: the shortest times a node [ns] of what is in WHAT; the scenes take turns."""
    start, rows = equilibrium(plain()), {name: {f"{what}_ns": np.inf for what in WHAT} for name in scenes}
    for repeat in range(repeats + 1):
        for (name, scene), (what, timed) in itertools.product(scenes.items(), TIMED.items()):
            took = 1e9 * timed(scene, start) / start.model.n
            if repeat:  # the first one compiles
                rows[name][f"{what}_ns"] = min(rows[name][f"{what}_ns"], took)
    return rows


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

    @node_energy(dead=True)
    def weight(t, q, mass, g=9.81):
        return mass * g * q[2]

    return weight()


def marginal(repeats):
    """A row for each effect beside the weight, for all together, and for the weight itself and one of one's own."""
    base = plain()
    gravity, bare = base.effects, replace(base, effects=())
    effects = {name: REGISTRY[name].example(base) for name in REGISTRY.library if name != "gravity"}
    known = REGISTRY.classes
    REGISTRY.classes = dict(known)  # an effect of one's own comes and goes with it
    try:
        own = own_weight()
        scenes = {"none": bare, "gravity": base, OWN: replace(base, effects=(own,))}
        scenes |= {name: replace(base, effects=(*gravity, effect)) for name, effect in effects.items()}
        together = [effect for effect in effects.values() if joins_others(effect, base)]
        scenes["all together"] = replace(base, effects=(*gravity, *together))
        timed = shortest(scenes, repeats)
        rows = []
        for name, scene in scenes.items():
            beside = "none" if name in ("gravity", OWN) else "gravity"
            row = {"effect": name, "beside": "" if name == "none" else beside} | timed[name]
            for what in WHAT:
                row[f"{what}_more_percent"] = 100.0 * (timed[name][f"{what}_ns"] / timed[beside][f"{what}_ns"] - 1.0)
            row["memory_bytes"] = memory(scene)
            row["more_bytes"] = row["memory_bytes"] - memory(scenes[beside])
            row["entries"] = sum(entries(scene, effect) for effect in scene.effects if effect not in scenes[beside].effects)
            rows.append(row)
    finally:
        REGISTRY.classes = known
    return rows


def answer_in(library, ask=sys.stdin, tell=sys.stdout):
    """Be a process with a library: for each number of repeats that is asked for, a line, tell `shortest` of the plain net.

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
        row = shortest({"plain": plain()}, int(line))["plain"] | {"memory_bytes": memory(plain())}
        here = [name for name in effects if sys.modules.get(f"anet_lumped.effects.{name}") is not None]
        print(json.dumps(row | {"effects_imported": " ".join(here)}), file=tell, flush=True)


def _process(library):
    code = f"import sys; sys.path[:0] = {[path for path in sys.path if path]!r}\n"
    code += f"from studies.questions.effects_cost import answer_in; answer_in({library!r})"
    return subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def libraries(repeats, processes):
    """A row for each process: shortest times of the plain net in each library, whose processes take turns."""
    rows = []
    for number in range(processes):
        children = {library: _process(library) for library in LIBRARIES}
        told = {library: [] for library in LIBRARIES}
        try:
            for _ in range(max(1, repeats // TURN)):
                for library, child in children.items():
                    print(min(TURN, repeats), file=child.stdin, flush=True)
                    line = child.stdout.readline()
                    if not line:
                        raise RuntimeError(f"The process with the {library} library ended; what it said is above.")
                    told[library].append(json.loads(line))
        finally:
            for child in children.values():
                child.communicate()  # ends what it is asked
        for library, turns in told.items():
            best = {f"{what}_ns": min(turn[f"{what}_ns"] for turn in turns) for what in WHAT}
            rows.append({"process": number, "library": library} | turns[-1] | best)
    return rows


def compute(quick=False, executor=None, out=None):
    """Costs in one process after the other: timings in parallel would measure each other.

    Returns
    -------
    dict of DataFrame : "marginal", a row for each effect; "libraries", one for each process
    """
    repeats, processes = (QUICK_REPEATS, QUICK_PROCESSES) if quick else (REPEATS, PROCESSES)
    return {"marginal": pd.DataFrame(marginal(repeats)), "libraries": pd.DataFrame(libraries(repeats, processes))}


def ratios(table):
    """Times in each library over those in the whole one: medians of the processes."""
    best = table.groupby("library")[[f"{what}_ns" for what in WHAT]].median()
    return best / best.loc["whole"]


def plot(rows):
    """Cost of a step with each effect, by method."""
    from matplotlib.figure import Figure

    figure, table = Figure(figsize=(9, 3.6), layout="constrained"), rows["marginal"]
    for axes, (what, words) in zip(figure.subplots(1, 2, sharey=True), WHAT.items(), strict=True):
        axes.barh(table.effect.str.replace("_", " "), table[f"{what}_ns"], color="0.6")
        axes.set(xlabel=f"{words}, a node [ns]")
        axes.invert_yaxis()
    return {"effects_cost": figure}


def answer(rows):
    """Whether an effect that a scene lacks is free, and what each one costs that it has."""
    table, of_each = rows["marginal"].set_index("effect"), rows["libraries"]
    ratio = ratios(of_each)
    off = float((ratio - 1.0).abs().to_numpy().max())
    same = "the same memory" if of_each.memory_bytes.nunique() == 1 else "memory that differs"
    loaded = " and ".join(of_each[of_each.library == "whole"].effects_imported.iloc[0].split())

    def about(name):
        row = table.loc[name]
        return (
            f"{name.replace('_', ' ')} {row.verlet_more_percent:+.0f} % and {row.newton_more_percent:+.0f} %, "
            f"{row.more_bytes:.0f} bytes, {row.entries:.0f} entries"
        )

    words = [
        f"An effect that a scene lacks costs {'nothing' if off <= ALIKE else 'little'}: between the whole library, one without any "
        f"effect but the scene's, and one with all of them imported, a step of the plain net differs by {100 * off:.1f} % at most, "
        f"which is {'within' if off <= ALIKE else 'beyond'} the {100 * ALIKE:.0f} % looked for. The plain net takes {same} in "
        f"all, and imports {loaded} only.",
        f"What each adds to {WHAT['verlet']} and to {WHAT['newton']} beside the weight (gravity and the weight of one's own: "
        "beside no effect), to the memory of a run, and entries of the matrix that it changes: "
        + "; ".join(about(name) for name in table.index if name != "none")
        + ".",
        f"A weight written as a law of one's own takes {table.loc[OWN].newton_ns / table.loc['gravity'].newton_ns:.2f} times the "
        f"iteration of edmc that Gravity takes and {table.loc[OWN].verlet_ns / table.loc['gravity'].verlet_ns:.2f} times the step "
        "of verlet. Effects that couple nodes pay for an elimination with more blocks, which all of them share.",
        "Left out: compile time, which the library's effects pay once for a machine and those of one's own once a process; what an "
        "effect changes in the motion, and so in the number of Newton iterations.",
    ]
    return "\n\n".join(words)
