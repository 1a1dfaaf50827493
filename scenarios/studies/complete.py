"""Completion of a study's results: the drives that are missing, and their simulation."""

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa

from foreride.files.errors import InputError
from foreride.files.reading.numbers import within
from foreride.files.writing.folder import claim, exclusive
from foreride.scenarios.studies.results import KIND, Results, load_results
from foreride.scenarios.studies.study import Sample, read
from foreride.scenarios.studies.sweep import cluster, run, simulate_sample


def missing_samples(
    samples: Mapping[str, Sample], results: Results, retry_failed: bool = False
) -> list[Sample]:
    """Samples, by their keys, without a result; failed ones as well if they are to be tried again.

    Raises InputError if the results are those of another study.
    """
    if results.done and not results.done.keys() & samples.keys():
        raise InputError(f"{results.folder}: holds the results of another study; choose another --out")
    failed = {key for key, error in results.done.items() if error} if retry_failed else set()
    return [sample for key, sample in samples.items() if key not in results.done or key in failed]


def complete(study: Path, out: Path, jobs: int = 1, scheduler: str | None = None) -> pa.Table:
    """Simulate the missing drives of a study and return all rows of `out`.

    One job runs in this process; more run on a Dask cluster, as does any number with a scheduler's address.
    """
    within("jobs", jobs, 1, 1024)
    samples = {sample.key: sample for sample in read(study)}
    with exclusive(claim(out, KIND)):
        results = Results(out)
        missing = missing_samples(samples, results)
        try:
            if scheduler is None and jobs == 1:
                for sample in missing:
                    results.add(simulate_sample(sample))
            elif missing:
                with cluster(scheduler, min(jobs, len(missing))) as client:
                    run(client, missing, results)
        finally:
            results.flush()
        return load_results(out)
