import pytest

from foreride.files.errors import InputError
from foreride.files.reading.numbers import is_integer, parse_integer, within


@pytest.mark.parametrize("text", ["", "-1", "+1", "1.0", "1_0", " 1", "²", "٣", "1" * 11, "1" * 5000])
def test_what_is_no_plain_whole_number(text: str) -> None:
    assert not is_integer(text)
    with pytest.raises(InputError, match=r"^--n must be a whole number in 0 \.\.\. 9, got "):
        parse_integer(text, "--n", 0, 9)


def test_a_whole_number_lies_in_its_range() -> None:
    assert parse_integer("007", "--n", 0, 9) == 7
    with pytest.raises(InputError, match="got '10'"):
        parse_integer("10", "--n", 0, 9)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e-300, 2.1, 1e300, 10**400])
def test_a_number_lies_in_its_range(value: float) -> None:
    within("x_m", 2.0, 0.0, 2.0, "m")
    with pytest.raises(InputError, match=r"^x_m must lie in 0 \.\.\. 2 m, got "):
        within("x_m", value, 0.0, 2.0, "m")
