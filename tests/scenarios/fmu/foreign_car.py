"""Quarter car of somebody else as an FMU: names, units and integrator of its own, written in Python."""

from pathlib import Path

from pythonfmu.builder import FmuBuilder

CAR = """
import os
import xml.etree.ElementTree as ET
from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Real

INPUTS = {{"Road.z": "mm", "Damper.c": "N.s/m"}}
OUTPUTS = {{"Body.z": "mm", "Body.v": "m/s", "Body.a": "m/s2", "Wheel.z": "mm", "Wheel.v": "m/s",
           "Wheel.a": "m/s2", "Tyre.Fz": "kN"}}
BASE = {{"mm": dict(m="1", factor="0.001"), "N.s/m": dict(kg="1", s="-1"), "m/s": dict(m="1", s="-1"),
        "m/s2": dict(m="1", s="-2"), "kN": dict(kg="1", m="1", s="-2", factor="1000")}}


class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.values = dict.fromkeys([*INPUTS, *OUTPUTS], 0.0)
        self.x, self.steps = [0.0, 0.0, 0.0, 0.0, 1500.0], 0
        self.default_experiment = DefaultExperiment(step_size={step_s})
        for names, causality in ((INPUTS, "input"), (OUTPUTS, "output")):
            for name in names:
                self.register_variable(Real(
                    name, causality=Fmi2Causality[causality], getter=lambda name=name: self.values[name],
                    setter=lambda value, name=name: self.values.__setitem__(name, value),
                ), nested=False)

    def to_xml(self, model_options=None):
        root = super().to_xml(model_options or {{}})
        units = ET.Element("UnitDefinitions")
        for name, base in BASE.items():
            ET.SubElement(ET.SubElement(units, "Unit", name=name), "BaseUnit", base)
        root.insert(1, units)
        for variable in root.iterfind("ModelVariables/ScalarVariable"):
            variable.find("Real").set("unit", (INPUTS | OUTPUTS)[variable.get("name")])
        return root

    def rates(self, x, road, asked):
        zs, vs, zu, vu, c = x
        travel, speed = zs - zu, vs - vu
        stop = 1e7 * (max(-travel - 0.08, 0.0) ** 2 - max(travel - 0.08, 0.0) ** 2)
        strut = -21000.0 * travel - c * speed + stop
        static = (400.0 + 42.0) * 9.81
        tyre = max(195000.0 * (road - zu) - 100.0 * vu + static, 0.0)
        return [vs, strut / 400.0, vu, (tyre - static - strut) / 42.0, (asked - c) / 0.008], tyre

    def do_step(self, current_time, step_size):
        self.steps += 1
        {misbehave}
        road, asked = self.values["Road.z"] * 1e-3, min(max(self.values["Damper.c"], 300.0), 4500.0)
        h = step_size / 4
        for _ in range(4):
            k, tyre = self.rates(self.x, road, asked)
            m, tyre = self.rates([a + 0.5 * h * b for a, b in zip(self.x, k)], road, asked)
            self.x = [a + h * b for a, b in zip(self.x, m)]
        k, tyre = self.rates(self.x, road, asked)
        now = [self.x[0] * 1e3, self.x[1], k[1], self.x[2] * 1e3, self.x[3], k[3], tyre * 1e-3]
        self.values |= dict(zip(OUTPUTS, now))
        return True
"""
MAP = {
    "road_height_0": "Road.z",
    "damping_command_0": "Damper.c",
    "heave_m": "Body.z",
    "heave_velocity": "Body.v",
    "cg_acc": "Body.a",
    "wheel_z_0": "Wheel.z",
    "wheel_v_0": "Wheel.v",
    "wheel_acc_0": "Wheel.a",
    "tyre_force_0": "Tyre.Fz",
}


def build(folder: Path, name: str = "Quarter", misbehave: str = "pass", step_s: float = 0.001) -> Path:
    """Build the FMU; `misbehave`: a statement at the beginning of each step."""
    script = folder / f"{name.lower()}_car.py"
    script.write_text(CAR.format(name=name, misbehave=misbehave, step_s=step_s))
    built: Path = FmuBuilder.build_FMU(
        script, dest=folder, canHandleVariableCommunicationStepSize=step_s == 0.001
    )
    return Path(built)
