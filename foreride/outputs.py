"""Reports and parameter studies from Python."""

from pathlib import Path

import pyarrow as pa

from foreride.results import Comparison, Result


def report(source: Result | Comparison | Path | str, out: Path | str) -> Path:
    """Write one HTML file with tables and a replay, and return its path.

    source: a result, a comparison, or the path of a run folder or of a folder of them.
    """
    from foreride.files.writing.atomic import write_text
    from foreride.scenarios.report.gather import ReportInput, collect_input
    from foreride.scenarios.report.html import page

    if isinstance(source, Result):
        source = Comparison((source,))
    if isinstance(source, Comparison):
        gathered = ReportInput(tuple(result.record for result in source), tuple(source.rows))
    else:
        gathered = collect_input(Path(source))
    write_text(Path(out), page(gathered))
    return Path(out)


def sweep(study: Path | str, out: Path | str, jobs: int = 1, scheduler: str | None = None) -> pa.Table:
    """Drive what is missing of a study and return all its rows, one a drive.

    study: a YAML file. out: folder of the results, which a later call completes. jobs: worker processes on
    this machine (with more than one, needs the extra `sweep`, and in a script `if __name__ == "__main__":`).
    scheduler: address of a Dask cluster instead. Raises InputError for an invalid study.
    """
    from foreride.scenarios.studies.complete import complete

    return complete(Path(study), Path(out), jobs, scheduler)
