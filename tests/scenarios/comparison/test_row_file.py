"""Row files: continued where they end, refused where they hold something else."""

from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.comparison import row_file


def test_rows_are_kept_as_they_come_and_a_line_cut_short_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    coming = row_file.kept(path, ({"drive": number} for number in range(3)))
    assert next(coming) == {"drive": 0}
    assert row_file.read(path, {"drive"}) == [{"drive": 0}]
    assert len(list(coming)) == 2
    path.write_text(path.read_text() + '{"drive": 3')
    assert [row["drive"] for row in row_file.resume(path, {"drive"})] == [0, 1, 2]
    assert path.read_text().endswith("2}\n")


def test_no_file_keeps_nothing() -> None:
    assert row_file.resume(None, {"drive"}) == []
    assert list(row_file.kept(None, [{"drive": 1}])) == [{"drive": 1}]


@pytest.mark.parametrize("text", ["nonsense\n", "[1]\n", '{"other": 1}\n'])
def test_what_is_no_row_of_the_table_is_refused_by_the_file_s_name(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text(text)
    with pytest.raises(InputError, match=r"rows\.jsonl"):
        row_file.read(path, {"drive"})
