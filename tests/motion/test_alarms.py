"""An alarm whose handler raises while a run marches, as programs set it to end what takes too long."""

import signal
import subprocess
import sys

import pytest

PROGRAM = """
import gc, signal, sys, time
import numpy as np
from anet_lumped import load_scene, simulate

net, options = load_scene("net_carried"), eval(sys.argv[1])
simulate(net, 0.1, **options)  # imported and compiled

armed = False

def handler(number, frame):
    global armed
    if armed:  # else what comes next might meet the program between two lines
        armed = False
        raise TimeoutError("it took too long")

signal.signal(signal.SIGALRM, handler)
signal.setitimer(signal.ITIMER_REAL, 0.005, 0.005)
for _ in range(20):
    try:
        armed = True
        simulate(net, 100.0, **options)
    except TimeoutError:
        print("ended")
    else:
        sys.exit("it was not ended")
    gc.collect()
    junk = [np.ones((500, 3)) for _ in range(300)]  # over arrays that a march still works on, if one did
signal.setitimer(signal.ITIMER_REAL, 0.0)
run = simulate(net, 0.1, **options)
print("whole", bool(np.isfinite(run.q).all()))
"""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="a system without timers that send signals")
@pytest.mark.parametrize("options", [dict(method="edmc", dt=1e-3), dict(rtol=1e-8, atol=1e-8)], ids=["fixed", "adaptive"])
def test_a_handler_that_raises_ends_a_run_and_never_the_process(options):
    """The exception comes after the march, whose arrays nobody has let go; the first run afterwards is as ever."""
    done = subprocess.run([sys.executable, "-c", PROGRAM, repr(options)], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split() == ["ended"] * 20 + ["whole", "True"]
