"""A skyhook controller of somebody else as an FMU, which answers with its steps."""

from pathlib import Path

from pythonfmu.builder import FmuBuilder

CONTROLLER = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.body, self.travel, self.command, self.steps = 0.0, 0.0, 1500.0, 0
        self.register_variable(Real("body", causality=Fmi2Causality.input))
        self.register_variable(Real("travel", causality=Fmi2Causality.input))
        self.register_variable(Real("command", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.steps += 1
        if self.steps > {good_steps}:
            return False
        self.command = 3000.0 if self.body * self.travel > 0.0 else 400.0
        return True
"""
MAP = """map:
  estimated_body_velocity_0: body
  estimated_rattle_velocity_0: travel
  damping_command_0: command
answers_after_step: true
"""
LAW = """
import numpy as np
from foreride.vehicle.equations import motion, rattle


class Skyhook:
    def __init__(self, vehicle, timing):
        self.vehicle = vehicle

    def reset(self):
        pass

    def step(self, estimate, preview):
        _, rate = rattle(self.vehicle, estimate.x)
        body = rate + np.array(motion(self.vehicle, estimate.x).wheel_velocity)
        return np.where(body * rate > 0.0, 3000.0, 400.0)
"""


def build(folder: Path, name: str, good_steps: int) -> str:
    """Build the FMU with its map; return the name of the controller."""
    script = folder / f"{name.lower()}_controller.py"
    script.write_text(CONTROLLER.format(name=name, good_steps=good_steps))
    (folder / "map.yaml").write_text(MAP)
    return f"{FmuBuilder.build_FMU(script, dest=folder)}:{folder / 'map.yaml'}"
