"""`foreride replay`: a recording's images and signals through detector and estimator."""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.table import Table

from foreride.files.command_line import notify
from foreride.files.errors import InputError, shown
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import check_folder
from foreride.scenarios.commands.console import console, tracked
from foreride.scenarios.commands.inspect.replay_surface import execute_surface
from foreride.scenarios.commands.options import add_json_option, overrides_of
from foreride.scenarios.perceptions.camera import build_estimator, load_detector
from foreride.scenarios.perceptions.image_band import image_band
from foreride.scenarios.replay.channels import needed_signals, parse_choices
from foreride.scenarios.replay.csv_reading import CsvLog
from foreride.scenarios.replay.image_folder import image_times, read_images
from foreride.scenarios.replay.mcap_reading import McapLog
from foreride.scenarios.replay.mdf_reading import MdfLog
from foreride.scenarios.replay.outputs import KIND, TRACK_COLUMNS, summary, write_replay
from foreride.scenarios.replay.playback import replay
from foreride.scenarios.replay.recording import Log, RecordedImage, read_signals
from foreride.scenarios.replay.replay_scenario import replay_scenario
from foreride.scenarios.runs.write import to_json

_LOGS: dict[str, type] = {".mcap": McapLog, ".mf4": MdfLog, ".mdf": MdfLog, ".dat": MdfLog, ".csv": CsvLog}
"""Readers by suffix."""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    told = f"recording: {', '.join(_LOGS)}, or a folder laid out as in the RSRD data set"
    command.add_argument("log", type=Path, metavar="LOG", help=told)
    told = "folder of images with images.csv (time_s,file) or names in ms; of MCAP, the topic of one camera"
    command.add_argument("--images", metavar="FOLDER|TOPIC", help=told)
    told = "its car, camera, detector and estimator; by default those of the log, if foreride wrote it"
    told_stereo = "of a folder of a recorded surface: heights from the stereo pairs, not from the clouds"
    command.add_argument("--stereo", action="store_true", help=told_stereo)
    command.add_argument("--scenario", metavar="NAME|FILE", help=told)
    told = "channel of a signal, as pitch_rate='-imu.wy [deg/s]', or a constant, as roll_rate=0"
    command.add_argument("--signal", action="append", default=[], metavar="NAME=CHANNEL", help=told)
    command.add_argument(
        "--vehicle", metavar="MODEL", help="quarter, half, full, or a YAML file of parameters"
    )
    told = "set any scenario field, as camera.height_m=1.4; may be repeated"
    command.add_argument(
        "--set", action="append", default=[], metavar="PATH.TO.FIELD=VALUE", dest="overrides", help=told
    )
    add_json_option(command, "write the summary as JSON")
    command.add_argument(
        "--out", type=Path, metavar="DIR", help="output folder (default: LOG-replay beside it)"
    )
    command.set_defaults(execute=execute, observer=None, settings=None, allow_fmu=False)


def execute(arguments: argparse.Namespace) -> int:
    """Replay, write the folder, print the tracks."""
    if arguments.log.is_dir():
        return execute_surface(arguments)
    log = _opened(arguments.log)
    if arguments.stereo:
        raise InputError(f"--stereo must be left out for {arguments.log}; it is of a folder of a surface")
    out = arguments.out or arguments.log.with_name(f"{arguments.log.stem}-replay")
    check_folder(out, KIND)
    named = arguments.scenario
    scenario = replay_scenario(
        named, None if named else log.scenario(), overrides_of(arguments), arguments.log
    )
    choices = parse_choices(arguments.signal, needed_signals(scenario.vehicle.parameters))
    signals = read_signals(log, choices, scenario.control.rate_hz)
    detector = load_detector(scenario)
    images = _images(log, arguments.images)
    estimator = build_estimator(scenario, detector.calibration)
    result = replay(
        signals, images, scenario, estimator, detector, image_band(scenario, estimator.mount, detector)
    )
    if not result.looks:
        raise InputError(
            f"{arguments.images or arguments.log}: must hold images exposed during the signals, "
            f"{signals.start_s:g} ... {signals.start_s + signals.times_s[-1]:g} s; "
            f"{result.left_out} images lie outside"
        )
    if result.left_out:
        notify(f"{result.left_out} images were exposed before or after the signals and are left out")
    told = summary(result, signals, scenario, arguments.log)
    write_replay(result, told, signals, out)
    console.print(_tracks(told))
    console.print(f"{told['images']} images, {told['distance_m']:.1f} m: {out}/")
    if arguments.json:
        write_text(arguments.json, to_json(told) + "\n")
    return 0


def _opened(path: Path) -> Log:
    if path.suffix.lower() not in _LOGS:
        got = shown(path.suffix) if path.exists() else "nothing"
        raise InputError(f"{path}: must be a file {', '.join(_LOGS)} or a folder, got {got}")
    log: Log = _LOGS[path.suffix.lower()](path)
    return log


def _images(log: Log, named: str | None) -> Iterator[RecordedImage]:
    """Images of a folder, or of a topic of the log, with a progress display."""
    if named is not None and Path(named).is_dir():
        folder = Path(named)
        return tracked(read_images(folder), "replaying", len(image_times(folder)))
    return tracked(log.images(named), "replaying")


def _tracks(told: dict[str, Any]) -> Table:
    table = Table(*TRACK_COLUMNS, title="tracks that were confirmed")
    for row in told["tracks"]:
        cells = (row[name] for name in TRACK_COLUMNS)
        table.add_row(*(f"{cell:.3f}" if isinstance(cell, float) else str(cell) for cell in cells))
    return table
