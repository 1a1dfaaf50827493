"""Random roadside objects and traffic: trees, houses, poles, vehicles, people."""

import numpy as np

from foreride.road.render.appearance import Appearance
from foreride.road.render.objects import sprites, vehicles
from foreride.road.render.objects.props import Prop, Sprite, pyramid

REACH_M = 150.0
_LAMP_GLOW = np.array((1.0, 0.75, 0.42))
_TREE_SPACING_M = {"avenue": 8.0, "country": 22.0, "town": 30.0}
_HOUSE_SPACING_M = {"avenue": 60.0, "country": 90.0, "town": 22.0}
_BUSH_SPACING_M = {"avenue": 9.0, "country": 12.0, "town": 40.0}


def static_objects(rng: np.random.Generator, appearance: Appearance) -> list[Prop]:
    """Static roadside objects of an appearance, from the start of the road to REACH_M."""
    props: list[Prop] = []
    density = rng.uniform(0.3, 1.6, 3)
    pictures = [pyramid(sprites.tree(rng)) for _ in range(5)]
    bushes = [pyramid(sprites.bush(rng)) for _ in range(3)]
    for side, edge in ((-1, appearance.right_edge_m), (1, appearance.left_edge_m)):
        for x in _random_stations(rng, _TREE_SPACING_M[appearance.surroundings] / density[0]):
            offset = rng.gamma(2.0, 1.3 if appearance.surroundings == "avenue" else 3.0) + 1.2
            props.append(_tree(rng, x, edge + side * offset, pictures[int(rng.integers(5))]))
        for x in _random_stations(rng, _BUSH_SPACING_M[appearance.surroundings] / density[1]):
            height = rng.uniform(0.4, 2.0)
            y = edge + side * (rng.gamma(2.0, 2.0) + 1.0)
            props.append(Sprite(x, y, height * rng.uniform(1.2, 2.5), height, bushes[int(rng.integers(3))]))
        for x in _random_stations(rng, _HOUSE_SPACING_M[appearance.surroundings] / density[2]):
            props.append(vehicles.house(rng, x, edge + side * rng.uniform(6, 16)))
        for x in _random_stations(rng, 40.0):
            height = rng.uniform(1.8, 2.8)
            props.append(
                Sprite(
                    x,
                    edge + side * rng.uniform(0.4, 2),
                    height * 48 / 128,
                    height,
                    pyramid(sprites.sign(rng)),
                )
            )
    return props + _poles(rng, appearance)


def random_traffic(rng: np.random.Generator, appearance: Appearance, x: float) -> list[Prop]:
    """Vehicles and people around a camera at x."""
    lights = appearance.light == "night" or (appearance.light == "sunset" and rng.random() < 0.5)
    right, left = appearance.right_edge_m, appearance.left_edge_m
    oncoming_side = 1 if left > -right else -1  # the side of the oncoming lane
    props: list[Prop] = []
    if rng.random() < 0.1:
        props.append(vehicles.random_vehicle(rng, x + 6 + _distance(rng), rng.normal(0, 0.3), 0.0, lights))
    if left - right > 5.5:
        for _ in range(rng.binomial(2, 0.17)):
            y = oncoming_side * rng.uniform(2.4, max(max(left, -right) - 1.2, 2.5))
            props.append(
                vehicles.random_vehicle(rng, x + _distance(rng), y, np.pi + rng.normal(0, 0.03), lights)
            )
    for _ in range(rng.binomial(3, 0.16)):
        side, edge = ((-1, right), (1, left))[int(rng.integers(2))]
        yaw = rng.choice((0.0, np.pi)) + rng.normal(0, 0.06)
        y = edge + side * rng.uniform(-0.3, 1.6)
        props.append(vehicles.random_vehicle(rng, x + _distance(rng), y, float(yaw), False))
    for _ in range(rng.choice((0, 1, 2, 4), p=(0.68, 0.16, 0.1, 0.06))):
        y = rng.uniform(right, left) if rng.random() < 0.25 else _lateral_offset(rng, right, left)
        height = rng.uniform(1.4, 1.85)
        props.append(_upright(x + _distance(rng), y, height * 40 / 96, height, pyramid(sprites.person(rng))))
    if rng.random() < 0.14:
        y = rng.uniform(right + 0.4, left - 0.4)
        props.append(_upright(x + _distance(rng), y, 0.8, 1.65, pyramid(sprites.rider(rng))))
    if rng.random() < 0.05:
        props.append(
            _upright(x + _distance(rng), rng.uniform(right, left), 0.45, 0.7, pyramid(sprites.cone(rng)))
        )
    return props


def _random_stations(rng: np.random.Generator, spacing_m: float) -> list[float]:
    """Positions along the road, `spacing_m` apart on average."""
    steps = rng.uniform(0.4, 1.6, int(REACH_M / spacing_m) + 2) * spacing_m
    stations = np.cumsum(steps) - spacing_m * rng.random()
    return [float(x) for x in stations[stations < REACH_M]]


def _poles(rng: np.random.Generator, appearance: Appearance) -> list[Prop]:
    """A row of poles on one side, with lamps where the street is lit."""
    lamps = appearance.street_lamps > 0 or (appearance.surroundings != "country" and rng.random() < 0.4)
    if not lamps and rng.random() < 0.3:
        return []
    side, edge = ((-1, appearance.right_edge_m), (1, appearance.left_edge_m))[int(rng.integers(2))]
    picture, height, offset = pyramid(sprites.pole(rng, lamps)), rng.uniform(6, 9), rng.uniform(0.5, 3)
    glow = tuple(float(v) for v in 2.5 * appearance.street_lamps * _LAMP_GLOW)
    if rng.random() < 0.3:
        glow = (glow[0], glow[0], glow[0])
    spacing = rng.uniform(16, 45)
    starts = np.arange(rng.uniform(-5, spacing), REACH_M, spacing)
    return [
        _upright(
            float(x), edge + side * offset, height / 4, height, picture, 0.12, (glow[0], glow[1], glow[2])
        )
        for x in starts
    ]


def _tree(rng: np.random.Generator, x: float, y: float, picture: tuple[np.ndarray, ...]) -> Sprite:
    height = rng.uniform(3.5, 10)
    width = height * rng.uniform(0.6, 1.2)
    angle = np.linspace(0, 2 * np.pi, 14, endpoint=False)
    blobs = []
    for _ in range(4):
        middle = np.array([rng.normal(0, 0.2) * width, rng.uniform(0.5, 0.85) * height])
        radius = rng.uniform(0.14, 0.28) * width * (1 + 0.25 * rng.standard_normal(14))
        blobs.append(middle + np.column_stack((radius * np.cos(angle), radius * np.sin(angle))))
    return Sprite(x, y, width, height, picture, (*blobs, _bar(0.12, 0.7 * height)))


def _upright(
    x: float,
    y: float,
    width: float,
    height: float,
    picture: tuple[np.ndarray, ...],
    thickness: float | None = None,
    glow: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Sprite:
    return Sprite(x, y, width, height, picture, (_bar(thickness or 0.6 * width, height),), glow)


def _bar(width: float, height: float) -> np.ndarray:
    return np.array([[-width / 2, 0], [width / 2, 0], [width / 2, height], [-width / 2, height]])


def _distance(rng: np.random.Generator) -> float:
    return float(np.exp(rng.uniform(np.log(5), np.log(60))))


def _lateral_offset(rng: np.random.Generator, right: float, left: float) -> float:
    offset = rng.uniform(-0.3, 2.5)
    return float(right - offset if rng.random() < 0.5 else left + offset)
