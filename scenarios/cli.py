"""The `foreride` command: parses, dispatches, and turns bad input into one line and exit code 2."""

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
    """The whole command line."""
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
    """Run one command; returns 0 for success, 1 when a check failed, 2 for bad input."""
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
