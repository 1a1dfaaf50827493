import os
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.road.io.surface_file import MeasuredSurface, read_surface, surface
from foreride.road.road import FADE_IN_M, Road

GOOD = "# drive of Tuesday\nx_m,left_m,right_m\n10,0.10,0.30\n10.5,0.12,0.30  # crack\n12,0.10,0.34\n"


def written(folder, text, name="road.csv"):
    path = folder / name
    path.write_text(text)
    return path


def outcome(path):
    """Error message of a refused file, or "surface"; any other error passes through."""
    try:
        assert isinstance(read_surface(path), MeasuredSurface)
    except InputError as error:
        return str(error)
    return "surface"


def test_csv_begins_at_zero_and_is_bilinear(tmp_path):
    loaded = read_surface(written(tmp_path, GOOD))
    np.testing.assert_array_equal(loaded.x_m, [0, 0.5, 2])
    np.testing.assert_array_equal(loaded.y_m, [-0.75, 0.75])
    np.testing.assert_allclose(loaded.heights, [[0.1, 0.1, 0.14], [-0.1, -0.08, -0.1]])
    assert loaded.height(0.25, 0.75) == pytest.approx(-0.09)
    assert loaded.height(1.25, 0.0) == pytest.approx((0.12 - 0.09) / 2)
    np.testing.assert_allclose(loaded.height([-5.0, 99.0], 9.0), [-0.1, -0.1])
    assert loaded.height(np.zeros((4, 1)), np.zeros(3)).shape == (4, 3)


def test_csv_with_one_line_or_lines_by_place(tmp_path):
    one = read_surface(written(tmp_path, "x_m,z_m\n0,0\n1,0.1\n"))
    np.testing.assert_allclose(one.height([[0.5]], [-3.0, 0.0, 3.0]), [[0.05] * 3])
    three = read_surface(written(tmp_path, "x_m,y=1,y=-1,y=0\n0,0,0,0\n1,0.1,0.3,0.2\n", "three.csv"))
    np.testing.assert_array_equal(three.y_m, [-1, 0, 1])
    assert three.height(1.0, 0.5) == pytest.approx(0.15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty; the first line must be x_m followed by"),
        ("x,z\n0,0\n1,0\n", "header must be x_m followed by .*got 'x,z'"),
        ("x_m,z_m,z_m\n0,0,0\n", "header must be"),
        ("x_m,y=a\n0,0\n", "header must be"),
        ("x_m,y=1,y=1\n0,0,0\n", "header must be"),
        ("x_m,z_m\n", "has a header, but no stations"),
        ("x_m,z_m\n0,0\n", "needs at least 2 stations, got 1"),
        ("x_m,z_m\n0,0\n1\n", "line 3 has 1 values, the header 2"),
        ("x_m,z_m\n0,0\n\n1,high\n", "line 4: z_m must be a finite number, got 'high'"),
        ("x_m,z_m\n0,0\n1,nan\n", "line 3: z_m must be a finite number, got 'nan'"),
        ("x_m,z_m\n1,0\n0,0\n", "stations must be finite and ascend"),
        (
            "x_m,z_m\n0,0\n1,120\n",
            "heights change by 120 m within a metre at x = 0 m.*in mm it would be 0.12 m: --unit mm",
        ),
    ],
)
def test_malformed_csv_is_told_in_one_line_with_the_file(tmp_path, text, message):
    path = written(tmp_path, text)
    with pytest.raises(InputError, match=message) as caught:
        read_surface(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_unreadable_files_are_told(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv: cannot be read \(No such file"):
        read_surface(tmp_path / "none.csv")
    with pytest.raises(InputError, match=r"road\.doc: a road file must end in \.csv, \.crg, .* or \.pcd"):
        read_surface(written(tmp_path, GOOD, "road.doc"))
    (tmp_path / "binary.csv").write_bytes(b"x_m,z_m\n\xff\xfe")
    with pytest.raises(InputError, match=r"binary\.csv: is not UTF-8 text"):
        read_surface(tmp_path / "binary.csv")


def test_changed_file_is_read_again(tmp_path):
    path = written(tmp_path, GOOD)
    before = read_surface(path)
    path.write_text(GOOD.replace("0.12", "0.22"))
    os.utime(path, (1, 1))
    assert read_surface(path).heights[1, 1] == pytest.approx(before.heights[1, 1] + 0.1)


def test_road_from_a_file_fades_in_pins_its_content_and_goes_on_after_its_end(tmp_path):
    path = written(tmp_path, "x_m,z_m\n0,7.0\n22,7.0\n23,7.1\n47,7.2\n")
    road = Road(25.0, file=str(path))
    z = road.height([-3, 0, FADE_IN_M, 23, 35, 47], 0.0)
    np.testing.assert_allclose(z, [0, 0, 0, 0.1, 0.15, 0.2], atol=1e-12)
    assert road.height(59.0, 0.0) == pytest.approx(0.25, abs=0.01)
    assert not road.is_flat_between_features
    assert Road(25.0, file=str(path), file_sha256=road.file_sha256) == road
    path.write_text("x_m,z_m\n0,7.0\n47,7.1\n")
    os.utime(path, (1, 1))
    with pytest.raises(InputError, match=r"^file_sha256 .*the file has changed"):
        Road(25.0, file=str(path), file_sha256=road.file_sha256)
    with pytest.raises(InputError, match=r"^length_m must be <= 47 m \(end of .*road\.csv\), got 48"):
        Road(48.0, file=str(path))


@given(
    x=st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=12, unique=True).map(sorted),
    seed=st.integers(0, 99),
)
def test_surface_meets_its_points_and_stays_between_them(x, seed):
    x = np.array(x)
    if np.diff(x).min() < 1e-6:
        return
    rng = np.random.default_rng(seed)
    y = np.sort(rng.uniform(-3, 3, 3))
    heights = 0.1 * rng.normal(size=(3, len(x)))
    loaded = surface(x, y, heights, "test")
    np.testing.assert_allclose(loaded.height(loaded.x_m[None], y[:, None]), loaded.heights, atol=1e-9)
    inside = loaded.height(rng.uniform(-5, x[-1] - x[0] + 5, 50), rng.uniform(-4, 4, 50))
    assert loaded.heights.min() - 1e-9 <= inside.min() <= inside.max() <= loaded.heights.max() + 1e-9


@settings(max_examples=150, deadline=None)
@given(text=st.text(alphabet='x_mz,y=-+.0123456789e#\n" naif\t\r;', max_size=200))
def test_any_text_gives_a_surface_or_one_line_of_refusal(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / "fuzzed.csv"
    path.write_text(text)
    os.utime(path, ns=(1, hash(text) & 0xFFFFFFFFFFF))
    assert outcome(path).count("\n") == 0


@settings(max_examples=100, deadline=None)
@given(offset=st.integers(0, len(GOOD) - 1), insert=st.text(max_size=4))
def test_a_mutated_profile_gives_a_surface_or_one_line_of_refusal(tmp_path_factory, offset, insert):
    text = GOOD[:offset] + insert + GOOD[offset + 1 :]
    path = tmp_path_factory.getbasetemp() / "mutated.csv"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    os.utime(path, ns=(1, hash(text) & 0xFFFFFFFFFFF))
    assert outcome(path).count("\n") == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x_m,z_m\n0,0\n1,1e300\n2,-1e300\n", "1e300 m at x = 1 m|heights change by"),
        ("x_m,z_m\n0,0\n1,1.7e308\n2,1.7e308\n", "heights change by"),
        ("x_m,z_m\n0,0\n1e-300,0\n1,0\n", "stations must lie at least 1e-06 m apart, got 1e-300 m"),
        ("x_m,z_m\n-1e308,0\n1e308,0\n", "stations must be finite and ascend, within"),
        ("x_m,z_m\n0,0\n1_0,0\n", "must be a finite number, got '1_0'"),
        ("x_m,z_m\n0,0\n1,inf\n", "must be a finite number, got 'inf'"),
        ("x_m,z_m\n0,0\n1,²\n", "must be a finite number"),
    ],
)
def test_absurd_numbers_are_refused_without_a_warning(tmp_path, text, message):
    path = written(tmp_path, text)
    with warnings.catch_warnings(record=True) as warned, pytest.raises(InputError, match=message):
        read_surface(path)
    assert not warned


@pytest.mark.parametrize("slope", [-0.06, 0.04])
def test_a_file_with_its_grade_left_in_has_no_kink(tmp_path, slope):
    """The grade of the file holds from behind the start to beyond the end, and its bank with it."""
    lines = "".join(f"{x},{slope * x + 0.02:.4f},{slope * x - 0.02:.4f}\n" for x in range(0, 61, 2))
    road = Road(60.0, file=str(written(tmp_path, "x_m,left_m,right_m\n" + lines)))
    x = np.linspace(-10.0, 70.0, 1601)
    for y, bank_m in ((0.75, 0.02), (-0.75, -0.02)):
        np.testing.assert_allclose(road.height(x, y), slope * x + bank_m, atol=1e-9)
    assert [road.grade(2.0), road.grade(59.0)] == pytest.approx([slope, slope])


def test_only_the_deviation_from_the_first_metres_fades_in(tmp_path):
    waves = "".join(f"{x / 10},{0.04 * x / 10 + 0.01 * np.sin(3 * x / 10):.5f}\n" for x in range(601))
    path = written(tmp_path, "x_m,z_m\n" + waves)
    x = np.linspace(-5.0, 60.0, 1301)
    z, measured = Road(60.0, file=str(path)).height(x, 0.0), read_surface(path)
    assert np.abs(np.diff(z, 2)).max() < 0.0005
    np.testing.assert_allclose(z[x >= FADE_IN_M], measured.height(x[x >= FADE_IN_M], 0.0))
