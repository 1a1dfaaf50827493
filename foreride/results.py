"""Results of drives: metrics, signals with units, tables for pandas and Arrow, and views in notebooks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from foreride.files.errors import InputError
from foreride.notebook import result_view, table
from foreride.scenarios.comparison.document import flat
from foreride.scenarios.comparison.publication import caption, cells, latex, markdown
from foreride.scenarios.comparison.statistics import Variant, summarise, variants_of
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.runs.write import folder_name, row, signal_table, write
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.state import signal_unit

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Result:
    """Result of one drive.

    record: all that the drive produced, as foreride's own code uses it; not part of the public interface.
    """

    record: Run

    @property
    def scenario(self) -> Scenario:
        """The scenario that was driven."""
        return self.record.case.scenario

    @property
    def controller(self) -> str:
        """Name of the controller."""
        return self.record.case.controller

    @property
    def perception(self) -> str:
        """Name of the perception."""
        return self.record.case.perception

    @property
    def seed(self) -> int:
        """Seed of all random numbers of the drive."""
        return self.record.case.seed

    @property
    def metrics(self) -> Mapping[str, float]:
        """Ride metrics by name, SI units (see `foreride.comfort.METRICS`)."""
        return self.record.metrics

    @property
    def signals(self) -> Mapping[str, np.ndarray]:
        """Signals by name, one value each millisecond; names that end in `_0`, `_1` ... belong to a wheel."""
        return self.record.signals

    @cached_property
    def units(self) -> Mapping[str, str]:
        """Unit of each signal, such as `m/s²`."""
        return {name: signal_unit(name) for name in self.signals}

    @property
    def events(self) -> list[dict[str, Any]]:
        """Detections, fallbacks and binding constraints in order of time."""
        return self.record.events

    @property
    def fallbacks(self) -> int:
        """Number of steps in which a fallback replaced the controller."""
        return int(self.record.solver.get("fallbacks", 0))

    def to_arrow(self) -> pa.Table:
        """The signals as an Arrow table; the unit of each column stands in its field's metadata."""
        return signal_table(self.signals)

    def to_pandas(self) -> "pd.DataFrame":
        """The signals as a DataFrame indexed by time (s); units in `.attrs["units"]`. Needs pandas."""
        frame = _pandas().DataFrame(dict(self.signals)).set_index("time_s")
        frame.attrs["units"] = dict(self.units)
        return frame

    def save(self, folder: Path | str) -> Path:
        """Write the run folder that `foreride run --out` writes, and return its path."""
        write(self.record, Path(folder))
        return Path(folder)

    def report(self, out: Path | str) -> Path:
        """Write one HTML file with tables and a replay, and return its path."""
        from foreride.outputs import report

        return report(self, out)

    def __repr__(self) -> str:
        case = self.record.case
        named = f"{case.scenario.name}, {case.controller}, {case.perception}, seed {case.seed}"
        return f"<foreride.Result {named}: J {self.metrics['objective']:.4f} (m/s²)²>"

    def _repr_html_(self) -> str:
        """Traces and table of the metrics, for notebooks."""
        return result_view(self)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Results of several drives, in the order in which they were asked for.

    baseline: the controller that effects are relative to, or None.
    """

    results: tuple[Result, ...]
    baseline: str | None = None

    def __iter__(self) -> Iterator[Result]:
        return iter(self.results)

    def __len__(self) -> int:
        return len(self.results)

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """One nested mapping a drive, as in the JSON file of `foreride compare`."""
        return [row(result.record) for result in self.results]

    @cached_property
    def variants(self) -> list[Variant]:
        """Means over seeds with confidence intervals, and effects relative to the baseline."""
        return summarise(self.rows, self.baseline)

    def to_arrow(self) -> pa.Table:
        """One row a drive: metrics under their own names, the rest under dotted ones."""
        return pa.Table.from_pylist([flat(one) for one in self.rows])

    def to_pandas(self) -> "pd.DataFrame":
        """One row a drive, as a DataFrame. Needs pandas."""
        return _pandas().DataFrame([flat(one) for one in self.rows])

    @property
    def caption(self) -> str:
        """Conditions of the drives and the meaning of the table's numbers, in sentences."""
        return caption([result.record.case for result in self.results], self.baseline)

    def to_markdown(self, columns: Sequence[str] | None = None) -> str:
        """The table in Markdown under its caption; `columns` as for `foreride compare --columns`."""
        return markdown(self.variants, self.baseline, columns, self.caption)

    def to_latex(self, columns: Sequence[str] | None = None) -> str:
        """The table in LaTeX (package booktabs) with its caption; `columns` as in Markdown."""
        return latex(self.variants, self.baseline, columns, self.caption)

    def save(self, folder: Path | str) -> Path:
        """Write a run folder for each drive into `folder`, and return its path."""
        for result in self.results:
            result.save(Path(folder) / folder_name(result.record.case))
        return Path(folder)

    def report(self, out: Path | str) -> Path:
        """Write one HTML file with tables and replays, and return its path."""
        from foreride.outputs import report

        return report(self, out)

    def __repr__(self) -> str:
        pairs = ", ".join("@".join(pair) for pair in variants_of(self.rows))
        return f"<foreride.Comparison of {len(self)} drives: {pairs}>"

    def _repr_html_(self) -> str:
        """Table of the comparison, for notebooks."""
        return table(*cells(self.variants, self.baseline))


def _pandas() -> Any:
    try:
        import pandas
    except ImportError:
        raise InputError("to_pandas() needs pandas: pip install pandas; to_arrow() needs nothing") from None
    return pandas
