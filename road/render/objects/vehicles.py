"""Random cars, vans, lorries, rickshaws and houses as polygon bodies."""

import numpy as np

from foreride.road.render.objects.props import Colour, Face, Solid, panel, place_body, prism, wheel

_PAINTS: tuple[Colour, ...] = (
    (0.62, 0.62, 0.62),
    (0.55, 0.55, 0.57),
    (0.28, 0.29, 0.30),
    (0.10, 0.10, 0.11),
    (0.025, 0.025, 0.03),
    (0.35, 0.03, 0.03),
    (0.05, 0.08, 0.25),
    (0.12, 0.18, 0.14),
    (0.50, 0.42, 0.28),
    (0.55, 0.35, 0.04),
)
_GLASS: Colour = (0.03, 0.035, 0.04)
_BLACK: Colour = (0.02, 0.02, 0.02)
_WALLS: tuple[Colour, ...] = (
    (0.50, 0.46, 0.38),
    (0.58, 0.56, 0.52),
    (0.36, 0.19, 0.13),
    (0.55, 0.42, 0.25),
    (0.30, 0.42, 0.50),
    (0.45, 0.45, 0.44),
)
_SHARES = {"car": 0.58, "van": 0.16, "lorry": 0.14, "rickshaw": 0.12}


def random_vehicle(rng: np.random.Generator, x: float, y: float, yaw: float, lights: bool) -> Solid:
    """Random vehicle with its middle at x, y; `lights` are on at night."""
    kind = str(rng.choice(list(_SHARES), p=list(_SHARES.values())))
    paint = _PAINTS[int(rng.integers(len(_PAINTS)))]
    if kind == "car":
        size, faces = _car(rng, paint)
    elif kind == "rickshaw":
        size, faces = _rickshaw(rng)
    else:
        size, faces = _box(rng, paint, kind)
    length, width, height = size
    faces += _lamps(length, width, 0.75 if kind != "lorry" else 0.95, lights)
    outline = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (length / 2, width / 2)
    return place_body(faces, outline, height, x, y, yaw)


def house(rng: np.random.Generator, x: float, y: float) -> Solid:
    """Random house, wall or shed; y is its middle."""
    length, width = rng.uniform(4, 14), rng.uniform(4, 8)
    height = rng.choice((rng.uniform(1.2, 2.2), rng.uniform(2.8, 4), rng.uniform(5, 10)))
    wall = _WALLS[int(rng.integers(len(_WALLS)))]
    box = (-length / 2, length / 2, -width / 2, width / 2)
    faces = prism(box, box, (0.0, height), wall)
    if height > 2.5:
        faces += _windows(rng, length, width, height)
    outline = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (length / 2, width / 2)
    return place_body(faces, outline, float(height), x, y, float(rng.normal(0, 0.03)))


def _windows(rng: np.random.Generator, length: float, width: float, height: float) -> list[Face]:
    albedo, size = (0.05, 0.06, 0.07), rng.uniform(0.8, 1.3)
    faces = []
    for z in np.arange(1.0, height - 1.2, 3.0):
        for x in np.arange(-length / 2 + 1, length / 2 - 1.5, 2.4):
            for side in (-1, 1):
                points = np.array([[x, 0, z], [x + size, 0, z], [x + size, 0, z + size], [x, 0, z + size]])
                points[:, 1] = side * (width / 2 + 0.01)
                faces.append(Face(points, np.array([0.0, float(side), 0.0]), albedo))
        for y in np.arange(-width / 2 + 0.8, width / 2 - 1.5, 2.2):
            faces.append(panel(-length / 2 - 0.01, (y, y + size), (z, z + size), -1, albedo))
    return faces


def _car(rng: np.random.Generator, paint: Colour) -> tuple[tuple[float, float, float], list[Face]]:
    length, width, height = rng.uniform(3.6, 4.7), rng.uniform(1.6, 1.85), rng.uniform(1.4, 1.7)
    waist, half, side = 0.6 * height, length / 2, width / 2
    trunk = rng.choice((0.1, 0.18 * length))  # hatchback or saloon
    faces = _running_gear(half, side, 0.31)
    body = (-half, half, -side, side)
    faces += prism(body, (-half + 0.06, half - 0.1, -side + 0.03, side - 0.03), (0.25, waist), paint)
    faces += _wheels(half, side, 0.31)
    cabin = (-half + trunk, half - 0.27 * length, -side + 0.05, side - 0.05)
    roof = (-half + trunk + 0.35, half - 0.42 * length, -side + 0.22, side - 0.22)
    faces += prism(cabin, roof, (waist, height), paint, _GLASS)
    return (length, width, height), faces


def _box(rng: np.random.Generator, paint: Colour, kind: str) -> tuple[tuple[float, float, float], list[Face]]:
    """Van or bus, or lorry with a load."""
    lorry = kind == "lorry"
    length, width = (
        (rng.uniform(5.5, 9), rng.uniform(2.1, 2.5))
        if lorry
        else (rng.uniform(4.2, 8), rng.uniform(1.7, 2.4))
    )
    height = rng.uniform(2.5, 3.4) if lorry else rng.uniform(1.9, 3.0)
    half, side, radius = length / 2, width / 2, 0.45 if lorry else 0.34
    faces = _running_gear(half, side, radius)
    floor = 0.9 if lorry else 0.35
    body = (-half, half - (1.6 if lorry else 0.0), -side, side)
    if lorry:
        cab = (half - 1.5, half, -side + 0.05, side - 0.05)
        faces += prism(cab, cab, (0.5, 2.3), paint, _GLASS)
        paint = _PAINTS[int(rng.integers(len(_PAINTS)))]
    faces += prism(body, body, (floor, height), paint)
    if not lorry:
        band = tuple(v * 1.004 for v in body)
        faces += prism(band, band, (0.55 * height, 0.85 * height), paint, _GLASS)  # type: ignore[arg-type]
    faces += _wheels(half, side, radius)
    return (length, width, height), faces


def _rickshaw(rng: np.random.Generator) -> tuple[tuple[float, float, float], list[Face]]:
    length, width, height = 2.6, 1.3, 1.75
    low = (-1.3, 1.2, -0.65, 0.65)
    green = (0.03, 0.16, 0.06) if rng.random() < 0.5 else _BLACK
    faces = _running_gear(1.3, 0.65, 0.22)
    faces += prism(low, low, (0.25, 0.9), green)
    faces += prism(low, (-1.1, 0.8, -0.6, 0.6), (0.9, height), (0.50, 0.36, 0.04), _GLASS)
    return (length, width, height), faces + _wheels(1.3, 0.65, 0.22)


def _running_gear(half: float, side: float, radius: float) -> list[Face]:
    """Dark parts under the body: axles and tyre treads."""
    base = (-half + 0.15, half - 0.15, -side + 0.12, side - 0.12)
    faces = prism(base, base, (0.12, 0.5), _BLACK)
    for facing in (-1, 1):
        for y in (-side + 0.02, side - 0.24):
            faces.append(panel(facing * (half - 0.2), (y, y + 0.22), (0.0, 1.6 * radius), facing, _BLACK))
    return faces


def _wheels(half: float, side: float, radius: float) -> list[Face]:
    positions = [(x, s) for x in (-0.62 * half, 0.62 * half) for s in (-1, 1)]
    return [face for x, s in positions for face in wheel(x, s * side, radius, s)]


def _lamps(length: float, width: float, height: float, lights: bool) -> list[Face]:
    """Red lamps and a plate at the rear, white lamps in front."""
    rear, front = -length / 2 - 0.02, length / 2 + 0.02
    red = (0.9, 0.05, 0.03) if lights else (0.0, 0.0, 0.0)
    white = (3.0, 2.8, 2.3) if lights else (0.0, 0.0, 0.0)
    faces = [panel(rear, (-0.26, 0.26), (height - 0.3, height - 0.18), -1, (0.5, 0.48, 0.4))]
    for s in (-1, 1):
        y = (
            min(s * (width / 2 - 0.32), s * (width / 2 - 0.06)),
            max(s * (width / 2 - 0.32), s * (width / 2 - 0.06)),
        )
        faces.append(panel(rear, y, (height - 0.12, height + 0.08), -1, (0.35, 0.02, 0.02), red))
        faces.append(panel(front, y, (height - 0.16, height + 0.02), 1, (0.45, 0.45, 0.45), white))
    return faces
