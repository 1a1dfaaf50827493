"""Tests of road files that differ from the conventions: the error proposes the options that read them."""

import shlex
from pathlib import Path

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.io.reading_options import ReadingOptions
from foreride.road.io.surface_file import read_surface

X = np.round(np.arange(0.0, 60.05, 0.1), 4)
Z = np.round(0.01 * np.sin(2 * np.pi * X / 5), 6)


def written(folder: Path, header: str, rows: list[tuple[str, ...]], separator: str = ",") -> Path:
    path = folder / "profile.csv"
    lines = [header, *(separator.join(row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def rows(x: np.ndarray, *columns: np.ndarray) -> list[tuple[str, ...]]:
    return [tuple(f"{value:.6f}" for value in row) for row in zip(x, *columns, strict=True)]


def variants() -> dict[str, tuple[str, list[tuple[str, ...]], str, ReadingOptions]]:
    plain = rows(X, Z)
    commas = [tuple(cell.replace(".", ",") for cell in row) for row in plain]
    return {
        "decimal commas": ("x_m;z_m", commas, ";", ReadingOptions(separator=";", decimal=",")),
        "tabs": ("x_m\tz_m", plain, "\t", ReadingOptions(separator="tab")),
        "millimetres": ("x_m,z_m", rows(X, 1000 * Z), ",", ReadingOptions(unit="mm")),
        "centimetres": ("x_m,z_m", rows(X, 100 * Z), ",", ReadingOptions(unit="cm")),
        "descending": ("x_m,z_m", rows(60.0 - X, Z), ",", ReadingOptions(reversed=True)),
        "times": ("t_s,z_m", rows(X / 20.0, Z), ",", ReadingOptions(speed_kmh=72.0)),
        "names": ("s,elevation", plain, ",", ReadingOptions(x="s", z="elevation")),
        "words": ("s z", [("0.0", "0.0"), *plain[1:]], " ", ReadingOptions(separator="space", x="s", z="z")),
    }


@pytest.mark.parametrize("name", variants())
def test_a_file_of_another_convention_is_read_as_asked(tmp_path: Path, name: str) -> None:
    header, lines, separator, options = variants()[name]
    surface = read_surface(written(tmp_path, header, lines, separator), options)
    np.testing.assert_allclose(surface.x_m, X, atol=2e-5)
    np.testing.assert_allclose(surface.heights[0], Z - Z[0], atol=2e-6)


@pytest.mark.parametrize(
    ("name", "proposed"),
    [
        ("decimal commas", "--separator ';' --decimal ','"),
        ("tabs", "--separator tab"),
        ("millimetres", "in mm it would be 0.01176 m: --unit mm"),
        ("centimetres", "in cm it would be 0.01176 m: --unit cm"),
        ("descending", "--reversed (in a scenario's road: reading: {reversed: true})"),
        ("times", "times in s for stations; give the speed: --speed KMH"),
        ("names", "--x NAME --left NAME --right NAME"),
    ],
)
def test_without_the_options_the_error_proposes_them(tmp_path: Path, name: str, proposed: str) -> None:
    header, lines, separator, _ = variants()[name]
    with pytest.raises(InputError) as caught:
        read_surface(written(tmp_path, header, lines, separator))
    assert proposed in str(caught.value)
    assert shlex.split(proposed.split(" (")[0])


def test_against_the_direction_of_the_record_left_becomes_right(tmp_path: Path) -> None:
    path = written(tmp_path, "x_m,left_m,right_m", rows(X, Z, 2 * Z))
    surface = read_surface(path, ReadingOptions(reversed=True))
    np.testing.assert_allclose(surface.x_m, X, atol=1e-9)
    np.testing.assert_array_equal(surface.y_m, [-0.75, 0.75])
    turned = np.array([Z[::-1], 2 * Z[::-1]])
    np.testing.assert_allclose(surface.heights, turned - turned[:, 0].mean(), atol=1e-9)


def test_chosen_columns_leave_out_the_others(tmp_path: Path) -> None:
    lines = [(*row, "note") for row in rows(X, Z, 2 * Z)]
    path = written(tmp_path, "s,l,r,remark", lines)
    surface = read_surface(path, ReadingOptions(x="s", left="l", right="r"))
    np.testing.assert_allclose(surface.heights[1], Z - Z[0], atol=1e-9)
    with pytest.raises(InputError, match=r"has no column 'lef'.*it has s, l, r, remark|did you mean"):
        read_surface(path, ReadingOptions(x="s", left="lef", right="r"))


def test_options_that_a_format_does_not_take_or_that_conflict_are_refused(tmp_path: Path) -> None:
    (tmp_path / "road.crg").write_text("")
    with pytest.raises(InputError, match=r"reading.unit is not for a file of ASAM OpenCRG"):
        read_surface(tmp_path / "road.crg", ReadingOptions(unit="mm"))
    with pytest.raises(InputError, match="separator must be"):
        ReadingOptions(decimal=",")
    with pytest.raises(InputError, match="left and right"):
        ReadingOptions(left="l")
