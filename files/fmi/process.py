"""Connection to the process in which a foreign FMU runs: a crash or an exit there is an error here."""

import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import weakref
from contextlib import suppress
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, printable, shortened
from foreride.files.extras import install_command
from foreride.files.own_code import waiting_for

_WORKER = Path(__file__).with_name("worker.py")
_LONGEST = 250


class FmuProcess:
    """Process of one FMU, with a folder for its files; both end with this object."""

    def __init__(self, subject: str) -> None:
        """Start the process; `subject` names the FMU in messages."""
        self._subject = subject
        self.folder = tempfile.mkdtemp(prefix="foreride-fmu-")
        # -P: the folder of the script must not hide modules of other packages.
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(_WORKER)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._ending = weakref.finalize(self, _end, self._process, self.folder)
        self._send(sys.path)

    def ask(self, name: str, *arguments: Any) -> Any:
        """Answer of the method `name` of `files.fmi.worker.Unit`. Raises InputError with the reason."""
        with waiting_for(self._subject):
            self._send((name, arguments))
            try:
                status, answer = pickle.load(self._process.stdout)  # type: ignore[arg-type]
            except (EOFError, pickle.UnpicklingError):
                raise InputError(f"{self._subject}: its process {self._ended()}") from None
        if status == "missing":
            raise InputError(f"{self._subject}: FMUs need FMPy ({answer}): {install_command('fmi')}")
        if status == "failed":
            raise InputError(f"{self._subject}: {shortened(printable(answer), _LONGEST)}")
        return answer

    def close(self) -> None:
        """End the process and remove its folder."""
        self._ending()

    def _send(self, value: Any) -> None:
        assert self._process.stdin is not None
        with suppress(OSError):  # of a process that has ended: the answer says so
            pickle.dump(value, self._process.stdin)
            self._process.stdin.flush()

    def _ended(self) -> str:
        status = self._process.wait()
        if status >= 0:
            return f"ended with status {status}"
        try:
            return f"was ended by {signal.Signals(-status).name}"
        except ValueError:
            return f"was ended by signal {-status}"


def _end(process: subprocess.Popen, folder: str) -> None:
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError):
                stream.close()
    try:
        process.wait(timeout=5.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    shutil.rmtree(folder, ignore_errors=True)
