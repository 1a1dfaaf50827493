"""The dataset of a sweep: nothing is lost by a kill, nothing counts twice."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import foreride.scenarios.studies.results as results_module
from foreride.files.errors import InputError
from foreride.scenarios.studies.results import Results, load_results


def row(number: int, error: str | None = None) -> dict:
    return {"key": f"k{number}", "error": error} | ({} if error else {"wk_rms": float(number)})


def test_rows_survive_a_kill_before_any_part_is_written(tmp_path: Path) -> None:
    results = Results(tmp_path)
    for number in range(3):
        results.add(row(number))
    again = Results(tmp_path)  # as a new process finds it; the first one never flushed
    assert again.done == {"k0": None, "k1": None, "k2": None}
    again.flush()
    assert load_results(tmp_path)["wk_rms"].to_pylist() == [0.0, 1.0, 2.0]


def test_a_torn_line_is_not_counted_as_done(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(row(0))
    results.add(row(1))
    journal = tmp_path / "journal.jsonl"
    journal.write_text(journal.read_text()[:-9])
    again = Results(tmp_path)
    assert set(again.done) == {"k0"}
    again.add(row(1))
    again.flush()
    assert load_results(tmp_path)["key"].to_pylist() == ["k0", "k1"]


def test_a_kill_between_part_and_journal_counts_nothing_twice(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(row(0))
    before = (tmp_path / "journal.jsonl").read_text()
    results.flush()
    (tmp_path / "journal.jsonl").write_text(before)
    again = Results(tmp_path)
    again.add(row(1))
    again.flush()
    assert load_results(tmp_path)["key"].to_pylist() == ["k0", "k1"]


def test_parts_are_written_as_rows_come(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(results_module, "ROWS_PER_PART", 2)
    results = Results(tmp_path)
    for number in range(5):
        results.add(row(number))
    assert len(list(tmp_path.glob("drives/part-*.parquet"))) == 2
    assert set(Results(tmp_path).done) == {f"k{number}" for number in range(5)}


def test_failed_rows_keep_their_error_and_fit_the_others(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(row(0, error="InputError: no"))
    results.flush()
    results.add(row(1))
    results.flush()
    table = load_results(tmp_path)
    assert table["error"].to_pylist() == ["InputError: no", None]
    assert table["wk_rms"].to_pylist() == [None, 1.0]
    assert pq.read_schema(tmp_path / "drives" / "part-00001.parquet").field("error").type == "string"


def test_a_second_try_takes_the_place_of_the_first(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(row(0, error="died"))
    results.flush()
    results.add(row(0))
    results.flush()
    assert load_results(tmp_path)["error"].to_pylist() == [None]


def test_a_foreign_file_is_refused(tmp_path: Path) -> None:
    Results(tmp_path)
    (tmp_path / "part-00000.parquet").write_text("nothing of ours")
    with pytest.raises(InputError, match="part-00000"):
        Results(tmp_path)


def test_a_folder_of_others_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "journal.jsonl").write_text("mine")
    with pytest.raises(InputError, match="is not empty"):
        Results(tmp_path)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("journal.jsonl", "mine")]


def test_a_part_never_takes_the_place_of_another(tmp_path: Path) -> None:
    results = Results(tmp_path)
    for number in range(2):
        results.add(row(number))
        results.flush()
    (tmp_path / "drives" / "part-00000.parquet").unlink()
    kept = (tmp_path / "drives" / "part-00001.parquet").read_bytes()
    again = Results(tmp_path)
    again.add(row(2))
    again.flush()
    assert (tmp_path / "drives" / "part-00001.parquet").read_bytes() == kept
    assert (tmp_path / "drives" / "part-00002.parquet").exists()


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (b'{"error": null}', "must hold key and error"),
        (b'{"key": 1, "error": null}', "must hold key and error"),
        (b"null", "must hold key and error"),
        (b'{"key": "k", "error": null, "a": [1]}', "must be plain"),
        (b'{"key": "k", "error": null, "a": NaN}', "must be finite"),
        (b'{"key": "\xff", "error": null}', "is not UTF-8 text"),
        (b'{"key": "k", "err', "is not valid JSON"),
    ],
)
def test_a_damaged_line_before_the_last_is_named_and_nothing_is_changed(
    tmp_path: Path, line: bytes, told: str
) -> None:
    Results(tmp_path).add(row(0))
    journal = tmp_path / "journal.jsonl"
    content = line + b"\n" + journal.read_bytes()
    journal.write_bytes(content)
    with pytest.raises(InputError, match=r"journal\.jsonl:1: ") as caught:
        Results(tmp_path)
    assert told in str(caught.value)
    assert journal.read_bytes() == content


def test_a_part_without_rows_adds_none(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(row(0))
    results.flush()
    part = tmp_path / "drives" / "part-00000.parquet"
    pq.write_table(pq.read_table(part).slice(0, 0), part)
    assert load_results(tmp_path).num_rows == 0


def test_a_part_without_keys_is_refused(tmp_path: Path) -> None:
    Results(tmp_path)
    pq.write_table(pa.table({"key": [1], "error": [None]}), tmp_path / "part-00000.parquet")
    with pytest.raises(InputError, match=r"part-00000\.parquet: each key must be text"):
        Results(tmp_path)
    pq.write_table(pa.table({"error": ["x"]}), tmp_path / "part-00000.parquet")
    with pytest.raises(InputError, match=r"part-00000\.parquet: lacks the column key"):
        Results(tmp_path)
