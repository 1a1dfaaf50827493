import pytest

from foreride.files.errors import InputError
from foreride.files.reading.yaml12 import parse


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
        ("a: 1\nb:\n  c: 2\n  c: 3\n", r"^x\.yaml, line 4: the key 'c' appears twice$"),
        ("? [1, 2]\n: 3\n", r"^x\.yaml, line 1: a key must be plain text$"),
        (
            "a: !!python/object:os.system 1\n",
            r"^x\.yaml, line 1: the tag '!!python/object:os.system' is not known$",
        ),
        ("a: \x00", r"^x\.yaml: "),
        ("a: *b", r"^x\.yaml, line 1: found undefined alias"),
        ("a: !!int ''", r"^x\.yaml, line 1: the tag '!!int' does not match its value$"),
        ("a: !!bool maybe", "does not match"),
        ("a: !!float 1:30", "does not match"),
        ("a: !!timestamp x", r"the tag '!!timestamp' is not known$"),
        ("a: !!binary x", "is not known"),
        ("a: !!str [1]", "does not match"),
        ("a: &a {b: 1}\nc:\n  !!merge <<: *a", r"line 3: the tag '!!merge' is not known$"),
        ('a: "\\0"', r"^x\.yaml, line 1: text must hold no control characters, got "),
        ('"\\uD800": 1', "text must hold no control characters"),
        ("a: &b [*b]", r"^x\.yaml, line 1: an alias must not refer to a node that contains it$"),
        ("[" * 10_000, r"^x\.yaml: is nested too deeply$"),
        ("[" * 60 + "]" * 60, "is nested more than 50 levels deep$"),
        ("a: " + "[1,2,3,4,5,6,7,8,9,0],\n" * 3, r"^x\.yaml, line "),
        (f"{'k' * 10_000}: 1\n{'k' * 10_000}: 2", r"^x\.yaml, line 1: "),
        (f"!!{'t' * 5_000} 1", "is not known$"),
    ],
)
def test_mistakes_name_the_line(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        parse(text, "x.yaml")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


def bomb(base: int, levels: int) -> str:
    rows = [f"a0: &a0 [{', '.join('x' * base)}]"]
    rows += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * base)}]" for i in range(1, levels)]
    return "\n".join(rows)


def test_aliases_count_as_often_as_they_stand_for_something() -> None:
    assert parse(bomb(4, 3), "x")["a2"] == [[list("xxxx")] * 4] * 4
    with pytest.raises(InputError, match="its aliases expand to more than 200000 values"):
        parse(bomb(9, 12), "x")
    with pytest.raises(InputError, match="nested more than 50 levels deep"):
        parse(bomb(1, 60), "x")


def test_what_two_aliases_stand_for_is_not_shared() -> None:
    value = parse("a: &a {b: 1}\nc: *a", "x")
    value["a"]["b"] = 2
    assert value["c"] == {"b": 1}


def test_a_value_parsed_twice_is_not_shared() -> None:
    parse("a: [1]", "x")["a"].append(2)
    assert parse("a: [1]", "x") == {"a": [1]}


def test_whole_numbers_of_any_length_are_read_or_refused() -> None:
    assert parse("9" * 400, "x") == int("9" * 400)
    with pytest.raises(InputError, match=r"^x: is invalid"):
        parse("9" * 5000, "x")
