"""Text in pictures, in the font of the figures."""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from matplotlib.font_manager import FontProperties, findfont
from PIL import Image, ImageDraw, ImageFont

from foreride.files.errors import printable

Colour = tuple[int, int, int]
ELLIPSIS = "…"


class Caption(NamedTuple):
    """Text at a place (px); `anchor` as in Pillow: `ls` is left on the baseline, `rs` right on it.

    room: the greatest width (px), to which the text is shortened; ground: colour behind it, if any.
    """

    text: str
    at: tuple[float, float]
    size: int
    colour: Colour
    anchor: str = "ls"
    room: float = float("inf")
    bold: bool = False
    ground: Colour | None = None


def written(image: np.ndarray, captions: Sequence[Caption]) -> np.ndarray:
    """Return the RGB image with the texts on it."""
    picture = Image.fromarray(image)
    pen = ImageDraw.Draw(picture)
    for caption in captions:
        font = _font(caption.size, caption.bold)
        text = fitted(printable(caption.text), caption.room, caption.size, caption.bold)
        if caption.ground is not None:
            left, top, right, bottom = pen.textbbox(caption.at, text, font, caption.anchor)
            pen.rectangle((left - 3, top - 2, right + 3, bottom + 2), caption.ground)
        pen.text(caption.at, text, caption.colour, font, caption.anchor)
    return np.asarray(picture)


def width_of(text: str, size: int, bold: bool = False) -> float:
    """Width of a text, px."""
    return _font(size, bold).getlength(text)


def fitted(text: str, room: float, size: int, bold: bool = False) -> str:
    """The text, shortened at its end until it fits."""
    if width_of(text, size, bold) <= room:
        return text
    while text and width_of(text + ELLIPSIS, size, bold) > room:
        text = text[:-1]
    return text.rstrip() + ELLIPSIS


@cache
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    properties = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")
    return ImageFont.truetype(findfont(properties), size)
