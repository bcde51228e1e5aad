"""Cells of colour as a PNG inside the page: 15 shades, half a byte each, not compressed: the same bytes everywhere."""

from __future__ import annotations

from base64 import b64encode
from struct import pack
from zlib import adler32, crc32

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.pictures.page.frame import PlotAxis
from wavesym.pictures.page.svg import Svg, element

SHADES = 15  # of values with a sign 0 is white, in the middle
_BLOCK = 65535  # bytes, the most that deflate stores in one block
_NEGATIVE, _WHITE, _POSITIVE = (33, 92, 168), (247, 247, 247), (178, 34, 43)
_SIZES = ((255, 255, 217), (65, 182, 196), (8, 29, 88))  # from the least to the greatest
_FORMAL = (190, 190, 190)


def colours(*, signed: bool) -> list[tuple[int, int, int]]:
    """From the least to the greatest, and that of what is no number: diverging with a sign, sequential for sizes."""
    anchors = np.array((_NEGATIVE, _WHITE, _POSITIVE) if signed else _SIZES, dtype=float)
    places = np.linspace(0, 2, SHADES)
    parts = np.column_stack([np.interp(places, (0, 1, 2), anchors[:, k]) for k in range(3)])
    return [*((round(red), round(green), round(blue)) for red, green, blue in parts.tolist()), _FORMAL]


def encode_png(values: Array, least: float, greatest: float, *, signed: bool) -> bytes:
    """Values (rows, columns), the first row at the top, as a PNG; those beyond the limits have the last colours."""
    parts = np.clip((values - least) / (greatest - least), 0, 1)
    shades = np.rint(parts * (SHADES - 1))
    numbers = np.where(np.isnan(values), SHADES, np.nan_to_num(shades)).astype(np.uint8)
    if numbers.shape[1] % 2:
        numbers = np.pad(numbers, ((0, 0), (0, 1)))
    packed = numbers[:, ::2] << 4 | numbers[:, 1::2]
    content = b"".join(b"\0" + row.tobytes() for row in packed)
    header = pack(">IIBBBBB", values.shape[1], values.shape[0], 4, 3, 0, 0, 0)
    palette = bytes(part for colour in colours(signed=signed) for part in colour)
    chunks = ((b"IHDR", header), (b"PLTE", palette), (b"IDAT", _deflate(content)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def colour_image(values: Array, x: PlotAxis, y: PlotAxis, limits: tuple[float, float], *, signed: bool) -> Svg:
    """Values (rows, columns), the first row at the bottom, as an image between two axes inside a page."""
    image = encode_png(values[::-1], *limits, signed=signed)
    return element(
        "image",
        href="data:image/png;base64," + b64encode(image).decode(),
        x=x.start,
        y=y.end,
        width=x.end - x.start,
        height=y.start - y.end,
        preserveAspectRatio="none",
        class_="cells",
    )


def _deflate(content: bytes) -> bytes:
    """A stream of deflate that stores its content as it is."""
    starts = range(0, len(content), _BLOCK)
    blocks = []
    for start in starts:
        part = content[start : start + _BLOCK]
        blocks.append(pack("<BHH", start + _BLOCK >= len(content), len(part), len(part) ^ 0xFFFF) + part)
    return b"\x78\x01" + b"".join(blocks) + pack(">I", adler32(content))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return pack(">I", len(data)) + kind + data + pack(">I", crc32(kind + data))
