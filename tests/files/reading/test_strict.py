from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Literal

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.files.reading.strict import read, structure, to_mapping
from foreride.files.reading.yaml12 import parse


@dataclass(frozen=True)
class Bump:
    kind: ClassVar[str] = "bump"
    start_m: float
    height_m: float = 0.08

    def __post_init__(self) -> None:
        if not 0 < self.height_m <= 0.5:
            raise InputError(f"height_m must be > 0 m and <= 0.5 m, got {self.height_m}")


@dataclass(frozen=True)
class Pothole:
    kind: ClassVar[str] = "pothole"
    start_m: float
    depth_m: float


@dataclass(frozen=True)
class Road:
    length_m: float
    features: tuple[Bump | Pothole, ...] = ()
    surface: Literal["dry", "wet"] = "dry"


@dataclass(frozen=True)
class Scenario:
    road: Road
    name: str
    lanes: int = 1
    preview: bool = True
    axles: tuple[float, float] = (1.25, -1.45)
    seed: int | None = None
    extra: Bump | Pothole | None = None
    weights: dict[str, float] = field(default_factory=dict)
    level: Literal[1, 2] = 1


def scenario(**changes: Any) -> dict[str, Any]:
    return {"road": {"length_m": 100}, "name": "x"} | changes


def test_defaults_nesting_and_tags() -> None:
    features = [{"kind": "bump", "start_m": 20}, {"kind": "pothole", "start_m": 40, "depth_m": 0.05}]
    read_back = structure(
        Scenario, scenario(road={"length_m": 100, "features": features}, axles=[1, -1]), "s"
    )
    assert read_back == Scenario(Road(100.0, (Bump(20.0), Pothole(40.0, 0.05))), "x", axles=(1.0, -1.0))
    assert type(read_back.road.length_m) is float


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lane": 2}, "s.yaml: lane is not a known key; did you mean lanes?"),
        (
            {"road": {"length_m": 9, "zzz": 1}},
            "s.yaml: road.zzz is not a known key; allowed are length_m, features, surface",
        ),
        ({"road": {}}, "s.yaml: road.length_m is missing"),
        ({"road": 3}, "s.yaml: road must be a mapping of named values, got 3"),
        ({"lanes": 2.0}, "s.yaml: lanes must be a whole number, got 2.0"),
        ({"lanes": True}, "s.yaml: lanes must be a whole number, got True"),
        ({"axles": [1.0, True]}, "s.yaml: axles[1] must be a number, got True"),
        ({"axles": [1.0]}, "s.yaml: axles must be a list of 2 values, got 1"),
        ({"axles": "12"}, "s.yaml: axles must be a list, got '12'"),
        ({"road": {"length_m": "9"}}, "s.yaml: road.length_m must be a number, got '9'"),
        ({"road": {"length_m": float("nan")}}, "s.yaml: road.length_m must be a finite number, got nan"),
        (
            {"road": {"length_m": 10**400}},
            "s.yaml: road.length_m must be a finite number, got a whole number of about 400 digits",
        ),
        ({"weights": {"a": float("inf")}}, "s.yaml: weights.a must be a finite number, got inf"),
        ({"name": 3}, "s.yaml: name must be text, got 3"),
        ({"name": "a\0b"}, r"s.yaml: name must hold no control characters, got 'a\x00b'"),
        ({"name": "\ud800"}, r"s.yaml: name must hold no control characters, got '\ud800'"),
        ({"name": None}, "s.yaml: name must be text, got nothing"),
        ({"preview": 1}, "s.yaml: preview must be true or false, got 1"),
        ({"seed": "7"}, "s.yaml: seed must be a whole number, got '7'"),
        ({"level": True}, "s.yaml: level must be one of 1, 2, got True"),
        (
            {"road": {"length_m": 9, "surface": "wett"}},
            "s.yaml: road.surface must be one of dry, wet, got 'wett'; did you mean wet?",
        ),
        ({"extra": {"start_m": 1}}, "s.yaml: extra.kind is missing; it must be one of bump, pothole"),
        (
            {"extra": {"kind": ["bump"]}},
            "s.yaml: extra.kind must be one of bump, pothole, got ['bump']",
        ),
        (
            {"road": {"length_m": 9, "features": [{"kind": "bum", "start_m": 1}]}},
            "s.yaml: road.features[0].kind must be one of bump, pothole, got 'bum'; did you mean bump?",
        ),
        (
            {"road": {"length_m": 9, "features": [{"kind": "bump", "start_m": 1, "heigth_m": 0.1}]}},
            "s.yaml: road.features[0].heigth_m is not a known key; did you mean height_m?",
        ),
        (
            {"road": {"length_m": 9, "features": [{"kind": "bump", "start_m": 1, "height_m": -0.1}]}},
            "s.yaml: road.features[0].height_m must be > 0 m and <= 0.5 m, got -0.1",
        ),
    ],
)
def test_refusals(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        structure(Scenario, scenario(**changes), "s.yaml")
    assert str(caught.value) == message


@pytest.mark.parametrize("document", [None, 3, [1], {1: 2}])
def test_a_document_is_a_mapping(document: Any) -> None:
    with pytest.raises(InputError, match=r"^s: the document must be a mapping of named values, got "):
        structure(Scenario, document, "s")


def test_long_values_are_shortened_to_one_line() -> None:
    with pytest.raises(InputError) as caught:
        structure(Scenario, scenario(lanes="many\n" * 100), "s")
    assert len(str(caught.value)) < 120
    assert "\n" not in str(caught.value)


def test_a_tagged_class_may_carry_its_own_kind_outside_a_union() -> None:
    assert structure(Bump, {"kind": "bump", "start_m": 1}, "s") == Bump(1.0)
    with pytest.raises(InputError, match="s: kind must be bump, got 'pothole'"):
        structure(Bump, {"kind": "pothole", "start_m": 1}, "s")


def test_files(tmp_path: Path) -> None:
    path = tmp_path / "bump.yaml"
    path.write_text("kind: bump\nstart_m: 2e1\n")
    assert read(Bump | Pothole, path) == Bump(20.0)
    path.write_text("kind: bump\nstart_m: 1\nstart_m: 2\n")
    with pytest.raises(InputError, match=r"bump\.yaml, line 3: the key 'start_m' appears twice"):
        read(Bump | Pothole, path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"bump\.yaml: is not UTF-8 text"):
        read(Bump, path)
    with pytest.raises(InputError, match=r"absent\.yaml: cannot be read .*No such file"):
        read(Bump, tmp_path / "absent.yaml")


numbers = st.floats(allow_nan=False, allow_infinity=False)
bumps = st.builds(Bump, numbers, st.floats(0.001, 0.5))
features = bumps | st.builds(Pothole, numbers, numbers)
roads = st.builds(Road, numbers, st.lists(features, max_size=3).map(tuple), st.sampled_from(["dry", "wet"]))
plain = st.text(st.characters(exclude_categories=["Cc", "Cs"], include_characters="\t\n"))
scenarios = st.builds(
    Scenario,
    road=roads,
    name=plain,
    lanes=st.integers(),
    preview=st.booleans(),
    axles=st.tuples(numbers, numbers),
    seed=st.none() | st.integers(),
    extra=st.none() | features,
    weights=st.dictionaries(plain, numbers, max_size=3),
    level=st.sampled_from([1, 2]),
)


@given(scenarios)
def test_mappings_round_trip(value: Scenario) -> None:
    assert structure(Scenario, to_mapping(value), "s") == value


@given(st.builds(Road, numbers, st.lists(features, max_size=3).map(tuple)))
def test_yaml_text_round_trips(value: Road) -> None:
    text = yaml.safe_dump(to_mapping(value))
    assert structure(Road, parse(text, "s"), "s") == value


scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
keys = st.sampled_from(["road", "name", "length_m", "features", "kind", "start_m", "extra"]) | st.text(
    max_size=3
)
trees = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4)
)


def refusal(act: Callable[[], Any]) -> str:
    """Message of the InputError raised by `act`, or None."""
    try:
        act()
    except InputError as error:
        return str(error)
    return ""


@given(trees)
def test_any_document_is_read_or_refused_in_one_line(document: Any) -> None:
    assert len(refusal(lambda: structure(Scenario, document, "s")).splitlines()) <= 1


@given(st.text(max_size=40))
def test_any_text_is_read_or_refused_in_one_line(text: str) -> None:
    assert len(refusal(lambda: parse(text, "s")).splitlines()) <= 1
