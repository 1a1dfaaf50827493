"""Command line `foreride`: parsing, dispatch, and invalid input as one line with exit code 2."""

import argparse
import importlib
import os
import sys
import traceback
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from foreride.files.collector import unsearched
from foreride.files.command_line import (
    Parser,
    check_texts,
    notify,
    silence_stdout,
    stdout_kept_for,
    tolerant_streams,
)
from foreride.files.errors import InputError, nearest, printable, shortened, shown
from foreride.scenarios.commands import COMMANDS

CHECK_FAILED = 1
BAD_INPUT = 2
INTERNAL_ERROR = 70  # EX_SOFTWARE of sysexits.h
INTERRUPTED = 130
BROKEN_PIPE = 141
"""As a shell gives for a program that SIGPIPE ends."""
TRACEBACK = "FORERIDE_TRACEBACK"
"""Environment variable that, set to anything, shows the traceback of an internal error."""


def parser(only: str | None = None) -> argparse.ArgumentParser:
    """Build the parser of the command line, with the options of all commands or of `only` one.

    The module of a command, and with it the libraries of the simulation, is imported to get its options.
    """
    top = Parser(
        prog="foreride",
        description="Closed-loop simulation of a suspension that sees the road before the wheels reach it.",
    )
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    top.add_argument("--version", action="version", version=f"foreride {version('foreride')}")
    for name, (module, summary) in COMMANDS.items():
        command = commands.add_parser(name, help=summary)
        if only in (None, name):
            importlib.import_module(f"foreride.scenarios.commands.{module}").configure(command)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return 0 for success, 1 for a failed check, 2 for invalid input or too little memory.

    An interrupt gives 130, a reader of the output that ends early, such as `head`, 141, and a programming
    error 70 (its traceback if `TRACEBACK` is set in the environment).
    """
    tolerant_streams()
    try:
        try:
            return _execute(sys.argv[1:] if argv is None else argv)
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except InputError as error:
        return _failure(error, BAD_INPUT)
    except BrokenPipeError:
        silence_stdout()
        return BROKEN_PIPE
    except OSError as error:
        prefix = f"{error.filename}: " if error.filename else ""
        return _failure(f"{prefix}{error.strerror or error}", BAD_INPUT)
    except MemoryError:
        return _failure("needs more memory than there is", BAD_INPUT)
    except KeyboardInterrupt:
        return _failure("interrupted", INTERRUPTED)
    except Exception as error:
        if os.environ.get(TRACEBACK):
            raise
        return _failure(internal_error(error), INTERNAL_ERROR)


def _execute(argv: Sequence[str]) -> int:
    check_texts(argv)
    name = next((argument for argument in argv if not argument.startswith("-")), "")
    if name and name not in COMMANDS:
        known = ", ".join(COMMANDS)
        raise InputError(f"COMMAND must be one of {known}, got {shown(name)}{nearest(name, COMMANDS)}")
    with unsearched():
        arguments = parser(name).parse_args(argv)
        from foreride.scenarios.commands.outputs import check_outputs
        from foreride.scenarios.comparison.parallel import WorkerDied

    try:
        check_outputs(arguments)
        with stdout_kept_for(argv):
            return int(arguments.execute(arguments) or 0)
    except WorkerDied as error:
        return _failure(error, CHECK_FAILED)


def internal_error(error: Exception) -> str:
    """Message for a programming error: its type and location, and the way to see more."""
    frame = traceback.extract_tb(error.__traceback__)[-1]
    location = f"{Path(frame.filename).name}:{frame.lineno}"
    description = shortened(printable(f"{type(error).__name__}: {error}"), 200)
    return f"internal error, {description} ({location}); {TRACEBACK}=1 shows the traceback, please report it"


def _failure(error: object, status: int) -> int:
    notify(error)
    return status


if __name__ == "__main__":
    sys.exit(main())
