"""Model descriptions (FMI 2.0 and 3.0) of the car in plain C."""

from collections.abc import Sequence
from importlib.metadata import version as installed_version
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from foreride.scenarios.fmu.block import Port
from foreride.scenarios.fmu.description import add_units

NAME = "ForerideVehicle"
"""Name of the model, and its identifier in C."""


def model_description(
    version: str, token: str, ports: Sequence[Port], step_s: float, duration_s: float
) -> bytes:
    """XML of the model description; a port's value reference is its index."""
    second = version == "2.0"
    state = "state" if second else "State"
    root = Element("fmiModelDescription", fmiVersion=version, modelName=NAME)
    root.set("guid" if second else "instantiationToken", token)
    root.set("generationTool", f"foreride {installed_version('foreride')}")
    options = {"modelIdentifier": NAME, "canHandleVariableCommunicationStepSize": "true"}
    options |= {f"canGetAndSetFMU{state}": "true", f"canSerializeFMU{state}": "true"}
    simulation = SubElement(root, "CoSimulation", options)
    if second:
        simulation.set("canNotUseMemoryManagementFunctions", "true")
        SubElement(SubElement(simulation, "SourceFiles"), "File", name="fmi2.c")
    SubElement(SubElement(root, "LogCategories"), "Category", name="logStatusError")
    experiment = {"startTime": "0.0", "stopTime": repr(duration_s), "stepSize": repr(step_s)}
    SubElement(root, "DefaultExperiment", experiment)
    variables, structure = SubElement(root, "ModelVariables"), SubElement(root, "ModelStructure")
    (_add_fmi2 if second else _add_fmi3)(variables, structure, ports)
    add_units(root, ports, "Real" if second else ".")
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True)


def _attributes(port: Port, reference: int) -> dict[str, str]:
    return {
        "name": port.name,
        "valueReference": str(reference),
        "causality": port.causality,
        "variability": "continuous",
        "description": port.description,
    }


def _add_fmi2(variables: Element, structure: Element, ports: Sequence[Port]) -> None:
    outputs, unknowns = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
    for reference, port in enumerate(ports):
        variable = SubElement(variables, "ScalarVariable", _attributes(port, reference))
        real = SubElement(variable, "Real")
        if port.causality == "input":
            real.set("start", repr(float(port.start)))
            continue
        variable.set("initial", "calculated")
        for listed in (outputs, unknowns):
            SubElement(listed, "Unknown", index=str(reference + 1))


def _add_fmi3(variables: Element, structure: Element, ports: Sequence[Port]) -> None:
    time = {"name": "time", "valueReference": str(len(ports)), "causality": "independent"}
    SubElement(variables, "Float64", time | {"variability": "continuous"})
    for reference, port in enumerate(ports):
        variable = SubElement(variables, "Float64", _attributes(port, reference))
        if port.causality == "input":
            variable.set("start", repr(float(port.start)))
        else:
            variable.set("initial", "calculated")
    for kind in ("Output", "InitialUnknown"):
        for reference, port in enumerate(ports):
            if port.causality == "output":
                SubElement(structure, kind, valueReference=str(reference))


def build_description() -> bytes:
    """XML of the FMI 3.0 build description."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=NAME)
    SubElement(SubElement(configuration, "SourceFileSet", language="C99"), "SourceFile", name="fmi3.c")
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True)
