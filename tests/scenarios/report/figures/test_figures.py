"""Figures: files in three formats, one line per controller whatever the seeds, labels that fit the car."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from foreride.comfort import frequency_weighting
from foreride.scenarios.cases import Case
from foreride.scenarios.cli import main
from foreride.scenarios.comparison.statistics import summarise
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.figures.damper import damper_figure
from foreride.scenarios.report.figures.drive import drive_figure
from foreride.scenarios.report.figures.ensemble import ensembles
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.figures.overview import excerpt, overview_figure
from foreride.scenarios.report.figures.spectrum import spectrum_figure
from foreride.scenarios.report.palette import CONTROLLER_COLOURS
from foreride.scenarios.runs.write import row
from foreride.scenarios.simulation.simulate import Run, simulate
from foreride.vehicle import load as load_module

QUARTER = yaml.safe_load((Path(load_module.__file__).parent / "parameters" / "quarter_car.yaml").read_text())
ROAD = ["road.length_m=14", "road.features.0.start_m=8"]
NUMBER = re.compile(r"[−\d.e-]+")
FIGURES = {"signals": drive_figure, "spectrum": spectrum_figure, "damper": damper_figure}


@cache
def drives(model: str) -> tuple[Run, ...]:
    scenario = load("hump_flat_30", [f"vehicle.model={model}", *ROAD])
    return tuple(
        simulate(Case(scenario, controller, "none", seed))
        for seed in (0, 1, 2)
        for controller in ("skyhook", "passive")
    )


def texts(figure: Figure) -> Iterator[Text]:
    figure.draw_without_rendering()
    return (text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible())


def lines(axis: Axes) -> dict[str, str]:
    return {
        str(line.get_label()): str(line.get_color())
        for line in axis.get_lines()
        if line.get_label()[0] != "_"
    }


@pytest.mark.parametrize("kind", FIGURES)
@pytest.mark.parametrize("model", ["quarter", "half"])
def test_nothing_is_cut_off_and_labels_fit_the_car(kind: str, model: str) -> None:
    figure = FIGURES[kind](drives(model))
    for text in texts(figure):
        if NUMBER.fullmatch(text.get_text()):  # a tick, perhaps one beyond the limits of its axis
            continue
        box = text.get_window_extent()
        assert box.x0 >= 0, text
        assert box.y0 >= 0, text
        assert box.x1 <= figure.bbox.x1 + 1, text
        assert box.y1 <= figure.bbox.y1 + 1, text
    told = " ".join(text.get_text() for text in texts(figure))
    assert ("front" in told) == (model == "half")


def test_three_seeds_give_one_line_a_controller_and_its_range() -> None:
    figure = drive_figure(drives("quarter"))
    acceleration = figure.axes[1]
    assert lines(acceleration) == {name: CONTROLLER_COLOURS[name] for name in ("skyhook", "passive")}
    skyhook = ensembles(drives("quarter"))[0]
    values = np.stack([run.signals["damping_0"] for run in skyhook.runs])
    band = skyhook.signal("damping_0", slice(None))
    assert np.array_equal(band.mean, values.mean(axis=0))
    assert np.array_equal(band.high - band.low, np.ptp(values, axis=0))
    assert np.ptp(values, axis=0).max() > 0
    assert acceleration.collections
    assert "3 seeds" in str(figure.get_supxlabel())


def test_the_overview_shows_the_numbers_of_the_table_and_their_intervals() -> None:
    runs = drives("quarter")
    rows = [row(run) for run in runs]
    figure = overview_figure(rows, {("hump_flat_30", "quarter"): excerpt(runs)}, "passive")
    told = [text.get_text() for text in texts(figure)]
    for variant in summarise(rows, "passive"):
        assert f"{variant.controller}  {variant.ratio['objective'].mean:.3f}" in told
    bars = next(axis for axis in figure.findobj(Axes) if axis.patches)
    skyhook = summarise(rows, "passive")[0].ratio["objective"]
    whiskers = next(line for line in bars.get_lines() if line.get_marker() == "|")
    assert list(whiskers.get_xdata()) == [skyhook.low, skyhook.high]
    assert min(text.get_fontsize() for text in texts(figure)) >= 8


def test_an_overview_of_many_drives_or_without_a_baseline_shows_bars_alone() -> None:
    rows = [row(run) for run in drives("quarter")]
    many = [line | {"scenario": f"road {number}"} for number in range(9) for line in rows]
    figure = overview_figure(many, {}, None)
    assert sum(bool(axis.patches) for axis in figure.findobj(Axes)) == 9
    assert "J ((m/s²)²), 95 % interval" in [text.get_text() for text in texts(figure)]


def test_the_spectrum_is_shaded_by_the_weighting() -> None:
    axis, right = spectrum_figure(drives("half")).axes
    (curve,) = right.get_lines()
    assert np.allclose(curve.get_ydata(), frequency_weighting("Wk", curve.get_xdata()))
    assert lines(axis).keys() == {"skyhook", "passive"}
    assert "Hz" in axis.get_xlabel()
    assert "Hz" in axis.get_ylabel()


@pytest.mark.parametrize("kind", ["ideal", "valve", "mr_bouc_wen"])
def test_a_damper_stays_within_the_limits_drawn_for_it(kind: str, tmp_path: Path) -> None:
    car = tmp_path / "car.yaml"
    car.write_text(yaml.safe_dump(QUARTER | {"damper": {"kind": kind}}))
    scenario = load("hump_flat_30", [f"vehicle.model={car}", *ROAD])
    run = simulate(Case(scenario, "skyhook", "none", 0))
    (axis,) = damper_figure([run]).axes
    (shaded,) = axis.collections
    outline = shaded.get_paths()[0].vertices
    (dots,) = (line for line in axis.get_lines() if line.get_marker() == ".")
    speed, force = dots.get_xdata(), dots.get_ydata()
    fast = np.abs(speed) > (0.02 if kind == "ideal" else 0.2)
    assert fast.any()
    for at, value in zip(speed[fast], force[fast], strict=True):
        near = np.abs(outline[:, 0] - at) < 0.05 * np.abs(outline[:, 0]).max()
        slack = 0.05 * np.abs(outline[:, 1]).max()
        assert outline[near, 1].min() - slack <= value <= outline[near, 1].max() + slack


def test_a_comparison_writes_them_in_three_formats_and_can_leave_them_out(tmp_path: Path) -> None:
    short = tmp_path / "short.yaml"
    short.write_text(
        "title: 5 $ for a hump_\nspeed_kmh: 40\nvehicle: {model: quarter}\n"
        "road: {length_m: 14, features: [{kind: half_sine_bump, start_m: 6, "
        "height_m: 0.05, length_m: 0.5}]}\n"
    )
    asked = ["compare", str(short), "--controllers", "skyhook,passive", "--seeds", "0,1,2"]
    assert main([*asked, "--out", str(tmp_path / "runs")]) == 0
    folder = tmp_path / "runs" / "figures"
    stems = ("overview", "short-damper", "short-signals", "short-spectrum")
    wanted = {f"{stem}.{kind}" for stem in stems for kind in ("pdf", "png", "svg")}
    assert {path.name for path in folder.iterdir()} == wanted
    for stem in stems:
        assert (folder / f"{stem}.pdf").read_bytes().startswith(b"%PDF-")
        assert (folder / f"{stem}.svg").read_text().rstrip().endswith("</svg>")
        assert cv2.imread(str(folder / f"{stem}.png")).shape[1] == 704
    assert main([*asked, "--out", str(tmp_path / "bare"), "--no-figures"]) == 0
    assert not (tmp_path / "bare" / "figures").exists()


def test_a_figure_is_the_same_file_each_time(tmp_path: Path) -> None:
    one, two = (
        save(spectrum_figure(drives("quarter")), tmp_path / name, ("png", "pdf", "svg")) for name in "ab"
    )
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in two]
