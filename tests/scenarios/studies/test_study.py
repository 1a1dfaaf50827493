"""Tests of study files: the drives, their distribution, and one-line messages."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import kstest, norm

from foreride.files.errors import InputError
from foreride.scenarios.studies.axis import Axis
from foreride.scenarios.studies.study import Study, points, read

GRID = """
scenarios: [bump_8x40_30]
controllers: [passive, mpc_preview]
perception: [oracle, boxes]
seeds: [0, 1]
set: {vehicle.model: quarter}
vary:
  speed_kmh: [20, 30, 40]
  camera.latency_s: {values: [0.0, 0.1]}
"""


def study_file(folder: Path, text: str) -> Path:
    path = folder / "study.yaml"
    path.write_text(text)
    return path


def test_a_grid_has_every_combination_once(tmp_path: Path) -> None:
    samples = read(study_file(tmp_path, GRID))
    assert len(samples) == 3 * 2 * 2 * (1 + 2)  # speeds, latencies, seeds, passive once and preview twice
    assert len({sample.key for sample in samples}) == len(samples)
    case = samples[-1].case()
    assert case.scenario.vehicle.model == "quarter"
    assert case.scenario.speed_kmh == 40
    assert case.scenario.camera.latency_s == 0.1
    assert (case.controller, case.perception, case.seed) == ("mpc_preview", "boxes", 1)


def test_keys_do_not_depend_on_where_the_study_lies(tmp_path: Path) -> None:
    keys = []
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
        keys.append([sample.key for sample in read(study_file(tmp_path / name, GRID))])
    assert keys[0] == keys[1]


@pytest.mark.parametrize("sampling", ["latin_hypercube", "sobol", "monte_carlo"])
def test_sampled_axes_follow_their_distributions(sampling: str) -> None:
    axes = {
        "even": Axis(low=2.0, high=6.0),
        "log": Axis(low=0.01, high=1.0, scale="log"),
        "normal": Axis(mean=5.0, sigma=0.5),
        "whole": Axis(low=10, high=20, whole=True),
        "choice": Axis(("a", "b")),
    }
    study = Study(("x",), sampling=sampling, samples=512, seed=3)  # type: ignore[arg-type]
    found = points(study, axes)
    columns = {name: [point[name] for point in found] for name in axes}
    assert kstest((np.array(columns["even"]) - 2) / 4, "uniform").pvalue > 0.01
    assert kstest(np.log10(columns["log"]) / 2 + 1, "uniform").pvalue > 0.01
    assert kstest((np.array(columns["normal"]) - 5) / 0.5, norm.cdf).pvalue > 0.01
    assert set(columns["whole"]) == set(range(10, 21))
    assert 0.4 < np.mean([value == "a" for value in columns["choice"]]) < 0.6
    assert points(study, axes) == found


def test_latin_hypercube_and_sobol_put_one_sample_into_each_stratum() -> None:
    for sampling in ("latin_hypercube", "sobol"):
        study = Study(("x",), sampling=sampling, samples=64, seed=1)  # type: ignore[arg-type]
        values = [float(point["a"]) for point in points(study, {"a": Axis(low=0.0, high=64.0)})]
        assert sorted(int(value) for value in values) == list(range(64))


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (("scenarios:", "scenarois:"), ("scenarois", "scenarios")),
        (("[bump_8x40_30]", "[bump_9x40_30]"), ("bump_9x40_30",)),
        (("[bump_8x40_30]", "[]"), ("scenarios", "empty")),
        (("[passive, mpc_preview]", "[pasive]"), ("pasive",)),
        (("[oracle, boxes]", "[radar]"), ("radar",)),
        (("[oracle, boxes]", "[map]"), ("map",)),
        (("set: {", "set: {memory: missing.yaml, "), ("missing.yaml",)),
        (("speed_kmh:", "speed_khm:"), ("speed_khm", "speed_kmh")),
        (("[20, 30, 40]", "[0, 0.5]"), ("speed_kmh", "1 ... 200")),
        (("[20, 30, 40]", "[20, 30, 400]"), ("vary.speed_kmh", "1 ... 200", "400")),
        (("{values: [0.0, 0.1]}", "[0.0, -0.1]"), ("vary.camera.latency_s must lie in 0 ...", "-0.1")),
        (("[20, 30, 40]", "{low: 20, high: 40}"), ("vary.speed_kmh", "values")),
        (("[20, 30, 40]", "{low: 20}"), ("vary.speed_kmh", "low and high")),
        (("[20, 30, 40]", "fast"), ("vary.speed_kmh", "fast")),
        (("seeds: [0, 1]", "sampling: sobol\nsamples: 100"), ("samples", "power of two", "100")),
        (("seeds: [0, 1]", "sampling: sobl\nsamples: 128"), ("sampling", "sobl", "sobol")),
        (("seeds: [0, 1]", "samples: 5"), ("samples", "grid")),
        (("seeds: [0, 1]", "sampling: sobol\nsamples: 1e8"), ("samples", "whole number")),
        (("seeds: [0, 1]", "sampling: monte_carlo\nsamples: 100000000"), ("samples", "0 ... 1000000")),
        (("[20, 30, 40]", f"{[30] * 1000}\n  seed: {[1] * 1000}"), ("at most 1000000 drives, got 12000000",)),
        (("vary:", "vary: 3\nrest:"), ("vary", "mapping")),
        (("scenarios:", "- scenarios:"), ("study.yaml", "line")),
    ],
)
def test_malformed_studies_are_refused_in_one_line(
    tmp_path: Path, edit: tuple[str, str], told: tuple[str, ...]
) -> None:
    assert edit[0] in GRID
    with pytest.raises(InputError) as caught:
        read(study_file(tmp_path, GRID.replace(*edit, 1)))
    message = str(caught.value)
    assert "\n" not in message
    for part in ("study.yaml", *told):
        assert part in message


@pytest.mark.parametrize(
    ("name", "drives"), [("latency_and_speed", 64 * 2 * 3 * 3), ("quarter_car_map", 10_000)]
)
def test_the_example_studies_are_valid(name: str, drives: int) -> None:
    samples = read(Path(__file__).resolve().parents[3] / "examples" / "sweep" / f"{name}.yaml")
    assert len(samples) == drives
    assert all(sample.case().controller == sample.controller for sample in samples[:: drives // 4])
