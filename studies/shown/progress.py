"""Progress of a report on stderr: which study runs, how many of how many are done, and the time that it has taken."""

from contextlib import contextmanager

from studies.shown.page import State


@contextmanager
def report_progress(tell):
    """Within it, what the caller of `write_report` gives it as `tell`: a bar on a terminal, and a line a study that has ended.

    Parameters
    ----------
    tell : writes one line on stderr
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = SpinnerColumn(), "{task.description}", BarColumn(), MofNCompleteColumn(), "studies", TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("report", total=None)
        running = []

        def told(now):
            number = f"{now.number} of {now.total}, {now.name}"
            if now.state is State.RUNNING:
                running.append(now.name)
                progress.update(task, description=", ".join(running), total=now.total)
                if not console.is_terminal:
                    tell(f"{number} ...")
            else:
                running.remove(now.name)
                progress.update(task, description=", ".join(running), advance=1)
                tell(f"{number}: {now.seconds:.1f} s" if now.state is State.DONE else f"{number}: failed, {now.reason}")

        yield told
