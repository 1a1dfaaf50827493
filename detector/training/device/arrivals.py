"""Images that renderers add to a data set while a detector trains on it: `foreride detector train --grow`."""

import threading
from collections.abc import Callable, Sequence, Set
from pathlib import Path
from queue import Empty, SimpleQueue

from foreride.detector.data.yolo_folder import Sample, image_paths
from foreride.files.errors import InputError

Read = Callable[[Set[str]], Sequence[Sample]]
"""Reads the images of these names; it may leave out unusable ones."""


class Arrivals:
    """New images of a growing folder, read by a thread of its own every `every_s` seconds, each once.

    known: names of the images that are there already.
    """

    def __init__(self, folder: Path, read: Read, known: Set[str], every_s: float = 5.0):
        self._folder, self._read, self._known, self._every_s = folder, read, set(known), every_s
        self._found: SimpleQueue[list[Sample] | InputError] = SimpleQueue()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="arrivals", daemon=True)

    def __enter__(self) -> "Arrivals":
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._stopped.set()
        self._thread.join()

    def taken(self) -> list[Sample]:
        """Images found since the last call. Raises InputError for an unusable one."""
        samples: list[Sample] = []
        try:
            while True:
                found = self._found.get_nowait()
                if isinstance(found, InputError):
                    raise found
                samples += found
        except Empty:
            return samples

    def _watch(self) -> None:
        while not self._stopped.wait(self._every_s):
            try:
                new = {path.name for path in image_paths(self._folder)} - self._known
                samples = list(self._read(new)) if new else []
            except InputError as error:
                self._found.put(error)
                return
            self._known |= new
            if samples:
                self._found.put(samples)
