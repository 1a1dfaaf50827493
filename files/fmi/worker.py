"""Process of a foreign FMU: requests come as pickles on standard input, answers go to standard output.

The parent starts this file as a script, which imports nothing of foreride. What the FMU prints goes nowhere.
"""

import ctypes
import gc
import os
import pickle
import sys
from typing import Any

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


class Unit:
    """FMU with one instance; every method answers a request of that name."""

    def __init__(self) -> None:
        self._said = ""
        self._steps = 0

    def describe(self, path: str) -> dict[str, Any]:
        """Read the model description: version, step, platforms and variables as plain values."""
        import fmpy

        self._path, self._model = path, fmpy.read_model_description(path)
        cosimulation = self._model.coSimulation
        step_s = None
        if cosimulation is not None:
            step_s = cosimulation.fixedInternalStepSize
            experiment = self._model.defaultExperiment
            if step_s is None and not cosimulation.canHandleVariableCommunicationStepSize and experiment:
                step_s = experiment.stepSize
        return {
            "version": str(self._model.fmiVersion),
            "cosimulation": cosimulation is not None,
            "step_s": None if step_s is None else float(step_s),
            "platforms": fmpy.supported_platforms(path),
            "platform": fmpy.platform,
            "variables": {variable.name: self._plain(variable) for variable in self._model.modelVariables},
        }

    def _plain(self, variable: Any) -> dict[str, Any]:
        name = variable.unit or getattr(variable.declaredType, "unit", None)
        base = next((unit.baseUnit for unit in self._model.unitDefinitions if unit.name == name), None)
        unit = None
        if name is not None:
            exponents = None if base is None else {part: int(getattr(base, part)) for part in BASE}
            scale = (1.0, 0.0) if base is None else (float(base.factor), float(base.offset))
            unit = (name, exponents, *scale)
        return {
            "reference": variable.valueReference,
            "causality": variable.causality,
            "type": variable.type,
            "array": bool(variable.dimensions),
            "unit": unit,
        }

    def start(self, folder: str, inputs: list[int], outputs: list[int], values: list[float]) -> list[float]:
        """Extract into a folder, instantiate and initialise with values of the inputs; give the outputs."""
        import fmpy
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        fmpy.extract(self._path, unzipdir=folder)
        self._third = str(self._model.fmiVersion).startswith("3")
        self._inputs, self._outputs = inputs, outputs
        self._unit = (FMU3Slave if self._third else FMU2Slave)(
            guid=self._model.guid,
            unzipDirectory=folder,
            modelIdentifier=self._model.coSimulation.modelIdentifier,
            instanceName="foreride",
        )
        self._instantiate()
        if self._third:
            self._unit.enterInitializationMode(startTime=0.0)
        else:
            self._unit.setupExperiment(startTime=0.0)
            self._unit.enterInitializationMode()
        self._set(values)
        self._unit.exitInitializationMode()
        return self._get()

    def _instantiate(self) -> None:
        if self._third:
            self._unit.instantiate(loggingOn=True, logMessage=self._log_fmi3)
            return
        from fmpy import fmi2
        from fmpy.logging import addLoggerProxy

        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log_fmi2)
        self._callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        addLoggerProxy(ctypes.byref(self._callbacks))
        self._unit.instantiate(callbacks=self._callbacks, loggingOn=True)

    def advance(self, step_s: float, given: Any, seen: Any, early: bool) -> tuple[list, str | None]:
        """Steps with rows of inputs `given`; outputs after each, with the inputs `seen`, or, `early`, before.

        Answers the rows of outputs of the completed steps, and the reason if one failed.
        """
        rows: list[list[float]] = []
        try:
            for number, values in enumerate(given):
                self._set(values)
                if early:
                    rows.append(self._get())
                self._step(step_s)
                if not early:
                    self._set(seen[number])
                    rows.append(self._get())
        except Exception as error:
            return rows, self._reason(error)
        return rows, None

    def _step(self, step_s: float) -> None:
        result = self._unit.doStep(self._steps * step_s, step_s)
        if self._third and result[1]:
            raise RuntimeError("it asks to end the simulation")
        if self._third and result[2]:
            raise RuntimeError("it returned early from a step")
        self._steps += 1

    def _set(self, values: Any) -> None:
        if self._inputs:
            (self._unit.setFloat64 if self._third else self._unit.setReal)(self._inputs, list(values))

    def _get(self) -> list[float]:
        values = (self._unit.getFloat64 if self._third else self._unit.getReal)(self._outputs)
        return [float(value) for value in values]

    def _reason(self, error: Exception) -> str:
        return f"{error} {self._said}".strip()

    def _log_fmi2(self, environment: Any, instance: Any, status: int, category: Any, text: Any) -> None:
        self._log(status, text)

    def _log_fmi3(self, environment: Any, status: int, category: Any, text: Any) -> None:
        self._log(status, text)

    def _log(self, status: int, text: Any) -> None:
        if status and text:  # a warning or worse
            self._said = f"({text.decode(errors='replace')[:200]})"

    def failure(self, error: Exception) -> str:
        """Reason of a failed request, with the last message that the FMU logged."""
        return self._reason(error) or type(error).__name__


def main() -> None:
    """Answer requests until the parent closes the pipe."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    sys.path[:] = pickle.load(requests)
    gc.disable()  # FMUs in Python miscount references, at which the collector would crash
    unit = Unit()
    while True:
        try:
            name, arguments = pickle.load(requests)
        except EOFError:
            os._exit(0)  # the FMU may have left threads, and Python objects whose code has gone
        try:
            answer = ("done", getattr(unit, name)(*arguments))
        except ImportError as error:
            answer = ("missing", str(error))
        except Exception as error:
            answer = ("failed", unit.failure(error))
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    main()
