"""Colours and line styles of controllers, the same in the replay, the charts, the figures and the film."""

from collections.abc import Iterable

CONTROLLER_COLOURS = {
    "passive": "#70767d",
    "skyhook": "#d26a00",
    "mpc_reactive": "#1fa35c",
    "mpc_preview": "#1a6fc4",
    "clairvoyant": "#c2559b",
}
"""Fixed colours: distinct for every colour vision, with a contrast of 3 on the light and the dark page."""
OTHER_COLOURS = ("#8256d6", "#9a5a2a", "#2596b8", "#7d7400", "#c8434f", "#4a7f7f")
"""Colours of all other controllers, in the order in which a comparison names them."""
DASHES: tuple[tuple[int, ...], ...] = ((), (6, 3), (2, 2), (8, 3, 2, 3))
"""Dashes (points) by perception, in the order in which a controller drove with them; () is a full line."""


def colours_of(controllers: Iterable[str]) -> dict[str, str]:
    """Colour of each controller; those without a fixed one get the others in turn."""
    distinct = dict.fromkeys(controllers)
    others = [name for name in distinct if name not in CONTROLLER_COLOURS]
    turns = {name: OTHER_COLOURS[index % len(OTHER_COLOURS)] for index, name in enumerate(others)}
    return {name: CONTROLLER_COLOURS.get(name) or turns[name] for name in distinct}


def dashes_of(variants: Iterable[tuple[str, str]]) -> dict[tuple[str, str], tuple[int, ...]]:
    """Dashes of each (controller, perception): a full line for a controller's first perception."""
    counted: dict[str, int] = {}
    dashes = {}
    for controller, perception in dict.fromkeys(variants):
        dashes[controller, perception] = DASHES[counted.setdefault(controller, 0) % len(DASHES)]
        counted[controller] += 1
    return dashes
