"""Drawing of scene objects into a view: shadows, bodies, sprites, lamps, and the occlusion they cause."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np

from foreride.road.render.lighting import Light
from foreride.road.render.objects.props import Face, Prop, Solid, Sprite, ground_position
from foreride.road.render.raycast import CameraView

_NEAR_M = 0.4
_SPRITE_NEAR_M = 1.3
_SPRITE_MIN_PX, _SPRITE_MAX_PX = 3, 1200
_SHADOWS_WITHIN_M = 50.0
_MAX_SHADOW_RATIO = 6.0  # metres per metre of height
_CONTACT = ((1.3, 50), (1.12, 110), (0.98, 165))  # contact shadow: scale of outline, darkness (of 255)
_LAMP_HEIGHT_M = 4.0  # lamps above this height are street lamps


class Atmosphere(NamedTuple):
    """Illumination and atmosphere of a scene: light, shares of the lamps (see `colour.Conditions`), fog."""

    light: Light
    ambient: float
    headlight: float
    fog_m: float
    haze: np.ndarray
    wet: bool


def draw(
    image: np.ndarray, hits: np.ndarray, view: CameraView, props: Sequence[Prop], air: Atmosphere
) -> dict[int, float]:
    """Draw `props` into the linear `image` (H, W, 3), farthest first; clear the `hits` (H, W) behind them.

    Returns the occluded share of the pixels of each feature in `hits`.
    """
    ordered = sorted(props, key=lambda prop: -float(np.hypot(*(ground_position(prop) - view.position[:2]))))
    visible_hits = hits.copy()
    _shade_ground(image, view, ordered, air)
    halos: list[tuple[float, float, float, np.ndarray]] = []
    for prop in ordered:
        if isinstance(prop, Solid):
            for face in prop.faces:
                _draw_face(image, visible_hits, view, face, air, halos)
        else:
            _draw_sprite(image, visible_hits, view, prop, air, halos)
    for u, v, size, colour in halos:
        _add_halo(image, u, v, size, colour, air.wet)
    pixels_before, pixels_after = (
        np.bincount(ids.ravel(), minlength=int(hits.max()) + 1) for ids in (hits, visible_hits)
    )
    hits[:] = visible_hits
    return {int(k): 1 - pixels_after[k] / pixels_before[k] for k in np.flatnonzero(pixels_before)}


def lamp_pools(props: Sequence[Prop]) -> np.ndarray:
    """(n, 3) x, y and strength of the pools of light under street lamps."""
    lamps = [p for p in props if isinstance(p, Sprite) and p.height_m > _LAMP_HEIGHT_M and any(p.glow)]
    return np.array([(p.x, 0.75 * p.y, max(p.glow)) for p in lamps]).reshape(-1, 3)


def _to_camera(view: CameraView, points: np.ndarray) -> np.ndarray:
    """Camera coordinates forward, left, up (n, 3) of world points."""
    return (points - view.position) @ view.rotation


def _pixels(view: CameraView, points: np.ndarray) -> np.ndarray | None:
    """Pixel polygon (m, 2) of a world polygon, clipped at the near plane; None if nothing is left."""
    corners = _to_camera(view, points)
    inside = corners[:, 0] > _NEAR_M
    if not inside.any():
        return None
    if not inside.all():
        clipped = []
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if a[0] > _NEAR_M:
                clipped.append(a)
            if (a[0] > _NEAR_M) != (b[0] > _NEAR_M):
                clipped.append(a + (b - a) * (_NEAR_M - a[0]) / (b[0] - a[0]))
        corners = np.array(clipped)
    return np.stack(
        (
            view.cx - view.focal * corners[:, 1] / corners[:, 0],
            view.cy - view.focal * corners[:, 2] / corners[:, 0],
        ),
        1,
    )


def _fill(mask: np.ndarray, polygon: np.ndarray, value: int, origin: tuple[int, int] = (0, 0)) -> None:
    """Fill a pixel polygon with anti-aliased edges; `origin` is the column and row of the mask's corner."""
    corners = np.clip(polygon - origin - 0.5, -8000, 8000)
    cv2.fillPoly(mask, [np.rint(corners * 16).astype(np.int32)], value, cv2.LINE_AA, 4)


def _window(low: np.ndarray, high: np.ndarray, shape: tuple[int, ...]) -> tuple[slice, slice] | None:
    """Rows and columns of the image that a pixel rectangle overlaps."""
    c0, r0 = np.maximum(np.floor(low).astype(int) - 1, 0)
    c1, r1 = np.minimum(np.ceil(high).astype(int) + 2, (shape[1], shape[0]))
    return (slice(r0, r1), slice(c0, c1)) if r1 > r0 and c1 > c0 else None


def _shade_ground(image: np.ndarray, view: CameraView, props: Sequence[Prop], air: Atmosphere) -> None:
    """Cast shadows of the sun, and contact shadows under bodies."""
    sun, light = air.light.sun, air.light
    props = [p for p in props if abs(ground_position(p)[0] - view.position[0]) < _SHADOWS_WITHIN_M]
    mask = np.zeros(image.shape[:2], np.uint8)
    if sun.max() > 0.15:
        flat = light.direction[:2]
        shift = -flat * min(
            1 / max(light.direction[2], 1e-3), _MAX_SHADOW_RATIO / max(float(np.hypot(*flat)), 1e-3)
        )
        for prop in props:
            for outline in _shadow_outlines(prop, shift):
                polygon = _pixels(view, np.column_stack((outline, np.zeros(len(outline)))))
                if polygon is not None:
                    _fill(mask, polygon, 255)
        cv2.GaussianBlur(mask, (0, 0), 1.2, dst=mask)
        sky_share = light.sky / (light.sky + sun * max(light.direction[2], 0.1))
        _darken(image, mask, 1 - sky_share)
    mask[:] = 0
    for scale, amount in _CONTACT:
        for base in [prop.base for prop in props if isinstance(prop, Solid)]:
            outline = base.mean(axis=0) + (base - base.mean(axis=0)) * scale
            polygon = _pixels(view, np.column_stack((outline, np.zeros(len(outline)))))
            if polygon is not None:
                _fill(mask, polygon, amount)
    _darken(image, mask, np.ones(3))


def _darken(image: np.ndarray, mask: np.ndarray, amount: np.ndarray) -> None:
    rows = np.flatnonzero(mask.any(axis=1))
    if len(rows):
        part = slice(rows[0], rows[-1] + 1)
        share = mask[part].astype(np.float32) / 255
        image[part] *= 1 - share[..., None] * amount.astype(np.float32)


def _shadow_outlines(prop: Prop, shift: np.ndarray) -> list[np.ndarray]:
    """Shadow polygons (n, 2) on the ground; `shift` (2,) is the shadow's displacement per metre of height."""
    if isinstance(prop, Solid):
        end_faces = np.concatenate((prop.base, prop.base + 0.95 * prop.height_m * shift)).astype(np.float32)
        return [cv2.convexHull(end_faces)[:, 0]]
    across = np.array([-shift[1], shift[0]]) / max(float(np.hypot(*shift)), 1e-6)
    return [ground_position(prop) + part[:, :1] * across + part[:, 1:] * shift for part in prop.shadow]


def _radiance(
    albedo: np.ndarray, beam: float, openness: float, ahead: float, aside: float, air: Atmosphere
) -> np.ndarray:
    """Reflected radiance (..., 3) of a surface: sun, sky, and at night the headlights."""
    lit = air.light.sun * beam + air.light.sky * openness * air.ambient
    if air.headlight:
        spread = np.exp(-((aside / (1.3 + 0.22 * ahead)) ** 2))
        lit = lit + air.light.sky * air.headlight * spread * 1.3 / (1 + (ahead / 14) ** 2)
    return np.asarray(albedo * lit)


def _with_haze(light: np.ndarray, distance: float, air: Atmosphere) -> np.ndarray:
    return air.haze + (light - air.haze) * np.exp(-distance / air.fog_m)


def _draw_face(
    image: np.ndarray,
    hits: np.ndarray,
    view: CameraView,
    face: Face,
    air: Atmosphere,
    halos: list[tuple[float, float, float, np.ndarray]],
) -> None:
    middle = face.points.mean(axis=0)
    if face.normal @ (view.position - middle) <= 0:
        return
    polygon = _pixels(view, face.points)
    if polygon is None:
        return
    part = _window(polygon.min(axis=0), polygon.max(axis=0), image.shape)
    if part is None:
        return
    mask = np.zeros(image[part].shape[:2], np.uint8)
    _fill(mask, polygon, 255, (part[1].start, part[0].start))
    ahead, aside = float(middle[0] - view.position[0]), float(middle[1] - view.position[1])
    distance = float(np.hypot(ahead, aside))
    beam = max(float(face.normal @ air.light.direction), 0.0)
    light = _radiance(np.array(face.albedo), beam, 0.6 + 0.4 * face.normal[2], max(ahead, 0.1), aside, air)
    light = _with_haze(light + np.array(face.glow), distance, air).astype(np.float32)
    share = mask.astype(np.float32)[..., None] / 255
    image[part] += (light - image[part]) * share
    hits[part][mask > 127] = 0
    if any(face.glow):
        u, v = polygon.mean(axis=0)
        halos.append(
            (u, v, view.focal * 0.12 / distance, np.array(face.glow) * np.exp(-distance / air.fog_m))
        )


def _draw_sprite(
    image: np.ndarray,
    hits: np.ndarray,
    view: CameraView,
    sprite: Sprite,
    air: Atmosphere,
    halos: list[tuple[float, float, float, np.ndarray]],
) -> None:
    forward, left, up = _to_camera(view, np.array([[sprite.x, sprite.y, 0.0]]))[0]
    if forward < _SPRITE_NEAR_M:
        return
    scale = view.focal / forward
    u, v = view.cx - scale * left, view.cy - scale * up
    size = np.array([sprite.width_m, sprite.height_m]) * scale
    part = _window(np.array([u - size[0] / 2, v - size[1]]), np.array([u + size[0] / 2, v]), image.shape)
    if part is None or size.max() > _SPRITE_MAX_PX or size.max() < _SPRITE_MIN_PX:
        return
    level = 0
    while level + 1 < len(sprite.levels) and sprite.levels[level].shape[0] > 2 * size[1]:
        level += 1  # bilinear samples must not skip texels
    picture = sprite.levels[level]
    step = np.array(picture.shape[1::-1]) / size
    corner = np.array([u - size[0] / 2 - part[1].start, v - size[1] - part[0].start])
    matrix = np.column_stack((np.diag(step), step * (0.5 - corner) - 0.5))
    shape = image[part].shape[1::-1]
    warped = cv2.warpAffine(picture, matrix, shape, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
    ahead, aside = float(sprite.x - view.position[0]), float(sprite.y - view.position[1])
    transmission = np.float32(np.exp(-np.hypot(ahead, aside) / air.fog_m))
    light = _radiance(np.ones(3), 0.4, 0.75, max(ahead, 0.1), aside, air).astype(np.float32) * transmission
    cover = warped[..., 3:]
    veil = air.haze.astype(np.float32) * (1 - transmission)
    image[part] = image[part] * (1 - cover) + warped[..., :3] * light + cover * veil
    hits[part][cover[..., 0] > 0.5] = 0
    if any(sprite.glow):
        halos.append(
            (u, v - 0.98 * size[1], scale * 0.22, np.array(sprite.glow) * np.exp(-forward / air.fog_m))
        )


def _add_halo(image: np.ndarray, u: float, v: float, size: float, colour: np.ndarray, wet: bool) -> None:
    """Lamp with its glow by scattering in lens and air, and its streak on a wet road."""
    reach = float(np.clip(8 * size, 10, 60))
    part = _window(
        np.array([u - reach, v - reach]), np.array([u + reach, v + reach * (5 if wet else 1)]), image.shape
    )
    if part is None:
        return
    r = np.arange(part[0].start, part[0].stop)[:, None] + 0.5 - v
    c = np.arange(part[1].start, part[1].stop)[None] + 0.5 - u
    core = float(np.clip(size, 0.8, 8))
    square = (r * r + c * c) / core**2
    glow = np.exp(-square) + 0.12 / (1 + 0.5 * square) * np.clip(1 - np.sqrt(r * r + c * c) / reach, 0, 1)
    if wet:
        glow = glow + 0.1 * np.exp(-((c / (1.5 * core)) ** 2)) * np.clip(r / reach, 0, 1) * np.clip(
            5 - r / reach, 0, 1
        )
    image[part] += glow[..., None].astype(np.float32) * colour.astype(np.float32)
