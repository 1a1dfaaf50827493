"""FMPy in a process of its own: `fmpy_process.py ACTION OPTIONS.json` writes its results beside the options.

An FMU that runs Python leaves objects behind whose code is unloaded with its library, which would crash the
tests' process later.
"""

import json
import sys
from pathlib import Path

import numpy as np
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu


def simulated(fmu: str, inputs: str | None = None, repeats: int = 1, **options) -> np.ndarray:
    """Result of the last of several simulations of an FMU; inputs: a .npy file."""
    signals = None if inputs is None else np.load(inputs)
    for _ in range(repeats):
        rows = simulate_fmu(fmu, input=signals, **options)
    return rows


def continued(fmu: str, folder: str) -> np.ndarray:
    """Heave of a car 40 ticks after its state was saved, reached twice from that state."""
    description = read_model_description(fmu)
    unit = instantiate_fmu(extract(fmu, unzipdir=folder), description, "CoSimulation")
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.setReal([references["road_height_0"]], [0.01])
    for tick in range(20):
        unit.doStep(tick * 0.001, 0.001)
    state, results = unit.getFMUState(), []
    for _ in range(2):
        for tick in range(20, 60):
            unit.doStep(tick * 0.001, 0.001)
        results.append(unit.getReal([references["heave_m"]])[0])
        unit.setFMUState(state)
    return np.array(results)


if __name__ == "__main__":
    given = Path(sys.argv[2])
    action = {"simulated": simulated, "continued": continued}[sys.argv[1]]
    np.save(given.with_suffix(".npy"), action(**json.loads(given.read_text())))
