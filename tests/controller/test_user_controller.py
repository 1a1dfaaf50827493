"""Tests of user controllers: run-time failures are faults of the answer, load failures give one line."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.controller.interface import Estimate, Timing
from foreride.controller.registry import build, build_object
from foreride.controller.tuned_settings import tuned_settings
from foreride.controller.user_controller import load_user_controller
from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car, load_vehicle
from tests.controller.cars import estimate

CAR = load_vehicle("half")
MOVING = estimate(CAR)

OWN = """import sys
import numpy as np

class Own:
    def __init__(self, vehicle, timing):
        self.asked = 0
    def reset(self):
        pass
    def step(self, estimate, preview):
        self.asked += 1
        {step}
"""

FAILURES = {
    "raise": ("raise ValueError(f'no such luck, {self.asked} times')", "ValueError at own.py:11"),
    "exit": ("sys.exit('enough')", "SystemExit at own.py:11"),
    "deep": ("return self.step(estimate, preview)", "RecursionError at own.py:11"),
    "base": ("raise BaseException", "BaseException at own.py:11"),
    "library": ("return np.linalg.inv(np.zeros((2, 2)))", "LinAlgError at own.py:11"),
    "untellable": ("raise type('Mute', (Exception,), {'__str__': lambda s: 1 / 0})()", "Mute at own.py:11"),
    "text": ("return 'soft'", "bad answer at own.py:9"),
    "texts": ("return ['900', '900']", "bad answer at own.py:9"),
    "none": ("return None", "bad answer at own.py:9"),
    "ragged": ("return [[1.0], [1.0, 2.0]]", "bad answer at own.py:9"),
    "nan": ("return np.full(2, np.nan)", "bad answer at own.py:9"),
    "shape": ("return np.zeros(7)", "bad answer at own.py:9"),
    "attribute": ("self.__class__.active = 3; return np.zeros(2)", "TypeError at user_controller.py:"),
}


def write(folder: Path, text: str) -> Path:
    path = folder / "own.py"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("step", "reason"), FAILURES.values(), ids=FAILURES)
def test_a_failure_brings_the_fallback_in_the_same_sample_and_is_counted_as_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], step: str, reason: str
) -> None:
    path = write(tmp_path, OWN.format(step=step))
    own, skyhook = build(f"{path}:Own", CAR), build("skyhook", CAR)
    for _ in range(3):
        np.testing.assert_array_equal(own.step(MOVING, None), skyhook.step(MOVING, None))
    counted = own.stats  # type: ignore[attr-defined]
    assert (counted["solves"], counted["fallbacks"]) == (0, 3)
    ((named, times),) = counted["reasons"].items()
    assert (named.startswith(f"own controller: {reason.removesuffix(':')}"), times) == (True, 3)
    said = capsys.readouterr().err.splitlines()
    assert len([line for line in said if f"{path}:Own: {reason}" in line]) == 1


def test_it_acts_again_once_it_answers(tmp_path: Path) -> None:
    step = "if self.asked == 2: raise OSError\n        return [900.0, 900.0]"
    own = build(f"{write(tmp_path, OWN.format(step=step))}:Own", CAR)
    for _ in range(3):
        own.step(MOVING, None)
    assert own.stats["reasons"] == {"own controller: OSError at own.py:11": 1}  # type: ignore[attr-defined]


def test_a_failure_to_hear_what_acted_spoils_the_next_answer(tmp_path: Path) -> None:
    text = OWN.format(step="return [900.0, 900.0]\n    def acted(self, command):\n        1 / 0")
    own = build(f"{write(tmp_path, text)}:Own", CAR)
    own.step(MOVING, None)
    own.step(MOVING, None)
    reasons = own.stats["reasons"]  # type: ignore[attr-defined]
    assert reasons == {"own controller: ZeroDivisionError at own.py:13": 1}


def test_own_code_cannot_change_what_others_are_given(tmp_path: Path) -> None:
    step = "estimate.x[:] = 9.0; return [900.0, 900.0]"
    own = build(f"{write(tmp_path, OWN.format(step=step))}:Own", CAR)
    before = MOVING.x.copy()
    own.step(MOVING, None)
    np.testing.assert_array_equal(MOVING.x, before)


def test_ctrl_c_is_no_fault(tmp_path: Path) -> None:
    own = build(f"{write(tmp_path, OWN.format(step='raise KeyboardInterrupt'))}:Own", CAR)
    with pytest.raises(KeyboardInterrupt):
        own.step(MOVING, None)
    path = write(tmp_path, "raise KeyboardInterrupt")
    with pytest.raises(KeyboardInterrupt):
        load_user_controller(f"{path}:Own")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\ndef f(:\n", r"does not load \(SyntaxError: .* at own\.py:2\)"),
        ("import os\nimport sys\nsys.exit(3)\n", r"does not load \(SystemExit: 3 at own\.py:3\)"),
        ("import absent_module\n", r"does not load \(ModuleNotFoundError: .* at own\.py:1\)"),
        ("x = 1\nx.y\n", r"does not load \(AttributeError: .* at own\.py:2\)"),
        ("raise ValueError('a\\nb' * 5000)", r"does not load \(ValueError: a b.*\.\.\. at own\.py:1\)"),
        ("x = 1\n", "must define a class or function called 'Own'"),
        ("def Own(vehicle, timing):\n    exit(0)\n", r"cannot be built \(SystemExit: 0 at own\.py:2\)"),
        (
            OWN.format(step="pass").replace("pass\n    def step", "1 / 0\n    def step"),
            r"reset\(\) fails .*py:8",
        ),
    ],
)
def test_what_does_not_load_is_told_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        build(f"{write(tmp_path, text)}:Own", CAR)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 600


def test_dataclasses_with_deferred_annotations_load(tmp_path: Path) -> None:
    header = "from __future__ import annotations\nfrom dataclasses import dataclass\n"
    path = write(tmp_path, header + "@dataclass\nclass Gains:\n    low: float = 1.0\n")
    assert callable(load_user_controller(f"{path}:Gains"))


def test_slow_code_is_told_to_be_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.modules["foreride.files.own_code"], "PATIENCE_S", 0.01)
    path = write(tmp_path, "import time\ntime.sleep(0.3)\ndef Own(): ...\n")
    load_user_controller(f"{path}:Own")
    assert "still waiting for" in capsys.readouterr().err


class Constant:
    """Controller of constant damping, that fails where it is told to."""

    def __init__(
        self, vehicle: Car, timing: Timing, damping_ns_m: float = 900.0, fails: bool = False
    ) -> None:
        self.command, self.fails, self.resets = np.full(vehicle.wheels, damping_ns_m), fails, 0

    def reset(self) -> None:
        self.resets += 1

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        if self.fails:
            raise ZeroDivisionError("by own hand")
        return self.command


def stiff(vehicle: Car, timing: Timing) -> Constant:
    return Constant(vehicle, timing, 1000.0)


@pytest.mark.parametrize(
    ("given", "damping"),
    [(Constant, 900.0), (stiff, 1000.0), (Constant(CAR, Timing(), 1100.0), 1100.0)],
    ids=["class", "function", "object"],
)
def test_a_class_a_function_and_an_object_are_controllers(
    given: Constant | Callable[..., Constant], damping: float
) -> None:
    built = build_object(given, CAR, tuned_settings(CAR.kind), Timing())
    assert built.step(MOVING, None) == pytest.approx(damping)
    if isinstance(given, Constant):
        assert given.resets == 1


def test_the_failure_of_an_object_brings_the_fallback_and_names_its_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    built = build_object(Constant(CAR, Timing(), fails=True), CAR, tuned_settings(CAR.kind), Timing())
    assert built.step(MOVING, None) == pytest.approx(build("skyhook", CAR).step(MOVING, None))
    assert built.problem is not None  # type: ignore[attr-defined]
    told = capsys.readouterr().err
    assert "test_user_controller.py:Constant" in told
    assert "ZeroDivisionError: by own hand at test_user_controller.py:" in told


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (object(), "must have reset() and step(), lacks reset, step"),
        (lambda vehicle: None, "cannot be built (TypeError"),
        (lambda vehicle, timing: None, "must have reset() and step()"),
    ],
)
def test_what_is_no_controller_is_refused(given: Any, told: str) -> None:
    with pytest.raises(InputError) as caught:
        build_object(given, CAR, tuned_settings(CAR.kind), Timing())
    assert told in str(caught.value)


def test_a_file_imports_modules_beside_it_but_they_hide_no_other(tmp_path: Path) -> None:
    (tmp_path / "chassis_of_mine.py").write_text("DAMPING = 950.0")
    (tmp_path / "json.py").write_text("raise AssertionError('hides json')")
    text = "import json\n" + OWN.format(
        step="from chassis_of_mine import DAMPING; return np.full(2, DAMPING)"
    )
    path = write(tmp_path, text)
    assert build(f"{path}:Own", CAR).step(MOVING, None) == pytest.approx(950.0)


def test_a_failure_to_hear_the_sensors_spoils_the_next_answer_even_if_the_command_is_heard(
    tmp_path: Path,
) -> None:
    listens = "return [900.0, 900.0]\n    def acted(self, command):\n        pass"
    text = OWN.format(step=f"{listens}\n    def sensed(self, measurement):\n        1 / 0")
    own = build_object(
        load_user_controller(f"{write(tmp_path, text)}:Own"), CAR, tuned_settings(CAR.kind), Timing()
    )
    own.sensed(None)  # type: ignore[attr-defined]
    own.acted(np.zeros(2))  # type: ignore[attr-defined]
    assert own.step(MOVING, None) == pytest.approx(build("skyhook", CAR).step(MOVING, None))
    own.step(MOVING, None)
    assert sum(own.stats["reasons"].values()) == 1  # type: ignore[attr-defined]
