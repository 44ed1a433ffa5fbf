"""The verdict on a run: whether its method added energy, what speaks against it, and why it failed."""

from dataclasses import replace

from anet_lumped.results.run import STATUS, Run
from integrators.system import DIVERGED, UNCONVERGED

from .energy_gain import GAINED, flag_energy_gain
from .failure_messages import with_cause
from .run_warnings import warnings_of


def judged(run: Run, limit: float, adaptive: bool) -> Run:
    """A run with its status, its warnings and the cause of its failure.

    Parameters
    ----------
    run : Run
    limit : float [s], largest stable step that was predicted for its method
    adaptive : bool, whether its steps were chosen by a tolerance
    """
    if run.ok:
        run = flag_energy_gain(run, limit, adaptive)
    if run.ok:
        found = warnings_of(run, adaptive)
        run = replace(run, warnings=run.warnings + found) if found else run
    return with_cause(run) if run.status in (STATUS[DIVERGED], STATUS[UNCONVERGED], GAINED) else run
