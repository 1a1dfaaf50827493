"""Command lines: a parser whose messages are one printable line, and streams that can print any text."""

import argparse
import os
import sys
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, redirect_stdout
from pathlib import Path
from typing import Any, NoReturn

from foreride.files.errors import InputError, abridged, printable, shown

STDOUT = "-"
"""File name that stands for standard output."""
_STDOUT_DEVICE = Path("/dev/stdout")


class WholeWords(argparse.HelpFormatter):
    """Help whose lines break between words only."""

    def _split_lines(self, text: str, width: int) -> list[str]:
        return textwrap.wrap(" ".join(text.split()), width, break_long_words=False, break_on_hyphens=False)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        lines = self._split_lines(text, width - len(indent))
        return "\n".join(f"{indent}{line}" for line in lines)


class Parser(argparse.ArgumentParser):
    """ArgumentParser that reports invalid arguments in one short printable line.

    A surplus argument is reported by the parser of the subcommand that it was given to.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"formatter_class": WholeWords} | options)
        self.set_defaults(innermost=self)

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse the arguments; exit with code 2 if any is invalid."""
        parsed, surplus = self.parse_known_args(args, namespace)
        if surplus:
            parsed.innermost.error(f"takes no {', '.join(map(shown, surplus))}")
        del parsed.innermost
        return parsed

    def error(self, message: str) -> NoReturn:
        """Print the message; exit with code 2."""
        command, _, subcommand = self.prog.partition(" ")
        place = f"{subcommand}: " if subcommand else ""
        told = f"{place}{abridged(printable(message), 400)}; `{self.prog} --help` lists the options"
        self.exit(2, f"{command}: {told}\n")


def output_path(text: str) -> Path:
    """Path of an output file, as the type of an option; `-` is standard output."""
    return _STDOUT_DEVICE if text == STDOUT else Path(text)


@contextmanager
def stdout_kept_for(arguments: Sequence[str]) -> Iterator[None]:
    """Send what is printed to stderr if one of the arguments names standard output as an output file."""
    named = any(text == STDOUT or (text.startswith("--") and text.endswith("=-")) for text in arguments)
    with redirect_stdout(sys.stderr) if named else nullcontext():
        yield


def notify(message: object) -> None:
    """Print a message on stderr: one printable line behind the program's name."""
    print(f"foreride: {abridged(printable(message))}", file=sys.stderr, flush=True)


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
