"""Loading of user-defined Python code named on the command line, and location of its failures."""

import importlib.util
import os
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from foreride.files.command_line import notify
from foreride.files.errors import InputError, printable, shortened

PATIENCE_S = 10.0
"""Loading time after which a notice is printed, s."""
FMUS_ALLOWED = "FORERIDE_ALLOW_FMU"
"""Environment variable that, set to anything, allows that the FMUs which scenarios name are run."""
_LONGEST = 200
_warnings_issued: set[str] = set()


def load(path: Path, subject: str) -> ModuleType:
    """Import a file as a module, which may import modules beside it; `subject` names it in messages.

    Raises InputError, in one line with file and line, for any failure: a syntax error, any exception,
    sys.exit. Ctrl-C passes.
    """
    spec = importlib.util.spec_from_file_location(f"own_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses and pickle look up classes by their module
    if (folder := os.path.dirname(os.path.abspath(path))) not in sys.path:
        sys.path.append(folder)  # last, so that modules beside the file are found but hide no other
    try:
        with waiting_for(f"{subject}: {path} to load"):
            spec.loader.exec_module(module)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise InputError(f"{subject}: {path} does not load ({error_text(error, path)})") from error
    return module


def require_fmus_allowed(subject: str) -> None:
    """Raise InputError unless the user allows the machine code of FMUs that a scenario names."""
    if not os.environ.get(FMUS_ALLOWED):
        raise InputError(f"{subject} is machine code, which runs only with --allow-fmu or {FMUS_ALLOWED}=1")


@contextmanager
def waiting_for(subject: str) -> Iterator[None]:
    """Print a notice on stderr if the block takes long."""
    message = f"still waiting for {printable(subject)}; Ctrl-C ends it"
    timer = threading.Timer(PATIENCE_S, notify, [message])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def location(error: BaseException, path: Path) -> str:
    """Location such as `file.py:12`: innermost line in the user's file, else where the error was raised."""
    if isinstance(error, SyntaxError) and error.filename and error.lineno:
        return f"{Path(error.filename).name}:{error.lineno}"
    frames = [(frame.f_code.co_filename, line) for frame, line in traceback.walk_tb(error.__traceback__)]
    own_frames = [(file, line) for file, line in frames if file == os.path.abspath(path)]
    frames = own_frames or [frame for frame in frames if not frame[0].startswith("<frozen")]
    if not frames:
        return path.name
    file, line = frames[-1]
    return f"{Path(file).name}:{line}"


def error_text(error: BaseException, path: Path) -> str:
    """Type, message and location of an error, in one line of bounded length."""
    try:
        message = error.msg if isinstance(error, SyntaxError) else str(error)
    except Exception:  # the exception's own __str__ may fail
        message = ""
    message = shortened(printable(message), _LONGEST)
    return f"{type(error).__name__}{': ' if message else ''}{message} at {location(error, path)}"


def say_once(key: str, message: str) -> None:
    """Print a warning on stderr, once per process for each `key`."""
    if key not in _warnings_issued:
        _warnings_issued.add(key)
        notify(message)
