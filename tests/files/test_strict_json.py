"""JSON as results have it: what is refused, and how quickly."""

import json
from pathlib import Path

import pytest

from files.errors import InputError
from files.strict_json import DEPTH, parse_json, read_json


@pytest.mark.parametrize("opening", ["[", '{"a":', '[{"a":'])
def test_nested_values_take_no_longer_than_their_size(opening: str) -> None:
    closing = "".join({"[": "]", "{": "}"}[c] for c in reversed(opening) if c in "[{")
    deep = DEPTH // len(closing) - 1
    json.dumps(parse_json(opening * deep + "1" + closing * deep, "x"))
    with pytest.raises(InputError, match="nested"):
        parse_json(opening * DEPTH * 2 + "1" + closing * DEPTH * 2, "x")


@pytest.mark.parametrize(
    "text", ["NaN", "[Infinity]", "1e999", "9" * 400, '{"a": 1, "a": 2}', '{"\\ud800": 1}']
)
def test_what_is_no_plain_json_is_refused_by_name(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"a\.json"):
        read_json(path)
