"""Pytest plugin with the fixture `ride_comfort`: ride metrics of a scenario against a committed baseline.

Every test has its own baseline, `ride_baselines/<module>-<test>.json` beside the test's file, which
`pytest --ride-accept` writes.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:  # every pytest run imports this file; only tests with the fixture need the rest
    from foreride.scenarios.definition.overrides import Overrides
    from foreride.scenarios.simulation.simulate import Run


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--ride-accept`."""
    help_text = "write what ride_comfort measures as the new baselines"
    parser.getgroup("foreride").addoption("--ride-accept", action="store_true", help=help_text)


@pytest.fixture
def ride_comfort(request: pytest.FixtureRequest) -> RideComfort:
    """Fixture to call with a scenario; the test fails if a ride metric exceeds its tolerance."""
    name = re.sub(r"[^\w.-]+", "_", request.node.name)
    file = request.path.parent / "ride_baselines" / f"{request.path.stem}-{name}.json"
    return RideComfort(file, request.config.getoption("--ride-accept"))


class RideComfort:
    """Regression check: `ride_comfort("hump_flat_30", controller="mpc_preview")` returns the checked run."""

    def __init__(self, file: Path, accept: bool) -> None:
        self._file, self._accept = file, accept

    def __call__(
        self,
        scenario: str,
        controller: str = "mpc_preview",
        perception: str = "oracle",
        seed: int = 0,
        overrides: Overrides = (),
        tolerances: Mapping[str, float] | None = None,
    ) -> Run:
        """Simulate and check one case.

        `scenario`, `controller`: as on the command line, files relative to the test's folder; `overrides`: a
        mapping of fields to values; `tolerances`: absolute ones (SI) in place of the default ones.
        """
        from foreride.scenarios.definition.overrides import collect_overrides
        from foreride.scenarios.regression.baseline import Baseline, BaselineEntry, read, write
        from foreride.scenarios.regression.tolerances import (
            Tolerance,
            baseline_values,
            change_lines,
            changes,
            failed,
            label,
        )
        from foreride.scenarios.simulation.simulate import simulate

        __tracebackhide__ = True
        requested = BaselineEntry(scenario, collect_overrides(overrides), controller, perception, seed, {})
        texts = requested.override_texts
        case = requested.case(self._file.parent.parent)
        baseline = read(self._file) if self._file.exists() else Baseline()
        run = simulate(case)
        if self._accept:
            write(self._file, baseline.with_entries([replace(requested, metrics=baseline_values(run))]))
            return run
        entry = {item.key: item for item in baseline.entries}.get(requested.key)
        if entry is None:
            pytest.fail(
                f"{self._file}: no baseline of {label(case, texts)} yet; pytest --ride-accept writes it",
                pytrace=False,
            )
        own_tolerances = {metric: Tolerance(value) for metric, value in (tolerances or {}).items()}
        if failed(found := changes(entry.metrics, baseline_values(run), own_tolerances)):
            pytest.fail(
                "\n  ".join([f"{label(case, texts)} rides worse:", *change_lines(found)]),
                pytrace=False,
            )
        if missing := ", ".join(change.metric for change in found if change.before is None):
            warnings.warn(f"{self._file}: lacks {missing}; pytest --ride-accept adds it", stacklevel=2)
        return run
