"""Foreign FMU: its variables connected by name to quantities of the loop, with units converted to SI."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, nearest, printable, shown
from foreride.files.fmi.process import FmuProcess
from foreride.files.fmi.units import Declared, conversion
from foreride.files.own_code import say_once
from foreride.files.reading.regular_file import read_bytes

Array = NDArray[np.float64]
_STEP_TOLERANCE = 1e-6
_REALS = ("Real", "Float64")


class Quantity(NamedTuple):
    """Quantity of the loop: an input or output of an FMU, with its unit (of `files.fmi.units.BASE_UNITS`)."""

    name: str
    unit: str
    causality: Literal["input", "output"]
    required: bool = False


class FmuFailed(InputError):
    """Failure of a step of an FMU; `outputs` has a row for each complete step before it."""

    outputs: Array = np.empty((0, 0))


class _Wire(NamedTuple):
    """Connected quantity: the FMU's value reference, and factor and offset of its unit."""

    name: str
    reference: int
    factor: float
    offset: float


class ForeignFmu:
    """FMU of another tool, in a process of its own, whose instance begins with `start`.

    inputs, outputs: names of the connected quantities, in the order of values.
    """

    def __init__(
        self, path: Path | str, subject: str, quantities: Sequence[Quantity], names: Mapping[str, str]
    ) -> None:
        """Read the FMU and connect its variables: that of `names`, or the one with a quantity's own name.

        Raises InputError, beginning with `subject`, for a file that is no FMU for co-simulation on this
        platform, for a missing required variable, and for one of the wrong direction, type or unit.
        """
        self._path, self._subject = str(Path(path).absolute()), f"{subject} {printable(path)}"
        read_bytes(path)
        self._process = FmuProcess(self._subject)
        self._description = self._process.ask("describe", self._path)
        self._check_kind()
        wires = {"input": self._wires("input", quantities, names), "output": []}
        wires["output"] = self._wires("output", quantities, names)
        self._check_names(quantities, names)
        self._ins, self._outs = wires["input"], wires["output"]
        self.inputs = [wire.name for wire in self._ins]
        self.outputs = [wire.name for wire in self._outs]
        self._say_unconnected()
        self._started = False

    def check_step(self, step_s: float) -> None:
        """Raise InputError unless the FMU's own fixed step divides a communication step."""
        own_s = self._description["step_s"]
        if own_s is None:
            return
        ratio = step_s / own_s if own_s > 0.0 else 0.0
        if ratio < 0.5 or abs(ratio - round(ratio)) > _STEP_TOLERANCE * ratio:
            raise self._refusal(
                f"its fixed step of {own_s:g} s does not divide the loop's step of {step_s:g} s"
            )

    def start(self, values: Array) -> Array:
        """Begin at time zero with the inputs; return the outputs. Again, this begins in a new process."""
        if self._started:
            self._process.close()
            self._process = FmuProcess(self._subject)
            self._process.ask("describe", self._path)
        self._started = True
        references = [wire.reference for wire in self._ins], [wire.reference for wire in self._outs]
        given = self._to_fmu(values[None])[0].tolist()
        return self._from_fmu(
            np.array([self._process.ask("start", self._process.folder, *references, given)])
        )[0]

    def advance(self, step_s: float, given: Array, seen: Array | None = None) -> Array:
        """Advance by a step for each row of inputs; return a row of outputs for each.

        The outputs are those at the end of the step, with the inputs `seen` at that time; without, those at
        its beginning with the inputs of the step. Raises FmuFailed.
        """
        early = seen is None
        rows = [self._to_fmu(part).tolist() for part in (given, given if seen is None else seen)]
        try:
            answered, reason = self._process.ask("advance", step_s, *rows, early)
        except InputError as error:
            raise FmuFailed(str(error)) from None
        outputs = self._from_fmu(np.array(answered, float).reshape(-1, len(self._outs)))
        finite = np.isfinite(outputs).all(axis=1)
        if not finite.all():
            first = int(np.argmin(finite))
            worst = self.outputs[int(np.argmin(np.isfinite(outputs[first])))]
            raise self._failed(f"its {worst} is not a finite number", outputs[:first])
        if reason is not None:
            raise self._failed(reason, outputs)
        return outputs

    def _failed(self, reason: str, outputs: Array) -> FmuFailed:
        error = FmuFailed(f"{self._subject}: {reason}")
        error.outputs = outputs
        return error

    def _to_fmu(self, values: Array) -> Array:
        factors = np.array([wire.factor for wire in self._ins])
        return (values - np.array([wire.offset for wire in self._ins])) / factors

    def _from_fmu(self, values: Array) -> Array:
        offsets = np.array([wire.offset for wire in self._outs])
        return values * np.array([wire.factor for wire in self._outs]) + offsets

    def _check_kind(self) -> None:
        told = self._description
        if told["version"][:1] not in ("2", "3") or not told["cosimulation"]:
            kind = f"FMI {told['version']}" + ("" if told["cosimulation"] else " without co-simulation")
            raise self._refusal(f"must be for co-simulation in FMI 2.0 or 3.0, got {kind}")
        if told["platform"] not in told["platforms"]:
            found = ", ".join(told["platforms"]) or "none"
            raise self._refusal(f"is not for this platform, {told['platform']}; it has binaries for {found}")

    def _wires(self, causality: str, quantities: Sequence[Quantity], names: Mapping[str, str]) -> list[_Wire]:
        return [
            wire
            for quantity in quantities
            if quantity.causality == causality and (wire := self._wire(quantity, names.get(quantity.name)))
        ]

    def _wire(self, quantity: Quantity, named: str | None) -> _Wire | None:
        variables, name = self._description["variables"], named or quantity.name
        variable = variables.get(name)
        if variable is None:
            if named is None and not quantity.required:
                return None
            hint = nearest(name, variables) or "; name one of its variables in map"
            asked = "" if name == quantity.name else f" for {quantity.name}"
            raise self._refusal(f"has no variable {shown(name)}{asked}{hint}")
        allowed = ("input",) if quantity.causality == "input" else ("output", "local")
        if variable["causality"] not in allowed:
            if named is None and not quantity.required:
                return None
            wanted = " or ".join(allowed)
            raise self._refusal(f"variable {shown(name)} must be {wanted}, it is {variable['causality']}")
        if variable["type"] not in _REALS or variable["array"]:
            kind = "an array" if variable["array"] else f"of type {variable['type']}"
            raise self._refusal(f"variable {shown(name)} must be a single Real or Float64, it is {kind}")
        try:
            scale = conversion(variable["unit"] and Declared(*variable["unit"]), quantity.unit)
        except InputError as error:
            raise self._refusal(f"variable {shown(name)} {error}") from None
        return _Wire(quantity.name, variable["reference"], *scale)

    def _check_names(self, quantities: Sequence[Quantity], names: Mapping[str, str]) -> None:
        known = [quantity.name for quantity in quantities]
        for name in names:
            if name not in known:
                hint = nearest(name, known) or f"; such are {', '.join(known[:6])}"
                raise self._refusal(f"map.{name} is no quantity of the loop{hint}")

    def _say_unconnected(self) -> None:
        connected = {wire.reference for wire in self._ins}
        free = [
            name
            for name, variable in self._description["variables"].items()
            if variable["causality"] == "input" and variable["reference"] not in connected
        ]
        if free:
            listed = ", ".join(free[:5]) + (f" and {len(free) - 5} more" if len(free) > 5 else "")
            say_once(
                self._subject,
                f"{self._subject}: inputs that nothing drives keep their start values: {listed}",
            )

    def _refusal(self, reason: Any) -> InputError:
        return InputError(f"{self._subject}: {reason}")
