"""Mutation operators, choice of test files and verdicts."""

import ast
from pathlib import Path

from benchmarks.mutation.choice import Mutant, drawn, files_judging
from benchmarks.mutation.judge import verdict
from benchmarks.mutation.operators import mutated, mutations

SOURCE = '''"""Module."""

Force = Annotated[float, Interval(ge=1.0), "N"]


def force(a: float, b: float = -2.0) -> float:
    """Sum."""
    if a < b and not b == 0:
        raise ValueError(f"{a + b}")
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
    assert not [change for change in found if "1.0" in change or "a + b" in change]


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


def test_nearest_tests_come_first(tmp_path: Path) -> None:
    assert files_judging(repository(tmp_path), "springs/spring.py") == [
        "tests/springs/test_spring.py",
        "tests/springs/test_car.py",
    ]


def test_verdict_tells_killed_from_survived(tmp_path: Path) -> None:
    root = repository(tmp_path)
    tests = ["tests/springs/test_spring.py"]
    assert verdict(root, tests, 60.0) == "survived"
    path = root / Mutant("springs/spring.py", 0).file
    path.write_text(mutated(path.read_text(), 0)[0])
    assert verdict(root, tests, 60.0) == "killed"
