"""Export of a part of the loop as an FMU that runs foreride in the importer's process."""

import importlib
import sys
import tempfile
from hashlib import sha256
from pathlib import Path
from typing import Any, Literal

from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_bytes
from foreride.scenarios.cases import Case
from foreride.scenarios.fmu.embedded import Part, embed
from foreride.scenarios.fmu.slave import SCRIPT

FmiVersion = Literal["2.0", "3.0"]
FMI_VERSIONS: tuple[FmiVersion, ...] = ("2.0", "3.0")
_SCRIPT = {
    "2.0": "from pythonfmu import Fmi2Slave  # the exporter looks for a class of this base\n"
    "from foreride.scenarios.fmu.slave_fmi2 import Fmi2BlockSlave\n\n\n"
    "class {name}(Fmi2BlockSlave, Fmi2Slave):\n    pass\n",
    "3.0": "from pythonfmu3 import Fmi3Slave  # the exporter looks for a class of this base\n"
    "from foreride.scenarios.fmu.slave_fmi3 import Fmi3BlockSlave\n\n\n"
    "class {name}(Fmi3BlockSlave, Fmi3Slave):\n    pass\n",
}


def export(
    out: Path, part: Part, case: Case, version: FmiVersion, preview: dict[str, float] | None = None
) -> None:
    """Write an FMU of a part of the loop of a case.

    The importer's process needs Python with foreride. Raises InputError for a case that an FMU cannot carry
    or without the exporter.
    """
    package = {"2.0": "pythonfmu", "3.0": "pythonfmu3"}[version]
    builder = _builder(package)
    name = f"Foreride{part.title()}"
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        files = embed(folder, part, case, preview or {})
        # Importers hold one Python process, so that modules of different FMUs need different names.
        script = folder / f"{SCRIPT}{sha256(files[0].read_bytes()).hexdigest()[:16]}_fmi{version[0]}.py"
        script.write_text(_SCRIPT[version].format(name=name))
        options: dict[str, Any] = {"needsExecutionTool": True, "canHandleVariableCommunicationStepSize": True}
        saved = part == "vehicle"
        for option in ("canGetAndSetFMU", "canSerializeFMU"):
            options[option + ("State" if version == "3.0" else "state")] = saved
        sys.modules.pop(script.stem, None)
        built = builder.build_FMU(script, dest=folder / "built", project_files=files, **options)
        sys.modules.pop(script.stem, None)
        write_bytes(out, built.read_bytes())


def _builder(package: str) -> Any:
    try:
        return importlib.import_module(f"{package}.builder").FmuBuilder
    except ImportError:
        raise InputError(f'FMU export needs {package}: pip install "foreride[fmi]"') from None
