"""The parser of command lines, whose refusals are as printable and short as those of files."""

import argparse
from typing import NoReturn

from files.errors import abridged, printable


class Parser(argparse.ArgumentParser):
    """argparse's parser; what it repeats of the arguments is made printable and short."""

    def error(self, message: str) -> NoReturn:
        """Print usage and message, end with exit code 2."""
        super().error(abridged(printable(message), 400))
