"""The machines a sweep may run on: a Dask cluster, ranks of MPI, jobs of Slurm. Each library is loaded when it is asked for."""

import contextlib
import re
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, NamedTuple

from anet_lumped.checks import InputError, shown
from studies.sweeping.parts import Shard
from studies.sweeping.workers import WorkerError

CONNECTING = 30  # [s] for a scheduler to answer
JOB_MINUTES, MOST_JOBS = 60, 10_000  # of a job of Slurm; one that is out of time goes on in another
REQUEUED = 10  # times
SLURM = re.compile(r"(?P<partition>[^:]+)(?::(?P<minutes>[0-9]+)min)?")


class MachineError(InputError):
    """Machines that cannot be had as they are asked for."""


class Machines(NamedTuple):
    """Where rows run: an executor, and how many of them at once; no executor for a rank of MPI that only serves."""

    executor: Executor | None
    workers: int


def read_on(text: str) -> tuple[str, str]:
    """Kind and address of "dask:tcp://node:8786", "mpi" or "slurm:PARTITION".

    Raises
    ------
    MachineError
    """
    kind, _, address = text.partition(":")
    if (kind == "dask" and address) or text == "mpi" or (kind == "slurm" and SLURM.fullmatch(address)):
        return kind, address
    raise MachineError(f"A sweep runs on dask:ADDRESS, mpi, slurm:PARTITION or slurm:PARTITION:90min, but {shown(text)} was given.")


@contextlib.contextmanager
def machines_on(kind: str, address: str) -> Iterator[Machines]:
    """Within it, the workers of a Dask cluster, or the ranks of MPI but the first, which gives out the rows.

    Raises
    ------
    MachineError : the library is not installed, the cluster does not answer or has no worker, or there is a single rank
    """
    with _dask(address) if kind == "dask" else _mpi() as machines:
        yield machines


@contextlib.contextmanager
def _dask(address):
    try:
        from distributed import Client
    except ImportError:
        raise MachineError("To run on dask, the package distributed must be installed (pip install anet-lumped[dask]).") from None
    try:
        client = Client(address, timeout=CONNECTING)
    except (OSError, ValueError) as error:
        raise MachineError(f"The scheduler of Dask must answer, but {address}: {error}") from None
    with client:
        workers = sum(client.nthreads().values())
        if not workers:
            raise MachineError(f"A cluster of Dask must have workers, but that of {address} has none.")
        yield Machines(client.get_executor(pure=False), workers)


@contextlib.contextmanager
def _mpi():
    try:
        from mpi4py import MPI
        from mpi4py.futures import MPICommExecutor
    except (ImportError, RuntimeError):  # the latter where there is no library of MPI
        raise MachineError("To run on mpi, mpi4py and a library of MPI must be installed (pip install anet-lumped[mpi]).") from None
    ranks = MPI.COMM_WORLD.Get_size()
    if ranks < 2:
        raise MachineError("A sweep on mpi must have two ranks, one of which gives out rows: mpiexec -n 4 anet-lumped sweep ...")
    with MPICommExecutor(MPI.COMM_WORLD, root=0) as executor:
        yield Machines(executor, ranks - 1)


class ShardJob:
    """What a job of Slurm does: a shard of a sweep. Out of time, or pushed aside, it goes on in another job, with the parts there.

    Parameters
    ----------
    sweep : picklable, called with `shard=` and `workers=1`
    shard : Shard
    """

    def __init__(self, sweep: Callable, shard: Shard):
        self.sweep, self.shard = sweep, shard

    def __call__(self) -> int:
        """Number of the rows of the shard."""
        return len(self.sweep(shard=self.shard, workers=1))

    def checkpoint(self) -> Any:
        """What is submitted anew."""
        from submitit.helpers import DelayedSubmission

        return DelayedSubmission(self)


def through_slurm(address: str, sweep: Callable, jobs: int, logs: Path, cluster: str = "slurm") -> None:
    """Submit a sweep as an array of jobs, a shard each, and wait for them; those that are submitted go on if this process ends.

    Parameters
    ----------
    address : the partition, with or without the minutes of a job: "short", "short:90min"
    sweep : as of `ShardJob`
    jobs : number of them
    logs : folder of what they write, which all nodes must see
    cluster : "slurm", or another one that submitit knows

    Raises
    ------
    MachineError : submitit is not installed, or there is no Slurm
    WorkerError : a job failed
    """
    try:
        from submitit import AutoExecutor
        from submitit.core.utils import FailedSubmissionError, UncompletedJobError
    except ImportError:
        raise MachineError("To run on slurm, the package submitit must be installed (pip install anet-lumped[slurm]).") from None
    if not 1 <= jobs <= MOST_JOBS:
        raise MachineError(f"The jobs of a sweep must be 1 to {MOST_JOBS}, but they are {jobs}.")
    partition, minutes = SLURM.fullmatch(address).groups()
    try:
        executor = AutoExecutor(logs, cluster=cluster, slurm_max_num_timeout=REQUEUED)
        executor.update_parameters(
            name="anet-lumped",
            timeout_min=int(minutes or JOB_MINUTES),
            cpus_per_task=1,
            slurm_partition=partition,
            slurm_array_parallelism=jobs,
        )
        shards = [ShardJob(sweep, Shard(number, jobs)) for number in range(1, jobs + 1)]
        submitted = executor.submit_array(shards)
    except (FailedSubmissionError, RuntimeError, OSError) as error:
        raise MachineError(f"Slurm must take the jobs, but: {error}") from None
    failed = []
    for job in submitted:
        try:
            job.result()
        except UncompletedJobError as error:
            traceback = str(error).partition("Traceback")[2].partition("\n---")[0].strip()  # of what the job raised, if it did
            failed.append((job.job_id, traceback.splitlines()[-1] if traceback else str(error).splitlines()[0]))
    if failed:
        job, reason = failed[0]
        raise WorkerError(f"{len(failed)} of {jobs} jobs failed, the first {job}: {reason}; their logs are in {logs}.")
