"""ERD files of UMTRI's Engineering Research Division, as RoadRuf and ProVAL write them.

A first line ERDFILEV2.00, one of numbers (channels, samples, records, bytes, kind of data, step), lines of
keywords of eight letters with eight letters per channel, END, and the samples, here as text. See UMTRI, The
ERD File Specification.
"""

import re
from pathlib import Path

import numpy as np

from foreride.files.errors import InputError, printable, shortened, shown
from foreride.files.reading.regular_file import read_text, reading
from foreride.files.reading.units import LENGTHS_M
from foreride.road.io.raw_profile import TRACK_M, RawProfile
from foreride.road.io.reading_options import ReadingOptions, proposal

LIMIT = 256 << 20
_TEXT_DATA = 5
_NAME = 8  # letters of a keyword and of a channel's name or unit
_UNITS = {"inch": "in", "inches": "in", "feet": "ft", "meter": "m", "metre": "m", "meters": "m", "sec": "s"}
_MAX_CHANNELS = 1000


def read(path: Path, options: ReadingOptions) -> RawProfile:
    """Left and right, or the only profile of an ERD file; the options name other channels."""
    lines = read_text(path, LIMIT, "latin-1").splitlines()
    with reading(path):
        channels, step = _numbers(path, lines)
        ends = [number for number, line in enumerate(lines) if line.strip().upper() == "END"]
        if not ends:
            raise InputError(f"{path}: has no line END before its samples")
        header = lines[2 : ends[0]]
        samples = np.array(" ".join(lines[ends[0] + 1 :]).replace(",", " ").split(), float)
    if not len(samples) or len(samples) % channels or not np.isfinite(samples).all():
        raise InputError(
            f"{path}: must hold finite samples of {channels} channels, got {len(samples)} numbers"
        )
    names = _fields(header, "SHORTNAM", channels)
    chosen = _chosen(path, names, options)
    units = _fields(header, "UNITSNAM", channels)
    factors = [1.0 if options.unit else _factor(path, units[k], "unit") for k in chosen]
    heights = samples.reshape(-1, channels).T[chosen] * np.array(factors)[:, None]
    x = step * np.arange(heights.shape[1])
    x_unit = _unit(next((line[_NAME:] for line in header if line.upper().startswith("XUNITS")), "m") or "m")
    by_time = x_unit == "s"
    if not by_time and not options.x_unit:
        x = x * _factor(path, x_unit, "x_unit")
    if len(chosen) == 1:
        return RawProfile(x, np.array([0.0]), heights, by_time=by_time)
    return RawProfile(x, np.array([-TRACK_M / 2, TRACK_M / 2]), heights[::-1].copy(), by_time=by_time)


def _numbers(path: Path, lines: list[str]) -> tuple[int, float]:
    """Number of channels and step."""
    if not lines or not lines[0].strip().upper().startswith("ERDFILE") or len(lines) < 2:
        raise InputError(f"{path}: is not an ERD file (its first line must be ERDFILEV2.00)")
    numbers = [float(text) for text in re.split(r"[\s,]+", lines[1].strip(" ,\t"))]
    if len(numbers) < 6 or not np.isfinite(numbers).all():
        raise InputError(f"{path}: line 2 must hold six numbers or more, got {shown(lines[1].strip())}")
    channels, kind, step = int(numbers[0]), int(numbers[4]), numbers[5]
    if kind != _TEXT_DATA:
        raise InputError(
            f"{path}: its samples are binary (kind {kind}); they must be text, kind {_TEXT_DATA}"
        )
    if not 1 <= channels <= _MAX_CHANNELS or not 0 < step <= 1000:
        raise InputError(f"{path}: must have 1 ... {_MAX_CHANNELS} channels and a step above 0")
    return channels, step


def _fields(header: list[str], keyword: str, channels: int) -> list[str]:
    """Names or units of the channels: fixed columns of eight letters after the keyword."""
    line = next((line[_NAME:] for line in header if line.upper().startswith(keyword)), "")
    return [line[_NAME * k : _NAME * (k + 1)].strip() for k in range(channels)]


def _chosen(path: Path, names: list[str], options: ReadingOptions) -> list[int]:
    """Channels of the heights: one, or left and right."""
    wanted = [options.z] if options.z else [options.left, options.right] if options.left else []
    if wanted and all(name in names for name in wanted):
        return [names.index(str(name)) for name in wanted]
    if not wanted and len(names) == 1:
        return [0]
    sides = [[k for k, name in enumerate(names) if name.upper().startswith(side)] for side in "LR"]
    if not wanted and all(len(side) == 1 for side in sides):
        return [side[0] for side in sides]
    listed = shortened(printable(", ".join(name or "-" for name in names)), 150)
    raise InputError(f"{path}: has the channels {listed}; choose: {proposal(left='NAME', right='NAME')}")


def _unit(text: str) -> str:
    name = text.strip().lower()
    return _UNITS.get(name, name)


def _factor(path: Path, text: str, option: str) -> float:
    unit = _unit(text)
    if unit not in LENGTHS_M:
        raise InputError(
            f"{path}: has the unit {shown(text)}; give it: {proposal(**{option.replace('_', '-'): 'mm'})}"
        )
    return LENGTHS_M[unit]
