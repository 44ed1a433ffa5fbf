"""The line that says that Numba compiles: once, only when something is compiled, from here or from a worker."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from integrators.compiling import Notice
from studies.sweeping import workers
from studies.sweeping.batch import BatchRunner

ROOT = Path(__file__).parents[2]
COMPILES = """
    import time
    from integrators.compiling import call_when_compiling
    told = []
    call_when_compiling(lambda: told.append(1))
    import numba
    def something(x):
        return x + {number}
    began = time.perf_counter()
    {before}
    for _ in range(3):
        numba.njit(something)(1.0)
        {between}
    print(len(told))
"""


def told(before="pass", between="pass"):
    code = textwrap.dedent(COMPILES.format(number=len(between), before=before, between=between))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return int(done.stdout)


@pytest.mark.slow
def test_it_is_told_once_of_what_takes_long():
    """Compiling that is slowed down to longer than what nobody needs to be told of, three times."""
    slow = (
        "from integrators import compiling; compiling.NOTICED_AFTER = 0.1; import numba.core.event as event; "
        "slow = type('Slow', (event.Listener,), {'on_start': lambda self, e: time.sleep(0.2), 'on_end': lambda self, e: None}); "
        "event.register('numba:compile', slow())"
    )
    assert told(before=slow) == 1


def test_nothing_is_told_of_what_takes_no_time():
    quick = "from integrators import compiling; compiling.NOTICED_AFTER = 1e3"
    assert told(before=quick) == 0


def test_the_line_of_who_speaks_first_is_given_once():
    lines, notice = [], Notice()
    notice.give()
    notice.prepare("compiling", lines.append)
    notice.prepare("compiling something else", lines.append)
    assert lines == []
    notice.give()
    notice.give()
    assert lines == ["compiling"]


def slow_to_compile(row):
    """What a worker does that compiles: the flag that its listener sets, and a wait."""
    import time

    import numba.core.event as event

    if row["x"] == 0:
        with event.trigger_event("numba:compile", data={}):
            time.sleep(1.6)
    return {"began": time.time()}


def test_while_a_worker_compiles_the_others_wait_and_one_line_is_told(monkeypatch):
    lines = []
    notice = Notice()
    notice.prepare("compiling", lines.append)
    monkeypatch.setattr(workers, "NOTICE", notice)
    rows = [{"x": x} for x in range(4)]
    with workers.OwnPool(BatchRunner(slow_to_compile), 2) as pool:
        began = {x: result["began"] for x, result in pool.results(rows)}
    assert lines == ["compiling"]
    assert sorted(began) == [0, 1, 2, 3] and min(began[x] for x in (1, 2, 3)) >= began[0]


@pytest.mark.parametrize(("cached", "started"), [(True, ["running"]), (False, [])])
def test_workers_start_early_only_where_nothing_is_to_be_compiled(monkeypatch, cached, started):
    calls = []
    monkeypatch.setattr(workers, "kernels_are_on_disk", lambda: cached)
    monkeypatch.setattr("multiprocessing.forkserver.ensure_running", lambda: calls.append("running"))
    workers.start_early()
    assert calls == started


def test_a_look_at_the_disk(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not workers.kernels_are_on_disk()
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "force.nbi").write_bytes(b"")
    assert workers.kernels_are_on_disk()


OF_THE_LIBRARY = (
    "anet_lumped compiles what this machine has not compiled yet, for up to about a minute, longer on a busy machine; "
    "later runs do without."
)
OF_A_COMMAND = (
    "anet-lumped: Compiling what this machine has not compiled yet takes up to about 7 s, longer on a busy machine; "
    "later runs do without."
)
FIRST_RUN = """
import sys
import time
import numba.core.event as event
{before}
import anet_lumped
from integrators import compiling
compiling.NOTICED_AFTER = 0.1
class Dispatcher:
    _cache = {cache}
for _ in range(2):
    with event.trigger_event("numba:compile", data=dict(dispatcher=Dispatcher())):
        time.sleep(0.2)
    for name in [name for name in sys.modules if name.startswith("anet_lumped")]:
        del sys.modules[name]
    import anet_lumped  # as after an import that Ctrl-C ended
"""


@pytest.fixture(scope="module")
def imported():
    """What the import needs is compiled."""
    subprocess.run([sys.executable, "-c", "import anet_lumped"], cwd=ROOT, check=True)


@pytest.mark.parametrize(
    ("cache", "before", "quiet", "line"),
    [
        ("None", "", None, OF_THE_LIBRARY),
        pytest.param(
            "None",
            "from studies.telling import announce_compiling as say; say(['equilibrium', 'net_held'])",
            None,
            OF_A_COMMAND,
            marks=pytest.mark.slow,
        ),
        pytest.param("None", "", "1", None, marks=pytest.mark.slow),
        pytest.param("__import__('numba').core.caching.NullCache()", "", None, None, marks=pytest.mark.slow),
    ],
)
def test_a_program_is_told_once_of_what_is_kept_on_the_disk(imported, cache, before, quiet, line):
    """Made up: Numba says twice that it compiles something that it keeps, or does not keep."""
    environment = {name: value for name, value in os.environ.items() if name != "ANET_LUMPED_QUIET"}
    environment |= {"ANET_LUMPED_QUIET": quiet} if quiet else {}
    code = [sys.executable, "-c", FIRST_RUN.replace("{cache}", cache).replace("{before}", before)]
    done = subprocess.run(code, cwd=ROOT, env=environment, check=True, capture_output=True, text=True)
    assert done.stderr.splitlines() == [line] * (line is not None)
