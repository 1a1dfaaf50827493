"""Base colours of the carriageway, the verges, and water on the road."""

import cv2
import numpy as np

from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import Block

KERB_WIDTH_M = 0.16
KERB_HEIGHT_M = 0.10
_TINTS = {"asphalt": (0.98, 1.0, 1.03), "old_asphalt": (1.03, 1.0, 0.95), "concrete": (1.03, 1.0, 0.94)}
_VERGES = {
    "grass": (0.09, 0.12, 0.035),
    "soil": (0.24, 0.17, 0.10),
    "pavement": (0.30, 0.29, 0.27),
    "red_soil": (0.27, 0.12, 0.06),
    "dry_grass": (0.20, 0.17, 0.07),
    "gravel": (0.22, 0.20, 0.18),
}
_CONTRAST = {"grass": 0.9, "soil": 0.45, "pavement": 0.15, "red_soil": 0.4, "dry_grass": 0.8, "gravel": 0.5}
_WETNESS = {"dry": 0.0, "wet": 0.5, "rain": 0.75, "fog": 0.15, "snow": 0.4}
_EDGE_RAGGEDNESS_M = {
    "grass": 0.1,
    "soil": 0.1,
    "pavement": 0.0,
    "red_soil": 0.35,
    "dry_grass": 0.2,
    "gravel": 0.3,
}


def paint(block: Block, appearance: Appearance, edges: tuple[float, float]) -> None:
    """Fill the block's albedo; raise a kerb where the verge is a pavement (outside the carriageway)."""
    tone = 1 + block.noise["tone"] * (1 + appearance.wear) + _tracks(block.y, appearance)
    base = np.float32(appearance.brightness) * np.array(_TINTS[appearance.surface], np.float32)
    block.albedo[:] = cv2.merge([tone * v for v in base])
    if appearance.surface == "concrete":
        joint = (np.abs(np.mod(block.x, 5.0) - 2.5) < 0.02) | (np.abs(block.y - sum(edges) / 2) < 0.02)
        block.albedo[np.broadcast_to(joint, tone.shape)] *= 0.55
    for side, edge in ((-1, edges[0]), (1, edges[1])):
        _verge(block, appearance, side, edge)


def apply_wetness(block: Block, appearance: Appearance, edges: tuple[float, float]) -> None:
    """Apply the weather's water film to the carriageway and darken wet cells."""
    water = _WETNESS[appearance.weather]
    if water:
        inside = (block.y > edges[0]) & (block.y < edges[1])
        film = np.clip(water + 0.35 * block.noise["dirt"], 0, 1) * np.where(inside, 1.0, 0.25)
        block.wet[:] = np.maximum(block.wet, film.astype(np.float32))
    if block.wet.any():
        gain = 1 - 0.45 * block.wet
        block.albedo *= cv2.merge([gain] * 3)


def _tracks(y: np.ndarray, appearance: Appearance) -> np.ndarray:
    """Albedo change along the wheel tracks of the ego lane: polish (light) or oil (dark)."""
    tracks = np.exp(-(((np.abs(y) - 0.8) / 0.3) ** 2)) - 0.7 * np.exp(-((y / 0.35) ** 2))
    return (0.10 * (appearance.wear - 0.35) * tracks).astype(np.float32)


def _verge(block: Block, appearance: Appearance, side: int, edge: float) -> None:
    outward_distance = side * (block.y - edge)
    columns = np.flatnonzero(outward_distance[0] > -0.3)
    if not len(columns):
        return
    part = (slice(None), slice(columns[0], columns[-1] + 1))
    distance = np.broadcast_to(outward_distance[part].astype(np.float32), block.height[part].shape)
    raggedness_m = _EDGE_RAGGEDNESS_M[appearance.verge]
    wear = block.noise["wear"][part]
    outside = distance + raggedness_m * wear > 0
    rough = np.clip(1 + _CONTRAST[appearance.verge] * (wear + 0.5 * block.noise["dirt"][part]), 0.25, 2.2)
    colour = cv2.merge([rough * np.float32(v) for v in _VERGES[appearance.verge]])
    if appearance.verge == "pavement":
        slab = (np.mod(block.x, 0.5) < 0.02) | (np.mod(block.y[part], 0.5) < 0.02)
        colour[np.broadcast_to(slab, outside.shape)] *= 0.7
        kerb = outside & (distance < KERB_WIDTH_M)
        band = np.mod(block.x, 2.0) < 1.0 if appearance.wear < 0.3 else np.ones_like(block.x, bool)
        colour[kerb & band] = (0.42, 0.42, 0.40)
        colour[kerb & ~band] = (0.06, 0.06, 0.06)
        block.height[part][outside] += KERB_HEIGHT_M
    np.copyto(block.albedo[part], colour, where=outside[..., None])
