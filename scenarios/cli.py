"""Command line `foreride`: parsing, dispatch, and invalid input as one line with exit code 2."""

import argparse
import sys
from collections.abc import Sequence

from files.command_line import Parser
from files.errors import InputError, abridged, printable
from scenarios.commands import (
    bound,
    calibrate,
    compare,
    demo,
    detector,
    doctor,
    perception,
    regress,
    render,
    report,
    road,
    run,
    sweep,
    tune,
    validation,
)
from scenarios.parallel import WorkerDied

CHECK_FAILED = 1
BAD_INPUT = 2


def parser() -> argparse.ArgumentParser:
    """Build the parser of the whole command line."""
    top = Parser(
        prog="foreride",
        description="What a car gains when its suspension sees the road before the wheels reach it.",
    )
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in (
        demo,
        run,
        compare,
        sweep,
        regress,
        bound,
        tune,
        perception,
        calibrate,
        render,
        report,
        road,
        detector,
        validation,
        doctor,
    ):
        command.add(commands)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return 0 for success, 1 for a failed check, 2 for invalid input."""
    arguments = parser().parse_args(argv)
    try:
        return int(arguments.execute(arguments) or 0)
    except InputError as error:
        return _told(error, BAD_INPUT)
    except WorkerDied as error:
        return _told(error, CHECK_FAILED)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        return _told(f"{place}{error.strerror or error}", BAD_INPUT)
    except KeyboardInterrupt:
        print("foreride: interrupted", file=sys.stderr)
        return 130


def _told(error: object, status: int) -> int:
    print(f"foreride: {abridged(printable(error))}", file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
