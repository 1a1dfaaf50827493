"""Tests of trained table rows: trained once, resumed with equal settings, refused with other settings."""

import json
import shutil
from pathlib import Path

import pytest

pytest.importorskip("torch")

from benchmarks.paper import training
from benchmarks.paper.ladder import ALL, main
from tests.detector import roads


@pytest.fixture
def words(tmp_path: Path) -> list[str]:
    roads.write(tmp_path / "data" / "train", 4)
    roads.write(tmp_path / "data" / "val", 2, seed=5)
    size = ["--size", "96x64", "--passes", "4", "--batch", "2", "--threads", "1"]
    return ["--table", "nwd", "--data", str(tmp_path / "data"), "--out", str(tmp_path / "runs"), *size]


def test_a_row_is_trained_once_and_refused_with_other_settings(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    out, train, asked = tmp_path / "rows.json", training.train, []
    monkeypatch.setattr(training, "train", lambda words: (asked.append(words), train(words))[1])
    for _ in range(2):
        assert main([*words, "--rows", "alpha 0.5", "--json", str(out)]) == 0
    (row,) = json.loads(out.read_text())
    assert (row["row"], row["passes"], row["size"]) == ("alpha 0.5", 4, "96x64")
    ((*_, resumed),) = asked
    assert resumed != "--resume"
    settings = json.loads((tmp_path / "runs" / "alpha 0.5" / "config.json").read_text())["settings"]
    assert settings["loss"]["nwd_alpha"] == 0.5
    capsys.readouterr()
    for option, value, told in (("--passes", "8", "4"), ("--seed", "3", "0"), ("--size", "128x96", "96x64")):
        assert main([*words, "--rows", "ciou,alpha 0.5", option, value]) == 2
        said = f"alpha 0.5: trained with {option[2:]} {told}, asked for is {value}; choose another --out"
        assert said in capsys.readouterr().err
    assert len(asked) == 1
    (tmp_path / "runs" / "alpha 0.5" / "weights.pt").unlink()
    assert main([*words, "--rows", "alpha 0.5"]) == 0
    assert asked[1][-1] == "--resume"


def test_a_folder_that_does_not_tell_how_it_was_trained_is_refused(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    run = tmp_path / "runs" / "ciou"
    for name, content in (("weights.pt", "x"), ("config.json", "{"), ("config.json", '{"settings": {}}')):
        shutil.rmtree(run, ignore_errors=True)
        run.mkdir(parents=True)
        (run / name).write_text(content)
        assert main([*words, "--rows", "ciou"]) == 2
        said = capsys.readouterr().err
        assert f"must tell what {run} was trained with" in said
        assert said.count("\n") == 1


def test_an_unknown_row_is_told_the_known_ones(words: list[str], capsys: pytest.CaptureFixture) -> None:
    assert main([*words, "--rows", "ciou,nwd2"]) == 2
    assert "--rows: must be of ciou, alpha 0.75" in capsys.readouterr().err


def test_the_whole_ladder_is_one_command_and_trains_no_row_twice(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Training is replaced by its last line of history; the options are those of the rows."""
    asked: dict[str, list[str]] = {}

    def train(words: list[str]) -> int:
        out = Path(words[words.index("--out") + 1])
        out.mkdir(parents=True)
        asked[out.name] = words
        seed = int(words[words.index("--seed") + 1])
        line = {
            "passes": 4,
            "size": "96x64",
            "map50": 0.1 * seed,
            "map50_95": 0.1,
            "precision": 0,
            "recall": 0,
        }
        (out / "history.jsonl").write_text(json.dumps(line) + "\n")
        return 0

    monkeypatch.setattr(training, "train", train)
    out = tmp_path / "rows.json"
    words[words.index("nwd")] = "all"
    assert main([*words, "--seeds", "0,1", "--rate", "0.004", "--json", str(out)]) == 0
    rows = {row["row"]: row for row in json.loads(out.read_text())}
    assert len(rows) == len(ALL) == 16
    assert set(asked) == {*ALL, *(f"{name} seed 1" for name in ALL)}
    assert all((row["map50"], row["map50_sigma"]) == (0.05, 0.05) for row in rows.values())
    options = [
        [w for w in words[words.index("--seed") + 2 :] if "teacher" not in w] for words in asked.values()
    ]
    assert len({tuple(o) for o in options}) == len(ALL)  # no two rows with the same options
    taught = {name for name, words in asked.items() if "--teacher" in words}
    assert taught == {f"{name}{seed}" for name in ("+bckd", "+cwd", "+bckd+cwd") for seed in ("", " seed 1")}
