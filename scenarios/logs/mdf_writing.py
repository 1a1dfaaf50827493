"""Writing of a run's signals as an ASAM MDF 4.1 file, for the measurement tools of vehicle makers."""

import json
from datetime import UTC, datetime
from pathlib import Path

from foreride.files.writing.atomic import replaced
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.logs.logged_run import RECORD, LoggedRun
from foreride.vehicle.state import signal_definition

RECORD_FILE = f"{RECORD}.json"
"""Attachment with the run's scenario and metrics."""
_NO_DATE = datetime(1970, 1, 1, tzinfo=UTC)
"""Start of the measurement: a simulated drive has no date."""
_DEFLATE_TRANSPOSED = 2


def write_mdf(logged: LoggedRun, path: Path) -> None:
    """Write all signals with their units and meanings, and what identifies the run, atomically."""
    asammdf = library("asammdf", "MF4")
    signals = logged.run.signals
    # Times from ticks: decimal fractions rounded once, so that every reader sees equal steps.
    times_s = [tick / TICKS_PER_SECOND for tick in range(len(signals["time_s"]))]
    channels = [
        asammdf.Signal(values, times_s, name=name, unit=unit, comment=meaning)
        for name, values in signals.items()
        if name != "time_s"
        for unit, meaning in [signal_definition(name)]
    ]
    with replaced(path) as scratch, asammdf.MDF(version="4.10") as file:
        file.start_time = _NO_DATE
        file.append(channels, comment="vehicle signals", common_timebase=True)
        content = json.dumps(logged.record()).encode()
        file.attach(content, file_name=RECORD_FILE, mime="application/json")
        file.save(scratch, overwrite=True, compression=_DEFLATE_TRANSPOSED, add_history_block=False)
