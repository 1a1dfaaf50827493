"""A pothole under one side of a van: the road ahead is worth more than the front axle's measurement alone."""

from pathlib import Path

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import simulate

SCENARIO = """
title: Pothole under the right wheels of a van
speed_kmh: 70
road:
  length_m: 84
  features: [{kind: pothole, start_m: 46, length_m: 0.6, depth_m: 0.06, width_m: 0.8, wall_m: 0.2, seed: 13, y_m: -0.78}]
vehicle: {model: van}
"""  # noqa: E501


def test_true_preview_is_no_worse_than_the_front_axle_measuring_for_the_rear(tmp_path: Path) -> None:
    """It was worse while the corners of the body drifted apart (warp) in the observer."""
    file = tmp_path / "one_sided.yaml"
    file.write_text(SCENARIO)
    scenario = load(str(file))
    objective = {
        name: simulate(Case(scenario, name, perception, 0)).metrics["objective"]
        for name, perception in (("mpc_wheelbase", "none"), ("mpc_preview", "oracle"))
    }
    assert objective["mpc_preview"] < objective["mpc_wheelbase"]
