"""FMI 2.0 slave of a block, on PythonFMU."""

import json
from functools import partial
from typing import Any
from xml.etree.ElementTree import Element

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Real
from pythonfmu.enums import Fmi2Status

from foreride.scenarios.fmu.description import add_initial_unknowns, add_units
from foreride.scenarios.fmu.slave import BlockSlave


class Fmi2BlockSlave(BlockSlave, Fmi2Slave):
    """Slave whose variables are the ports of the block in the FMU's resources."""

    author = "foreride contributors"

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.load_block(str(self.resources))
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=self.block.duration_s, step_size=self.block.step_s
        )
        for port in self.block.ports:
            self.register_variable(
                Real(
                    port.name,
                    causality=Fmi2Causality[port.causality],
                    description=port.description,
                    getter=partial(self.get, port.name),
                    setter=partial(self.set, port.name) if port.causality == "input" else None,
                ),
                nested=False,
            )

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """Model description with units and initial unknowns."""
        root = super().to_xml(model_options or {})
        add_units(root, self.block.ports, "Real")
        add_initial_unknowns(root)
        return root

    def exit_initialization_mode(self) -> None:
        """Start at time zero with the present inputs."""
        self.begin()

    def failed(self, reason: str) -> bool:
        """Log the reason; the step's status is an error."""
        self.log(reason, Fmi2Status.error)
        return False

    def succeeded(self) -> bool:
        """Report a completed step."""
        return True

    def _get_fmu_state(self) -> dict[str, Any]:
        return {"inputs": dict(self.block.inputs), "state": self.block.state()}

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self.block.inputs.update(state["inputs"])
        self.block.restore(state["state"])
        self._present = None

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        return json.dumps(state).encode()
