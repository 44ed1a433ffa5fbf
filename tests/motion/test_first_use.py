"""The first use of the library by a process: from threads at once, and with Ctrl-C while it compiles."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

THREADS = """
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

from anet_lumped import Cable, Fixed, Free, PayloadChange, Scene, equilibrium, load_scene, simulate
from anet_lumped.effects import Bending, Gravity, Ground, segment_force

sys.setswitchinterval(1e-4)  # threads take turns often

@segment_force
def rubbing(t, q0, q1, v0, v1, c):
    f = c * (v1[0] - v0[0]), c * (v1[1] - v0[1]), c * (v1[2] - v0[2])
    return f, (-f[0], -f[1], -f[2])

def cable(*effects, events=(), **more):
    own = {"length": 1.0, "mass_per_length": 0.1, "EA": 1e4, "segments": 10, "zeta": 0.05, "diameter": 0.01} | more
    return Scene([Fixed("a", (0, 0, 0)), Free("b", 0.1, at=(0.6, 0, 0))], [Cable("a", "b", **own)], [Gravity(), *effects], events)

SCENES = {
    "plain": cable(), "segment": cable(rubbing(c=0.1)), "ground": cable(Ground(-0.5)),
    "bending": cable(Bending(), EI=1e-3), "breaks": cable(breaking_tension=1.2),
    "event": cable(events=[PayloadChange("b", 0.03, 0.05)]),
}
TASKS = [(name, dict(dt=1e-3)) for name in SCENES] * 2 + [("plain", dict(rtol=1e-4)), ("plain", dict(method="verlet", dt=1e-4))] * 4

def march(task):
    name, options = task
    together.wait()
    run = simulate(SCENES[name], 0.1, start="straight", **options)
    return name, run.status, run.q.tobytes(), run.v.tobytes(), run.energy.tobytes(), run.segment_tension.tobytes()

def rest(_):
    together.wait()
    return equilibrium(load_scene("net_held")).q.tobytes()

together = threading.Barrier(8)
with ThreadPoolExecutor(8) as pool:
    rests = list(pool.map(rest, range(8)))
together = threading.Barrier(len(TASKS))
with ThreadPoolExecutor(len(TASKS)) as pool:
    runs = list(pool.map(march, TASKS))
together = threading.Barrier(1)
assert rests == [rest(0)] * 8
for run, task in zip(runs, TASKS):
    alone = march(task)
    assert run == alone and run[1] == "done", (task, run[:2], alone[:2])
print("all equal")
"""

INTERRUPTED = """
import signal
from numba.core import event

class Pressed(event.Listener):
    # Ctrl-C, twice, each time that a function begins to be compiled, but for those that are compiled for another one
    depth = 0
    def on_start(self, event):
        self.depth += 1
        if self.depth == 1:
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
    def on_end(self, event):
        self.depth -= 1

event.register("numba:compile", Pressed())
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in what runs in the background
for stopped in range(100):
    try:
        from anet_lumped import Cable, Fixed, Scene, equilibrium
        from anet_lumped.effects import Gravity
        cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=10)
        print(stopped > 3, equilibrium(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.6, 0, 0))], [cable], [Gravity()])).stable)
        break
    except KeyboardInterrupt:
        pass
"""


def printed(code, **more):
    """Last line that a process prints."""
    environment = os.environ | {"ANET_LUMPED_QUIET": "1", "PYTHONPATH": str(ROOT), **more}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]


@pytest.mark.slow
def test_threads_that_first_use_the_library_at_once_give_what_one_thread_gives():
    """Bit for bit, for the same scene in several threads as well."""
    assert printed(THREADS) == "all equal"


@pytest.mark.slow
def test_ctrl_c_while_compiling_leaves_a_library_that_works(tmp_path):
    """Each function is compiled before Ctrl-C is raised, so that trying again goes on."""
    assert printed(INTERRUPTED, NUMBA_CACHE_DIR=str(tmp_path)) == "True True"
