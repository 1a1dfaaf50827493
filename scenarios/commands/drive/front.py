"""`foreride front`: options and execution of `scenarios.tables.front`, which prints the fronts."""

import argparse
import importlib


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute; by name, as the tables use this package's console."""
    importlib.import_module("foreride.scenarios.tables.front").configure(command)
