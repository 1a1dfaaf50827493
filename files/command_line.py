"""Command-line parser whose messages are as printable and short as those for files."""

import argparse
from typing import NoReturn

from files.errors import abridged, printable


class Parser(argparse.ArgumentParser):
    """ArgumentParser that makes quoted arguments printable and short."""

    def error(self, message: str) -> NoReturn:
        """Print usage and message; exit with code 2."""
        super().error(abridged(printable(message), 400))
