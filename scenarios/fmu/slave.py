"""Common part of the FMI 2.0 and FMI 3.0 slaves: a block behind the exporter's interface."""

import sys
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError
from foreride.scenarios.fmu.block import Block, whole_ticks
from foreride.scenarios.fmu.embedded import embedded_block

SCRIPT = "foreride_"
"""Beginning of the name of an exported slave's module."""
_MODULES: list[object] = []
"""Modules of the slaves so far, which must outlive the exporter's references to them."""


class BlockSlave:
    """Mixin that holds the block of the FMU's resources and its outputs at the present time."""

    block: Block
    time_s: float = 0.0

    def load_block(self, resources: str) -> None:
        """Build the block from the FMU's folder of resources."""
        # The exporter clears the slave's module when an instance ends: the next one must import it anew.
        if (name := type(self).__module__).startswith(SCRIPT):
            _MODULES.append(sys.modules.pop(name, None))
        self.block = embedded_block(Path(resources))
        self._present: dict[str, float] | None = None

    def get(self, name: str) -> float:
        """Present value of a port; outputs are computed when one is asked for."""
        if name in self.block.inputs:
            return self.block.inputs[name]
        if self._present is None:
            self._present = self.block.outputs()
        return self._present[name]

    def set(self, name: str, value: float) -> None:
        """Set an input."""
        self.block.inputs[name] = float(value)
        self._present = None

    def begin(self) -> None:
        """Start at time zero with the present inputs."""
        self.block.reset()
        self._present = None

    def do_step(self, current_time: float, step_size: float) -> Any:
        """Advance by a communication step; an invalid one or a failed simulation is reported, not raised."""
        try:
            self.block.advance(whole_ticks(step_size))
        except InputError as error:
            return self.failed(str(error))
        self._present = None
        self.time_s = current_time + step_size
        return self.succeeded()

    def failed(self, reason: str) -> Any:
        """Answer of a step that failed."""
        raise NotImplementedError

    def succeeded(self) -> Any:
        """Answer of a step."""
        raise NotImplementedError
