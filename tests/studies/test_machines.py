"""Sweeps on other machines: workers of a Dask cluster, ranks of MPI, jobs, each as real processes of this one."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pandas
import pytest
from test_parts import ROWS, SETTINGS, calls, is_table, noted, one_process  # noqa: F401 (the last is a fixture)

from studies.command_line import main
from studies.sweeping.machines import MachineError, ShardJob, machines_on, read_on, through_slurm
from studies.sweeping.parts import Shard
from studies.sweeping.rows import gather, run_rows
from studies.sweeping.workers import WorkerError

ROOT = Path(__file__).parents[2]
SWEEP = ["sweep", "net_held", "--vary", "EA=1e3,1e4,1e5", "--vary", "segments=5,6", "--measure", "height:p0"]


@pytest.fixture(scope="module")
def dask_address():
    """A cluster of two worker processes on this machine."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        yield cluster.scheduler_address


@pytest.mark.slow
def test_a_worker_of_dask_that_is_killed_is_made_up_for_and_the_table_is_that_of_one_process(dask_address, tmp_path, one_process):  # noqa: F811
    function = partial(noted, folder=tmp_path, killed_at=20)
    with machines_on("dask", dask_address) as machines:
        table = run_rows(
            function, ROWS, executor=machines.executor, workers=machines.workers, out=tmp_path, shard=Shard(), **SETTINGS
        )
    assert machines.workers == 2 and (tmp_path / "killed-20").exists()
    assert is_table(table, one_process) and is_table(gather(tmp_path)[0], one_process)
    assert set(calls(tmp_path)) == set(range(30))


@pytest.mark.slow
def test_a_sweep_on_dask_from_the_command_line_goes_on_with_its_parts(dask_address, tmp_path, capsys):
    def call(*more):
        with pytest.raises(SystemExit) as ended:
            main([*SWEEP, *more])
        return ended.value.code, capsys.readouterr()

    assert call("--out", str(tmp_path / "one"), "--workers", "1")[0] == 0
    assert call("--out", str(tmp_path / "dask"), "--on", f"dask:{dask_address}")[0] == 0
    one, many = (pandas.read_parquet(tmp_path / name / "rows.parquet") for name in ("one", "dask"))
    assert is_table(many, one) and len(one) == 6
    status, said = call("--out", str(tmp_path / "dask"), "--on", f"dask:{dask_address}")  # all is there
    assert status == 0 and "6 rows in" in said.err


def test_a_scheduler_that_does_not_answer_is_a_clear_word(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("studies.sweeping.machines.CONNECTING", 0.5)
    with (
        pytest.raises(MachineError, match=r"The scheduler of Dask must answer, but tcp://127\.0\.0\.1:1"),
        machines_on("dask", "tcp://127.0.0.1:1"),
    ):
        pass


def mpiexec():
    """How two ranks are begun; a test without MPI is skipped."""
    pytest.importorskip("mpi4py")
    found = shutil.which("mpiexec", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    works = found and subprocess.run([sys.executable, "-c", "from mpi4py import MPI"], capture_output=True).returncode == 0
    if not works:
        pytest.skip("there is no library of MPI")
    return [found, "-n", "2", sys.executable, "-c", "from studies.command_line import main; main()"]


@pytest.mark.slow
def test_two_ranks_of_mpi_make_the_table_of_one_process(tmp_path):
    here = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]), "HYDRA_LAUNCHER": "fork"}
    begun = {"cwd": tmp_path, "env": here, "capture_output": True, "text": True, "timeout": 300}
    done = subprocess.run([*mpiexec(), *SWEEP, "--out", str(tmp_path / "mpi"), "--on", "mpi"], **begun)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("height:p0") == 1  # the rank that only serves says nothing
    with pytest.raises(SystemExit):
        main([*SWEEP, "--out", str(tmp_path / "one"), "--workers", "1"])
    assert is_table(*(pandas.read_parquet(tmp_path / name / "rows.parquet") for name in ("mpi", "one")))


KILLING = """
import os, pathlib, signal
def height(run):
    if run.scene.cables[0].EA > 9e4 and not pathlib.Path("killed").exists():
        pathlib.Path("killed").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return float(run.position("p0")[-1, 2])
"""


@pytest.mark.slow
def test_a_rank_of_mpi_that_is_killed_ends_all_and_the_same_command_does_the_rest(tmp_path):
    """What was done is there, no row is done twice, and the table is that of one process."""
    (tmp_path / "killing.py").write_text(KILLING)
    asked = ["sweep", "net_carried", "--vary", "EA=1e3:1e5:30log", "--t-end", "1s", "--dt", "8ms", "--measure", "killing:height"]
    here = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]), "HYDRA_LAUNCHER": "fork"}
    begun = {"cwd": tmp_path, "env": here, "capture_output": True, "text": True, "timeout": 300}
    call = [*mpiexec(), *asked, "--out", "mpi", "--on", "mpi"]
    killed = subprocess.run(call, **begun)
    assert killed.returncode != 0 and (tmp_path / "killed").exists(), killed.stderr
    kept = {path: path.read_bytes() for path in (tmp_path / "mpi" / "parts").rglob("*.jsonl")}
    assert kept
    done = subprocess.run(call, **begun)
    assert done.returncode == 0, done.stderr
    assert all(path.read_bytes() == whole for path, whole in kept.items())
    texts = [path.read_bytes().splitlines() for path in (tmp_path / "mpi" / "parts").rglob("*.jsonl")]
    assert sum(len(lines) - 1 for lines in texts) == 30  # the last line of a part only ends it
    subprocess.run([*call[3:6], *asked, "--out", "one", "--workers", "1"], **begun, check=True)
    assert is_table(*(pandas.read_parquet(tmp_path / name / "rows.parquet") for name in ("mpi", "one")))


def share(folder, fails=False, **given):
    if fails and given["shard"].number == 2:
        raise ValueError("no such thing")
    return run_rows(partial(noted, folder=folder), ROWS, out=folder, **given, **SETTINGS)


@pytest.mark.slow
def test_an_array_of_jobs_makes_the_table_of_one_process(tmp_path, one_process, monkeypatch):  # noqa: F811
    """Jobs of this machine, by the library that submits them to Slurm; the second of them fails, and its shard is done again."""
    pytest.importorskip("submitit")
    folders = [str(ROOT), str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(folders))
    with pytest.raises(WorkerError, match=r"1 of 2 jobs failed, the first \S+: ValueError: no such thing; their logs are in"):
        through_slurm("short:5min", partial(share, tmp_path, True), 2, tmp_path / "slurm", cluster="local")
    assert calls(tmp_path) == list(range(0, 30, 2))
    with ThreadPoolExecutor(1) as executor:
        share(tmp_path, executor=executor, shard=Shard(2, 2))
    assert is_table(gather(tmp_path)[0], one_process)
    assert calls(tmp_path) == list(range(30))


def test_jobs_are_counted_and_go_on_in_another_where_one_is_out_of_time(tmp_path):
    pytest.importorskip("submitit")
    assert ShardJob(share, Shard(1, 2)).checkpoint().function.shard == Shard(1, 2)
    with pytest.raises(MachineError, match="jobs of a sweep must be 1 to 10000, but they are 0"):
        through_slurm("short", share, 0, tmp_path)


@pytest.mark.parametrize("text", ["dask", "dask:", "mpi:4", "slurm", "slurm:", "slurm:a:b", "ray:there", ""])
def test_machines_that_are_none_are_named(text):
    with pytest.raises(MachineError, match="A sweep runs on dask:ADDRESS, mpi, slurm:PARTITION"):
        read_on(text)
    assert read_on("dask:tcp://node:8786") == ("dask", "tcp://node:8786")
    assert read_on("slurm:short:90min") == ("slurm", "short:90min")


@pytest.mark.parametrize(
    ("kind", "module", "extra"), [("dask", "distributed", "dask"), ("mpi", "mpi4py", "mpi"), ("slurm", "submitit", "slurm")]
)
def test_a_library_that_is_not_installed_is_named(monkeypatch, tmp_path, kind, module, extra):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MachineError, match=rf"To run on {kind}, .*must be installed \(pip install anet-lumped\[{extra}\]\)"):
        if kind == "slurm":
            through_slurm("short", share, 2, tmp_path)
        else:
            with machines_on(kind, "tcp://127.0.0.1:1"):
                pass


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--on", "mpi", "--shard", "1/2"], "--on and --shard exclude each other"),
        (["--best", "sag", "--sample", "lhs:4"], "--sample and --best exclude each other"),
        (["--best", "sag", "--shard", "1/2"], "--best and --shard exclude each other"),
        (["--best", "sag", "--on", "slurm:short"], "--best runs on dask or mpi"),
        (["--constraint", "sag<=1"], "--constraint is for --best"),
    ],
)
def test_options_that_exclude_each_other_are_told(tmp_path, capsys, options, message):
    with pytest.raises(SystemExit) as ended:
        main([*SWEEP, "--out", str(tmp_path), *options])
    assert ended.value.code == 2 and message in capsys.readouterr().err
