"""Mutation operators, choice of tests and verdicts."""

import ast
from pathlib import Path

import pytest
import yaml

import benchmarks.mutation.reach
from benchmarks.mutation.__main__ import Bench, _is_open, judged, lines
from benchmarks.mutation.choice import Mutant, drawn, function_at, judging, within_time
from benchmarks.mutation.equivalent import LISTED, reason
from benchmarks.mutation.judge import verdict
from benchmarks.mutation.machine_code import code_aside, importers
from benchmarks.mutation.operators import mutated, mutations
from benchmarks.mutation.reach import TestReach, recorded

ROOT = Path(__file__).parents[2]

SOURCE = '''"""Module."""

Force = Annotated[float, Interval(ge=1.0), "N"]


def force(a: float, b: float = -2.0) -> float:
    """Sum."""
    if a < b and not b == 0:
        raise ValueError(f"{a + b}")
    for _ in zip("a", "b", strict=True):
        assert a + b < 9
    return a * b + 3
'''


def changes(source: str) -> list[str]:
    return [mutated(source, number)[2] for number in range(len(list(mutations(ast.parse(source)))))]


def test_operators_change_code_and_neither_types_nor_messages() -> None:
    found = changes(SOURCE)
    assert "a * b + 3 -> a * b - 3" in found
    assert "a * b -> a / b" in found
    assert "a < b -> a <= b" in found
    assert "b == 0 -> b != 0" in found
    assert "-2.0 -> +2.0" in found
    assert "3 -> 4" in found
    assert not [change for change in found if any(part in change for part in ("1.0", "a + b", "True", "9"))]


def test_each_mutation_differs_from_the_source_and_from_the_others() -> None:
    plain = ast.unparse(ast.parse(SOURCE)) + "\n"
    texts = [mutated(SOURCE, number)[0] for number in range(len(changes(SOURCE)))]
    assert plain not in texts
    assert len(set(texts)) == len(texts)


def repository(root: Path) -> Path:
    (root / "springs").mkdir()
    (root / "springs" / "spring.py").write_text("def force(x):\n    return 2.0 * x\n")
    tests = root / "tests" / "springs"
    tests.mkdir(parents=True)
    (tests / "test_car.py").write_text("from foreride.springs.spring import force\n")
    (tests / "test_spring.py").write_text(
        "from springs.spring import force\n\ndef test_force():\n    assert force(3.0) == 6.0\n"
    )
    return root


def test_draw_repeats_with_its_seed_and_has_no_mutant_twice(tmp_path: Path) -> None:
    root = repository(tmp_path)
    assert drawn(root, ["springs"], 2, 1) == drawn(root, ["springs"], 2, 1)
    assert {mutant.number for mutant in drawn(root, ["springs"], 99, 1)} == {0, 1}


SLOW = "\ndef test_slow():\n    while True: force(1.0)\n"


def reach(name: str, seconds: float, *functions: str) -> TestReach:
    return TestReach(name, seconds, frozenset(functions))


def test_a_mutant_is_judged_by_the_tests_that_execute_its_function_its_own_and_the_cheapest_first(
    tmp_path: Path,
) -> None:
    """Those after them that share a file with these or import the module; no others."""
    root = repository(tmp_path)
    (root / "tests" / "springs" / "test_other.py").write_text("")
    own, far, car = (f"tests/springs/test_{name}.py" for name in ("spring", "other", "car"))
    force = "springs/spring.py:force"
    tests = [
        reach(f"{far}::slow", 2.0, force),
        reach(f"{far}::fast", 1.0, force),
        reach(f"{far}::beside", 0.1, "springs/bar.py:force"),
        reach(f"{car}::importing", 0.1),
        reach(f"{own}::without", 0.2),
        reach(f"{own}::with", 3.0, force),
        reach("tests/benchmarks/test_mutation.py::no", 0.1),
    ]
    (root / "tests" / "benchmarks").mkdir()
    (root / "tests" / "benchmarks" / "test_mutation.py").write_text("")
    judges = judging(root, "springs/spring.py", "force", tests)
    names = [test.name.split("::")[1] for test in judges]
    assert names == ["with", "without", "fast", "slow", "beside", "importing"]
    (root / "car.py").write_text("from foreride.springs.spring import LENGTH\n")
    tests.append(reach(f"{far}::through_a_car", 0.3, "car.py:drive"))
    constant = judging(root, "springs/spring.py", None, tests)
    assert [test.name.split("::")[1] for test in constant][:3] == ["with", "without", "through_a_car"]
    assert [test.seconds for test in within_time(judges, 3.5)] == [3.0, 0.2]
    assert within_time(judges, 0.0) == judges[:1]


def test_the_function_of_a_line_is_the_outermost_one_and_none_for_what_runs_on_import() -> None:
    text = "A = 1\nclass C:\n    b = 2\n    def f(self, x=3):\n        def g(): return 4\n        return g\n"
    assert [function_at(text, line) for line in range(1, 7)] == [None, None, None, None, "C.f", "C.f"]


def test_record_holds_the_functions_of_tests_that_pass_in_time_and_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(benchmarks.mutation.reach, "LONGEST_TEST_S", 0.3)
    root = repository(tmp_path)
    file, out = "tests/springs/test_spring.py", tmp_path / "reach"
    path = root / file
    path.write_text(path.read_text() + "\ndef test_wrong():\n    assert force(1.0) == 1.0\n" + SLOW)
    (test,) = recorded(root, [file], out)
    assert (test.name, test.functions >= {"springs/spring.py:force"}) == (f"{file}::test_force", True)
    assert 0 <= test.seconds < 5
    kept = out.read_text()
    assert recorded(root, [file], out) == [test]
    assert out.read_text() == kept
    source = root / "springs" / "spring.py"
    source.write_text(source.read_text() + "# another line")
    recorded(root, [file], out)
    assert len(out.read_text().splitlines()) == 2
    path.write_text(path.read_text().replace("6.0", "7.0"))
    assert recorded(root, [file], out) == []


def test_verdict_tells_killed_from_survived_and_from_a_hang(tmp_path: Path) -> None:
    root = repository(tmp_path)
    tests = ["tests/springs/test_spring.py::test_force"]
    assert verdict(root, tests, 60.0) == "survived"
    path = root / Mutant("springs/spring.py", 0).file
    original = path.read_text()
    path.write_text(mutated(original, 0)[0])
    assert verdict(root, tests, 60.0) == "killed"
    path.write_text(original.replace("return", "while True: pass\n    return"))
    assert verdict(root, tests, 1.0) == "timeout"


def test_only_the_named_tests_run(tmp_path: Path) -> None:
    root = repository(tmp_path)
    path = root / "tests" / "springs" / "test_spring.py"
    path.write_text(path.read_text() + "\ndef test_wrong():\n    assert force(1.0) == 1.0\n")
    assert verdict(root, ["tests/springs/test_spring.py::test_force"], 60.0) == "survived"


def test_a_file_is_as_before_after_a_mutant_down_to_its_time_stamp(tmp_path: Path) -> None:
    root = repository(tmp_path)
    path = root / "springs" / "spring.py"
    text, stamp = path.read_text(), path.stat().st_mtime_ns
    bench = Bench(root, [reach("tests/springs/test_spring.py::test_force", 0.1)], [])
    row = judged(bench, Mutant("springs/spring.py", 0))
    assert (row["line"], row["change"], row["result"]) == (2, "2.0 * x -> 2.0 / x", "killed")
    assert judged(bench, Mutant("springs/spring.py", 0), "reach")["result"] == "survived"
    assert (path.read_text(), path.stat().st_mtime_ns) == (text, stamp)


COMPILED = "from foreride.springs.spring import force\n\n@njit\ndef twice(x):\n    return 2 * force(x)\n"


def test_machine_code_that_contains_a_mutated_function_is_set_aside(tmp_path: Path) -> None:
    """Of the file itself and of those that call it, not of others."""
    root = repository(tmp_path)
    own, calling, other = (root / "springs" / name for name in ("spring.py", "pair.py", "bar.py"))
    own.write_text("@njit\ndef force(x):\n    return 2.0 * x\n")
    calling.write_text(COMPILED)
    other.write_text("@njit\ndef half(x):\n    return x / 2\n")
    assert importers(root, "springs/spring.py") == {"springs/spring.py", "springs/pair.py"}
    cache = root / "springs" / "__pycache__"
    cache.mkdir()
    names = ["spring.force-2.nbi", "pair.twice-4.nbc", "bar.half-2.nbi"]
    for name in names:
        (cache / name).write_text("unchanged")
    with code_aside(root / ".", "springs/spring.py"):
        assert [path.name for path in cache.iterdir()] == ["bar.half-2.nbi"]
        (cache / "spring.force-2.nbi").write_text("mutated")
    assert {path.name: path.read_text() for path in cache.iterdir()} == dict.fromkeys(names, "unchanged")


def test_equivalent_mutants_are_found_in_the_code_and_counted_apart() -> None:
    for entry in yaml.safe_load(LISTED.read_text()):
        numbered = enumerate((ROOT / entry["file"]).read_text().splitlines(), 1)
        row = entry | {"line": next(n for n, line in numbered if line.strip() == entry["text"])}
        assert reason(ROOT, row) == entry["reason"]
        assert reason(ROOT, row | {"change": "1 -> 2"}) is None
    results = [("killed", "own"), ("timeout", "own"), ("equivalent", "own"), ("survived", "reach"),
               ("killed", "reach")]  # fmt: skip
    rows = [{"file": "comfort/a.py", "line": 1, "change": "", "result": one, "by": by} for one, by in results]
    assert lines(rows)[1].split() == ["comfort", "4", "50.0%", "75.0%"]
    assert len(lines(rows)) == 4


def test_survivors_of_a_stage_are_judged_in_the_next() -> None:
    assert [_is_open(None, stage) for stage in range(2)] == [True, False]
    left, killed = {"result": "survived", "by": "own"}, {"result": "killed", "by": "own"}
    assert [_is_open(left, stage) for stage in range(2)] == [False, True]
    assert not any(_is_open(killed, stage) for stage in range(2))
    assert not _is_open({"result": "timeout", "by": "own"}, 1)
