"""CasADi functions of one vector, evaluated in place."""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:  # CasADi is slow to import
    import casadi


class RecordedFunction:
    """Function whose `inputs` are written and `outputs` read before and after each call of `evaluate`."""

    def __init__(self, function: "casadi.Function") -> None:
        self.inputs, self.outputs = np.zeros(function.size1_in(0)), np.zeros(function.size1_out(0))
        buffer: Any
        buffer, self.evaluate = function.buffer()
        buffer.set_arg(0, memoryview(self.inputs))
        buffer.set_res(0, memoryview(self.outputs))
        self._buffer = buffer  # which lives as long as its function is called
