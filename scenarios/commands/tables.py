"""Output of comparison tables: terminal, JSON, Parquet, Markdown, LaTeX."""

import argparse
from collections.abc import Sequence
from typing import Any

from foreride.files.command_line import output_path
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_bytes, write_text
from foreride.files.writing.sharing import shared_target
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import comma_list
from foreride.scenarios.comparison.columns import check_keys
from foreride.scenarios.comparison.document import document, parquet
from foreride.scenarios.comparison.publication import caption, latex, markdown
from foreride.scenarios.comparison.statistics import Row, pick, summarise, variants_of
from foreride.scenarios.comparison.table import comparison
from foreride.scenarios.runs.car_notes import car_notes
from foreride.scenarios.runs.write import environment, to_json

DEFAULT_BASELINE = "passive"


def add_table_options(command: argparse.ArgumentParser) -> None:
    """Add the options for the baseline of the effects and for output files of the table."""
    told = f"reference of the effects, such as mpc_preview@oracle (default {DEFAULT_BASELINE})"
    command.add_argument("--baseline", metavar="NAME[@PERCEPTION]", help=told)
    told = "J, captured, seeds, fallbacks, any metric (`foreride list metrics`) or its ratio, wk_rms/baseline"
    command.add_argument("--columns", type=_columns, metavar="A,B,...", help=told)
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


def _columns(text: str) -> list[str]:
    keys = comma_list(text)
    try:
        check_keys(keys)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error).removeprefix("--columns ")) from None
    return keys


def publish(
    arguments: argparse.Namespace, cases: Sequence[Case], rows: Sequence[Row], title: str = ""
) -> dict[str, Any]:
    """Print the table of the cases' rows and write the requested files; return the JSON document."""
    baseline = baseline_of(arguments.baseline, variants_of(rows))
    variants = summarise(rows, baseline)
    keys, text = arguments.columns, caption(cases, baseline)
    console.print(comparison(variants, title, console.width, baseline, keys))
    for note in car_notes(cases):
        console.print(note, highlight=False, soft_wrap=True)
    table_document = document(rows, variants, baseline, environment())
    if arguments.json:
        write_text(arguments.json, to_json(table_document) + "\n")
    if arguments.parquet:
        write_bytes(arguments.parquet, parquet(rows))
    if arguments.markdown:
        write_text(arguments.markdown, markdown(variants, baseline, keys, text))
    if arguments.latex:
        write_text(arguments.latex, latex(variants, baseline, keys, text))
    files = (arguments.json, arguments.parquet, arguments.markdown, arguments.latex)
    named = [str(path) for path in files if path and path.is_file()]
    if named:
        console.print(f"numbers: {', '.join(named)}")
    return table_document
