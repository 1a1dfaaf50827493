"""Tests of safe file names: valid everywhere, and different for different texts."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.files.writing.names import MAX_LENGTH, check_name, component, joined

TEXTS = st.text(max_size=300) | st.text(alphabet="aA.-_/\\:cno1 ", max_size=12)
RESERVED = (
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{port}{number}" for port in ("com", "lpt") for number in range(10)),
)


def is_safe(name: str) -> bool:
    plain = all(c in "abcdefghijklmnopqrstuvwxyz0123456789_.-" for c in name)
    ends = not name.startswith((".", "-")) and not name.endswith(".")
    return plain and ends and 0 < len(name) <= MAX_LENGTH and name.split(".")[0] not in RESERVED


@given(TEXTS)
def test_a_component_is_safe_and_stays_what_it_is(text: str) -> None:
    assert is_safe(component(text))
    assert component(component(text)) == component(text)


@given(TEXTS, TEXTS)
def test_different_texts_give_different_components(one: str, other: str) -> None:
    if one != other and other != component(one) and one != component(other):
        assert component(one) != component(other)


@given(st.tuples(TEXTS, TEXTS, TEXTS), st.tuples(TEXTS, TEXTS, TEXTS))
def test_different_parts_give_different_names(one: tuple[str, ...], other: tuple[str, ...]) -> None:
    assert is_safe(joined(one))
    assert (joined(one) == joined(other)) == (one == other)


@pytest.mark.parametrize(
    "text", ["../victim", "/etc/passwd", "C:\\x", "NUL", "con.txt", ".", "..", "", "é", "a."]
)
def test_what_is_not_safe_gets_a_hash(text: str) -> None:
    assert is_safe(component(text))
    assert component(text) != text


def test_names_in_use_stay_as_they_are() -> None:
    assert joined(["bump_8x40_30", "half", "mpc_preview", "camera", "seed0"]) == (
        "bump_8x40_30-half-mpc_preview-camera-seed0"
    )
    assert joined(["my-road", "half"]) == "my-road-half"
    assert joined(["a", "b-c"]) != joined(["a-b", "c"])


@pytest.mark.parametrize("name", ["Bump 2", "own-road", "Bremsschwelle für 30", "a.b"])
def test_a_name_of_one_line_is_taken(name: str) -> None:
    check_name("name", name)


@pytest.mark.parametrize(
    "name",
    ["", " ", ".", "..", ".hidden", "../x", "a/b", "a\\b", "a\nb", "a\0b", "a\u202eb", "x" * 121, "\ud800"],
)
def test_a_name_that_is_no_file_name_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="name must be") as caught:
        check_name("name", name)
    assert str(caught.value).isprintable()


def test_a_shown_part_differs_by_what_it_stands_for() -> None:
    names = {joined(["road", "mine"], ["road", path]) for path in ("mine", "a/mine.yaml", "b/mine.yaml")}
    assert len(names) == 3
    assert "road-mine" in names
    assert all("/" not in name for name in names)
