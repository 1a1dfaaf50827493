import pytest

from files.errors import InputError
from files.yaml12 import parse


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e7", 1e7),
        ("-2.5E-3", -2.5e-3),
        ("+4", 4),
        (".5", 0.5),
        ("010", 10.0),
        ("no", "no"),
        ("on", "on"),
        ("true", True),
        ("12:30", "12:30"),
        ("2024-01-01", "2024-01-01"),
        ("~", None),
        ("", None),
        ("-.inf", float("-inf")),
        ("'1'", "1"),
        ("[1, two, 3.0]", [1, "two", 3.0]),
    ],
)
def test_scalars_of_yaml_1_2(text: str, value: object) -> None:
    parsed = parse(text, "x")
    assert parsed == value
    assert type(parsed) is type(value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: [2\nc: 3\n", r"^x\.yaml, line 3: "),
        ("a: 1\nb:\n  c: 2\n  c: 3\n", r"^x\.yaml, line 4: the key 'c' stands twice$"),
        ("? [1, 2]\n: 3\n", r"^x\.yaml, line 1: a key must be plain text$"),
        ("a: !!python/object:os.system 1\n", r"^x\.yaml, line 1: could not determine a constructor"),
        ("a: \x00", r"^x\.yaml: "),
        ("a: *b", r"^x\.yaml, line 1: found undefined alias"),
    ],
)
def test_mistakes_name_the_line(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        parse(text, "x.yaml")
    assert "\n" not in str(caught.value)
