"""Additions to the model description that the exporters leave out: units and unknowns at initialization."""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from foreride.files.fmi.units import BASE_UNITS
from foreride.scenarios.fmu.block import Port

_AHEAD_OF_UNITS = ("ModelExchange", "CoSimulation", "ScheduledExecution")


def add_units(root: Element, ports: Sequence[Port], variable_path: str) -> None:
    """Add the definitions of the ports' units, and a unit to each variable, found by its name.

    variable_path: path from a variable to the element with the unit, `.` for the variable.
    """
    definitions = Element("UnitDefinitions")
    for unit in sorted({port.unit for port in ports}):
        exponents = {base: str(exponent) for base, exponent in BASE_UNITS[unit].items()}
        SubElement(SubElement(definitions, "Unit", {"name": unit}), "BaseUnit", exponents)
    place = max(i for i, child in enumerate(root) if child.tag in _AHEAD_OF_UNITS) + 1
    root.insert(place, definitions)
    units = {port.name: port.unit for port in ports}
    for variable in root.iterfind("ModelVariables/*"):
        element = variable.find(variable_path)
        if element is not None and variable.get("name") in units:
            element.set("unit", units[str(variable.get("name"))])


def add_initial_unknowns(root: Element) -> None:
    """List every output under `ModelStructure/InitialUnknowns`, as FMI 2.0 demands of calculated outputs."""
    structure = root.find("ModelStructure")
    outputs = root.findall("ModelStructure/Outputs/Unknown")
    if structure is not None and outputs:
        unknowns = SubElement(structure, "InitialUnknowns")
        for output in outputs:
            SubElement(unknowns, "Unknown", dict(output.attrib))
