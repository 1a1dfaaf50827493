"""Export of a scenario's car as an FMU in plain C: sources, and a binary where a C compiler is found."""

import io
import os
import shutil
import subprocess
import tempfile
import zipfile
from hashlib import sha256
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, printable, shortened
from foreride.files.extras import install_command
from foreride.files.writing.atomic import write_bytes
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.fmu.block import Port
from foreride.scenarios.fmu.c_code.description import NAME, build_description, model_description
from foreride.scenarios.fmu.c_code.model import write_model
from foreride.scenarios.fmu.signals import METRIC_PORTS
from foreride.scenarios.fmu.vehicle_block import VehicleBlock
from foreride.scenarios.runs.write import to_json

_OWN = Path(__file__).parent
_HEADERS = {
    "2.0": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    "3.0": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}
_FLAGS = ("-shared", "-fPIC", "-O2", "-std=c99", "-ffp-contract=off", "-fvisibility=hidden")


def export_c(out: Path, scenario: Scenario, version: str) -> bool:
    """Write the FMU; return whether it holds a binary for this platform beside the sources.

    Raises InputError without FMPy, whose package holds the FMI headers, or if the compiler fails.
    """
    if scenario.vehicle.fmu:
        raise InputError(f"{scenario.name}: an FMU carries no other one; leave vehicle.fmu out")
    scenario.require_given_speed("an FMU")
    fmpy = _fmpy()
    block = VehicleBlock(scenario)
    ports = [port for port in block.ports if port not in METRIC_PORTS]
    with tempfile.TemporaryDirectory() as scratch:
        sources = Path(scratch) / "sources"
        sources.mkdir()
        wrapper = f"fmi{version[0]}.c"
        for name in (wrapper, "core.h"):
            shutil.copy(_OWN / name, sources)
        for name in _HEADERS[version]:
            shutil.copy(Path(fmpy.__file__).parent / "c-code" / name, sources)
        token = _write_model(sources, scenario, ports)
        if version == "3.0":
            (sources / "buildDescription.xml").write_bytes(build_description())
        description = model_description(version, token, ports, block.step_s, block.duration_s)
        (Path(scratch) / "modelDescription.xml").write_bytes(description)
        folder = fmpy.platform if version == "2.0" else fmpy.platform_tuple
        library = Path(scratch) / "binaries" / folder / f"{NAME}{fmpy.sharedLibraryExtension}"
        compiled = _compile(sources / wrapper, library)
        write_bytes(out, _zipped(Path(scratch)))
    return compiled


def _write_model(sources: Path, scenario: Scenario, ports: list[Port]) -> str:
    """Write the car's equations; return the FMU's token, which is that of this car."""
    token = sha256(to_json(scenario.mapping["vehicle"]).encode()).hexdigest()[:32]
    inputs = [port for port in ports if port.causality == "input"]
    write_model(sources, scenario.true_car, inputs, ports[len(inputs) :], token)
    return token


def _compile(source: Path, library: Path) -> bool:
    """Compile the sources into a library, if there is a C compiler."""
    named = os.environ.get("CC")
    compiler = (
        shutil.which(named) if named else next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    )
    if compiler is None:
        if named:
            raise InputError(f"the C compiler {printable(named)}, which CC names, is not found")
        return False
    library.parent.mkdir(parents=True)
    command = [compiler, *_FLAGS, "-o", str(library), str(source), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, errors="replace")
    if done.returncode:
        reason = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr)
        raise InputError(f"{compiler}: cannot compile the car: {shortened(printable(reason), 300)}")
    return True


def _zipped(folder: Path) -> bytes:
    """Archive of a folder, the same bytes for the same files."""
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            entry = zipfile.ZipInfo(path.relative_to(folder).as_posix())
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, path.read_bytes())
    return sink.getvalue()


def _fmpy() -> Any:
    try:
        import fmpy
    except ImportError:
        raise InputError(f"FMU export in C needs FMPy: {install_command('fmi')}") from None
    return fmpy
