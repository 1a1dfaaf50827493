"""Tests of the trained example policy and of the training's own parts that need no stable-baselines3."""

import json
from pathlib import Path

import numpy as np

from foreride.files.own_code import load
from foreride.scenarios.cli import main

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "train_policy.py"


def test_the_policy_beats_the_passive_car_on_a_road_that_it_was_not_trained_on(tmp_path: Path) -> None:
    numbers = tmp_path / "numbers.json"
    arguments = ["compare", "hump_watts_30", "--controllers", f"passive,{EXAMPLE}:Policy"]
    assert main([*arguments, "--perception", "oracle", "--json", str(numbers)]) == 0
    passive, policy = json.loads(numbers.read_text())["rows"]
    assert policy["metrics"]["objective"] < 0.55 * passive["metrics"]["objective"]
    assert not policy["solver"]["fallbacks"]


def test_the_training_drives_are_of_one_car_and_do_not_contain_the_road_of_the_test() -> None:
    module = load(EXAMPLE, "example")
    assert "hump_watts_30" not in dict(module.DRIVES)
    assert len(module.environment().scenarios) == len(module.DRIVES)
    with np.load(module.POLICY) as stored:
        assert stored["weight_2"].shape == (2, 64)
