"""Command lines: a parser whose messages are one printable line, and streams that can print any text."""

import argparse
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from foreride.files.errors import InputError, abridged, printable, shown


class Parser(argparse.ArgumentParser):
    """ArgumentParser that reports invalid arguments in one short printable line."""

    def error(self, message: str) -> NoReturn:
        """Print the message; exit with code 2."""
        self.exit(2, f"{self.prog}: {abridged(printable(message), 400)}; --help lists the options\n")


def check_texts(arguments: Sequence[str]) -> None:
    """Raise InputError for an argument that no shell can pass: NUL, or a surrogate that is no byte's."""
    for argument in arguments:
        try:
            os.fsencode(argument)
        except UnicodeEncodeError:
            raise InputError(f"arguments must be text, got {shown(argument)}") from None
        if "\0" in argument:
            raise InputError(f"arguments must not hold NUL characters, got {shown(argument)}")


def tolerant_streams() -> None:
    """Let stdout and stderr escape what their encoding lacks instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def silence_stdout() -> None:
    """Discard what is still written to stdout, so that Python's last flush at exit cannot fail."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)
