"""Elevation and superelevation of ASAM OpenDRIVE roads, rolled out straight.

Surfaces of lanes, road shapes and junctions are no part of it; roughness may be added by the scenario.
"""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import read_bytes, reading
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.reading_options import ReadingOptions

LIMIT = 64 << 20
STEP_M = 0.1
HALF_WIDTH_M = 5.0
_MAX_LENGTH_M = 100_000.0

Array = NDArray[np.float64]


def read(path: Path, options: ReadingOptions) -> RawProfile:
    """Profile along the reference line of a file with one road. Raises InputError naming the fault."""
    data = read_bytes(path, LIMIT)
    with reading(path):
        if b"<!ENTITY" in data:
            raise InputError(f"{path}: must not define entities")
        roads = ElementTree.fromstring(data).findall("road")
        if len(roads) != 1:
            raise InputError(f"{path}: must hold one road, got {len(roads)}; cut out the one to drive over")
        return _profile(path, roads[0])


def _profile(path: Path, road: ElementTree.Element) -> RawProfile:
    length_m = _number(path, road, "length")
    if not 0 < length_m <= _MAX_LENGTH_M:
        raise InputError(f"{path}: length must lie in 0 ... {_MAX_LENGTH_M:g} m, got {length_m:g}")
    lateral = road.find("lateralProfile")
    for name in ("shape", "crossSectionSurface"):
        if lateral is not None and lateral.find(name) is not None:
            raise InputError(f"{path}: lateralProfile/{name} cannot be read; export the surface as OpenCRG")
    x = np.append(np.arange(0.0, length_m, STEP_M), length_m)
    x = x[np.append(True, np.diff(x) > 1e-6)]
    height = _cubics(path, road.findall("elevationProfile/elevation"), x)
    bank = _cubics(path, road.findall("lateralProfile/superelevation"), x)
    if not bank.any():
        return RawProfile(x, np.array([0.0]), height[None])
    y_m = np.array([-HALF_WIDTH_M, HALF_WIDTH_M])
    return RawProfile(x, y_m, height + y_m[:, None] * np.tan(bank))


def _cubics(path: Path, pieces: list[ElementTree.Element], x: Array) -> Array:
    """Values at x of a chain of cubic polynomials, each from its own s on."""
    values = np.zeros(len(x))
    for piece in sorted(pieces, key=lambda item: _number(path, item, "s")):
        start, *coefficients = (_number(path, piece, name) for name in "sabcd")
        on = x >= start - 1e-9
        with np.errstate(over="ignore", invalid="ignore"):
            values[on] = np.polynomial.polynomial.polyval(x[on] - start, coefficients)
    if not np.isfinite(values).all():
        raise InputError(f"{path}: its polynomials must be finite along the road")
    return values


def _number(path: Path, element: ElementTree.Element, name: str) -> float:
    text = element.get(name, "")
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise InputError(f"{path}: {element.tag} {name} must be a finite number, got {shown(text)}")
    return value
