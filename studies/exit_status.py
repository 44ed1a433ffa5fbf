"""How the program ends: its exit status, and one sentence on what went wrong."""

import sys

import typer

from studies.telling import tell, tell_lines

UsageError = typer.BadParameter.__base__  # which Typer does not export


def exit_status(app, arguments):
    """Exit status of a command of an application of Typer, with one sentence on what went wrong.

    2 is for all that the user can put right: what is written on the command line, in a scene, in any file, a scene that cannot
    hang in rest, a file or folder that cannot be read or written. 1 is for what was asked for rightly and not reached: a run that
    diverges, a rest or a recommendation that the search did not find, rows that failed, memory, processes
    or other things that the machine does not give.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        return app(arguments or ["--help"], prog_name="anet-lumped", standalone_mode=False) or 0
    except typer.Abort:  # Ctrl-C
        return 130
    except UsageError as error:
        told = error.format_message()
        if not told or error.ctx is None:
            tell(told)
        else:
            tell(f"{told.rstrip('.?')}; {error.ctx.command_path} --help tells more.")
        return 2
    except MemoryError as error:
        tell(f"The memory of this machine does not hold what this takes. {error}".rstrip())
        return 1
    except OSError as error:
        tell(f"{error.filename or 'The system refused what this takes'}: {error.strerror or error}.")
        return 2 if error.filename else 1
    except (ValueError, RuntimeError, ModuleNotFoundError) as error:
        missing = isinstance(error, ModuleNotFoundError) and error.name is None  # an extra: Python itself tells the module's name
        if type(error).__module__.partition(".")[0] not in ("anet_lumped", "studies") and not missing:
            raise
        tell_lines(error)
        return 2 if isinstance(error, ValueError) else 1
