"""Study files: the variation of scenario fields, and the resulting list of drives."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from foreride.controller.registry import uses_preview
from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked, Seed, check_field
from foreride.files.reading.regular_file import read_text
from foreride.files.reading.yaml12 import parse
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.overrides import split_path
from foreride.scenarios.runs.write import digest
from foreride.scenarios.simulation.referenced_files import check_case_files
from foreride.scenarios.studies.axis import Axis, Scalar, read_axis, scalar

MAX_DRIVES = 1_000_000
"""Maximum number of drives of a study."""
MAX_SAMPLED_VALUES = 20_000_000
"""Maximum number of sampled values of varied fields."""
TRIAL_SAMPLES = 20
"""Number of samples of each kind of which at least one must be valid, else the study is refused."""


@dataclass(frozen=True)
class Study(Checked):
    """Study file without its axes. `samples` applies to every sampling except the grid."""

    scenarios: tuple[str, ...]
    title: str = ""
    controllers: tuple[str, ...] = ("passive", "mpc_preview")
    perception: tuple[str, ...] = ("oracle",)
    seeds: tuple[Seed, ...] = (0,)
    sampling: Literal["grid", "latin_hypercube", "sobol", "monte_carlo"] = "grid"
    samples: Annotated[int, Interval(ge=0, le=MAX_DRIVES), "samples"] = 0
    seed: Seed = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("scenarios", "controllers", "perception", "seeds"):
            if not getattr(self, name):
                raise InputError(f"{name} must not be empty")
        if self.sampling == "grid" and self.samples:
            raise InputError(f"samples must be left out for a grid, got {self.samples}")
        if self.sampling != "grid" and not self.samples:
            raise InputError(f"samples must lie in 1 ... {MAX_DRIVES} for {self.sampling}, got 0")
        if self.sampling == "sobol" and self.samples & (self.samples - 1):
            raise InputError(f"samples must be a power of two for sobol, got {self.samples}")


@dataclass(frozen=True)
class Sample:
    """Sample of a study: one drive as plain values, which can be sent to any worker."""

    scenario: str
    point: tuple[tuple[str, Scalar], ...]
    controller: str
    perception: str
    seed: int

    @property
    def key(self) -> str:
        """Content hash that identifies the drive across sessions."""
        name = Path(self.scenario).name
        return digest([name, self.point, self.controller, self.perception, self.seed])[:20]

    def case(self) -> Case:
        """Return the case to simulate."""
        return Case(load(self.scenario, dict(self.point)), self.controller, self.perception, self.seed)


def read(path: Path) -> list[Sample]:
    """Read the drives of a study file; InputError, in one line, if it is malformed."""
    mapping = parse(read_text(path), str(path))
    if not isinstance(mapping, dict):
        raise InputError(f"{path}: a study must be a mapping of fields, got {type(mapping).__name__}")
    constants, variations = (
        _field_mapping(mapping.pop(name, None) or {}, f"{path}: {name}") for name in ("set", "vary")
    )
    study = strict.structure(Study, mapping, str(path))
    axes = {field: read_axis(given, f"{path}: vary.{field}") for field, given in variations.items()}
    for field, value in constants.items():
        scalar(value, f"{path}: set.{field}")
    try:
        _check_size(study, axes)
        samples = list(_samples(study, points(study, axes), constants, path.parent))
        extremes = {field: _extremes(field, samples) for field in axes}
        for kind in dict.fromkeys((s.scenario, s.controller, s.perception) for s in samples):
            of_kind = [s for s in samples if (s.scenario, s.controller, s.perception) == kind]
            case = _valid_case(of_kind[:TRIAL_SAMPLES])
            for field, values in extremes.items():
                for value in values:
                    check_field(case.scenario, split_path(field), f"vary.{field}", value)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return samples


def _valid_case(samples: Sequence[Sample]) -> Case:
    """Case of the first valid sample, of which there must be one; invalid ones become rows with an error."""
    errors = []
    for sample in samples:
        try:
            check_case_files(case := sample.case())
            return case
        except InputError as error:
            errors.append(error)
    raise errors[0]


def _extremes(field: str, samples: Sequence[Sample]) -> list[Scalar]:
    """Smallest and largest number that a varied field takes; none if it takes no numbers."""
    values = {dict(sample.point)[field] for sample in samples}
    numbers = [value for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
    return sorted({min(numbers), max(numbers)}) if numbers else []


def _check_size(study: Study, axes: Mapping[str, Axis]) -> None:
    """Reject a study of more than `MAX_DRIVES` by count, before any of its drives is listed."""
    perceptions = sum(len(study.perception) if uses_preview(name) else 1 for name in study.controllers)
    grid = prod(max(len(axis.values), 1) for axis in axes.values())
    drives = (
        (grid if study.sampling == "grid" else study.samples)
        * len(study.scenarios)
        * len(study.seeds)
        * perceptions
    )
    if drives > MAX_DRIVES:
        raise InputError(f"a study must have at most {MAX_DRIVES} drives, got {shown(drives)}")
    if study.sampling != "grid" and study.samples * len(axes) > MAX_SAMPLED_VALUES:
        raise InputError(f"samples times the fields of vary must be <= {MAX_SAMPLED_VALUES}")


def points(study: Study, axes: Mapping[str, Axis]) -> list[dict[str, Scalar]]:
    """Sample points of the study in the space of the varied fields."""
    if study.sampling == "grid":
        for field, axis in axes.items():
            if not axis.values:
                raise InputError(f"vary.{field} must give values for a grid")
        product_points = product(*(axis.values for axis in axes.values()))
        return [dict(zip(axes, values, strict=True)) for values in product_points]
    if not axes:
        raise InputError(f"vary must name a field for {study.sampling}")
    return [
        {
            field: axis.quantile(float(probability))
            for (field, axis), probability in zip(axes.items(), row, strict=True)
        }
        for row in _unit_cube(study, len(axes))
    ]


def _unit_cube(study: Study, dimensions: int) -> NDArray[np.float64]:
    """Sample points in the unit cube, (samples, dimensions) in [0, 1), from `study.seed`."""
    from scipy.stats import qmc  # slow to import

    rng = np.random.default_rng(study.seed)
    if study.sampling == "monte_carlo":
        return rng.random((study.samples, dimensions))
    kind = qmc.Sobol if study.sampling == "sobol" else qmc.LatinHypercube
    return np.asarray(kind(dimensions, rng=rng).random(study.samples))


def _samples(
    study: Study, space: Sequence[Mapping[str, Scalar]], fixed: Mapping[str, Scalar], folder: Path
) -> Iterator[Sample]:
    if len({Path(name).name for name in study.scenarios}) < len(set(study.scenarios)):
        raise InputError("scenarios must differ in their files' names, got two of one name")
    scenarios = [str(folder / name) if os.path.isfile(folder / name) else name for name in study.scenarios]
    perceptions = {name: study.perception if uses_preview(name) else ("none",) for name in study.controllers}
    for point, scenario, seed, controller in product(space, scenarios, study.seeds, study.controllers):
        for perception in perceptions[controller]:
            yield Sample(scenario, tuple((dict(fixed) | dict(point)).items()), controller, perception, seed)


def _field_mapping(mapping: Any, location: str) -> dict[str, Any]:
    if not isinstance(mapping, dict):
        raise InputError(f"{location} must be a mapping of path.to.field to values, got {shown(mapping)}")
    return mapping
