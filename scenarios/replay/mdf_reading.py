"""Reading of ASAM MDF files: channels with units, and the scenario that `foreride log` attaches."""

import gc
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from foreride.files.errors import InputError, printable, shortened
from foreride.files.reading.regular_file import reading
from foreride.files.reading.strict_json import parse_json
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.logs.logged_run import recorded_scenario
from foreride.scenarios.logs.mdf_writing import RECORD_FILE
from foreride.scenarios.replay.recording import RecordedImage, Series

_MAGIC = b"MDF     "


class MdfLog:
    """ASAM MDF file, versions 3 and 4."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with reading(path), path.open("rb") as stream:
            if (start := stream.read(len(_MAGIC))) != _MAGIC:
                raise InputError(f"{path}: must be an ASAM MDF file, it begins with {start!r}")

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        with reading(self.path), self.path.open("rb") as stream, self._mdf(stream) as file:
            yield file

    def _mdf(self, stream: BinaryIO) -> Any:
        """File of the library. One that it fails to open complains once more when deleted: not to users."""
        mdf, hook = library("asammdf", "MF4").MDF, sys.unraisablehook
        sys.unraisablehook = lambda _: None
        try:
            return mdf(stream)
        except Exception as error:
            reason = shortened(printable(error))
        finally:
            gc.collect()
            sys.unraisablehook = hook
        raise InputError(f"{self.path}: the file is truncated or damaged ({reason})")

    def channels(self) -> Sequence[str]:
        """Names of all channels."""
        with self._opened() as file:
            return list(file.channels_db)

    def series(self, channels: Iterable[str]) -> Mapping[str, Series]:
        """Samples of the channels as physical values."""
        with self._opened() as file:
            return {name: self._series(file, name) for name in channels}

    def _series(self, file: Any, name: str) -> Series:
        if len(places := file.channels_db[name]) > 1:
            raise InputError(f"{self.path}: channel {name} must be in one group, it is in {len(places)}")
        signal = file.get(name)
        samples = np.asarray(signal.samples)
        if samples.ndim != 1 or samples.dtype.kind not in "fiub":
            raise InputError(f"{self.path}: channel {name} must hold numbers, it holds {samples.dtype}")
        return Series(np.asarray(signal.timestamps, float), samples.astype(float), signal.unit or None)

    def scenario(self) -> dict[str, Any] | None:
        """Fields of the scenario in the attachment."""
        with self._opened() as file:
            for index, attachment in enumerate(file.attachments):
                if attachment.file_name == RECORD_FILE:
                    text = bytes(file.extract_attachment(index)[0]).decode()
                    place = f"{self.path}: {RECORD_FILE}"
                    return recorded_scenario(parse_json(text, place), place)
        return None

    def images(self, topic: str | None) -> Iterator[RecordedImage]:
        """None: an MDF file holds no images."""
        raise InputError(f"{self.path}: holds no images; name the folder that does as --images FOLDER")
