"""Libraries of the log formats, which the extra `logs` installs, that of Rerun the extra `rerun`."""

import importlib
from types import ModuleType

from foreride.files.errors import InputError
from foreride.files.extras import install_command

EXTRA = "logs"


def library(name: str, purpose: str, extra: str = EXTRA) -> ModuleType:
    """Import a module of an extra; InputError with the command that installs it if it is missing."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        missing = (error.name or name).partition(".")[0]
        raise InputError(f"{purpose} needs {missing}: {install_command(extra)}") from None
