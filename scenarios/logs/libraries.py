"""Libraries of the log formats, which the extra `logs` installs."""

import importlib
from types import ModuleType

from foreride.files.errors import InputError
from foreride.files.extras import install_command

EXTRA = "logs"


def library(name: str, purpose: str) -> ModuleType:
    """Import a module of the extra; InputError with the command that installs it if it is missing."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        missing = (error.name or name).partition(".")[0]
        raise InputError(f"{purpose} needs {missing}: {install_command(EXTRA)}") from None
