"""Output of comparison tables: terminal, JSON, Parquet, Markdown, LaTeX."""

import argparse
from collections.abc import Sequence
from typing import Any

from foreride.files.command_line import output_path
from foreride.files.writing.atomic import write_bytes, write_text
from foreride.files.writing.sharing import shared_target
from foreride.scenarios.commands.console import console
from foreride.scenarios.comparison.document import document, parquet
from foreride.scenarios.comparison.statistics import Row, pick, summarise, variants_of
from foreride.scenarios.comparison.table import comparison, latex, markdown
from foreride.scenarios.runs.write import environment, to_json

DEFAULT_BASELINE = "passive"


def add_table_options(command: argparse.ArgumentParser) -> None:
    """Add the options for the baseline of the effects and for output files of the table."""
    told = f"reference of the effects, such as mpc_preview@oracle (default {DEFAULT_BASELINE})"
    command.add_argument("--baseline", metavar="NAME[@PERCEPTION]", help=told)
    for option, told in (
        ("--parquet", "write one row per run as Parquet"),
        ("--markdown", "write the table as Markdown"),
        ("--latex", "write the table as LaTeX (booktabs)"),
    ):
        command.add_argument(option, type=output_path, metavar="FILE", help=f"{told}; - is standard output")


def baseline_of(requested: str | None, variants: Sequence[tuple[str, str]]) -> str | None:
    """Return the requested baseline, checked; by default the passive car if it runs, else none."""
    if requested is not None:
        controller, at, perception = requested.partition("@")
        pick(requested, variants)
        return shared_target(controller) + at + perception
    return DEFAULT_BASELINE if any(controller == DEFAULT_BASELINE for controller, _ in variants) else None


def publish(arguments: argparse.Namespace, rows: Sequence[Row], title: str = "") -> dict[str, Any]:
    """Print the table of the rows and write the requested files; return the JSON document."""
    baseline = baseline_of(arguments.baseline, variants_of(rows))
    variants = summarise(rows, baseline)
    console.print(comparison(variants, title, console.width, baseline))
    table_document = document(rows, variants, baseline, environment())
    if arguments.json:
        write_text(arguments.json, to_json(table_document) + "\n")
    if arguments.parquet:
        write_bytes(arguments.parquet, parquet(rows))
    if arguments.markdown:
        write_text(arguments.markdown, markdown(variants, baseline))
    if arguments.latex:
        write_text(arguments.latex, latex(variants, baseline))
    files = (arguments.json, arguments.parquet, arguments.markdown, arguments.latex)
    if any(files):
        console.print(f"numbers: {', '.join(str(path) for path in files if path)}")
    return table_document
