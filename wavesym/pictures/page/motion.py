"""A small animation: how a building sways, or how waves pass along a chain; the cursor of the page moves it.

A frame has a byte for each place, from 1 (the least) over 128 (0) to 255, in hexadecimal digits. Without script the
picture shows the instant of the largest value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.pictures.groups import axis_title
from wavesym.pictures.line_histories import LineHistories
from wavesym.pictures.page.plots import WIDTH, PagePicture, picture
from wavesym.pictures.page.svg import Svg, box, element, line, text
from wavesym.pictures.timescale import Timescale

_BYTES, _FRAMES, _HALF = 30_000, 600, 127
_STOREY, _TALLEST, _FLOOR, _SWAY = 36.0, 420.0, 150.0, 90.0  # pixels
_ROD, _LEFT = 44.0, 60.0


@dataclass(frozen=True)
class Motion:
    """The picture, and its frames: `values[place * count + frame]` in two digits each."""

    picture: PagePicture
    values: str
    count: int
    sways: bool


def motion(model: Model, found: Sequence[LineHistories], scale: Timescale) -> Motion | None:
    """The animation of the main line of a chain; None where it is not known what happens there, or nothing moves.

    Args:
        model: whose chain it is.
        found: what happens along it: its motion, then its strain.
        scale: how time is told.
    """
    if not found:
        return None
    sways = model.labels.system["type"] == "building"
    quantity = found[0] if sways else found[-1]
    band = quantity.bands[0]
    known = np.nan_to_num(band.values)
    largest = float(np.max(np.abs(known)))
    if not largest:
        return None
    count = min(_FRAMES, _BYTES // len(band.spots))
    instants = np.linspace(0, quantity.taus[-1], count)
    frames = np.array([np.interp(instants, quantity.taus, row) for row in known]) / largest
    bytes_ = np.rint(frames * _HALF).astype(int) + _HALF + 1
    still = int(np.argmax(np.max(np.abs(frames), axis=0)))
    title = "How the building sways" if sways else "How waves pass along the chain"
    name = axis_title(model, quantity.quantity, quantity.unit).replace("\n", " ")
    description = f"Drawn at {scale.format(float(instants[still]))}; the largest {name} is {largest:.4g}."
    content, height = (_building if sways else _chain)(frames[:, still], quantity)
    drawn = picture("motion", title, description, height, *content, class_="plot moving", is_upright=sways)
    return Motion(PagePicture(title, drawn), "".join(f"{each:02x}" for each in bytes_.ravel().tolist()), count, sways)


def _building(frame: Array, quantity: LineHistories) -> tuple[list[Svg], float]:
    """Floors as bars, each in a group that the script moves aside by `_SWAY` pixels for the largest value."""
    spots = quantity.bands[0].spots
    storey = min(_STOREY, _TALLEST / max(1, len(spots) - 1))
    base, middle = 30 + storey * (len(spots) - 1), WIDTH / 2
    thick = min(9.0, storey / 2.5)
    floors = (
        element(
            "g",
            box(middle - _FLOOR / 2, base - k * storey - thick / 2, _FLOOR, thick, "mass"),
            class_="part",
            transform=f"translate({value * _SWAY:.1f} 0)",
        )
        for k, value in enumerate(frame.tolist())
    )
    ground = line(middle - _FLOOR, base + thick, middle + _FLOOR, base + thick, "face")
    return [ground, *floors], base + 24


def _chain(frame: Array, quantity: LineHistories) -> tuple[list[Svg], float]:
    """The chain as a band, a piece for each place, which the script colours."""
    spots = quantity.bands[0].spots
    low, high = spots[0].low, spots[-1].high
    pixels = (WIDTH - 2 * _LEFT) / (high - low)
    pieces = [
        element(
            "rect",
            class_="part",
            x=_LEFT + (spot.low - low) * pixels,
            y=16.0,
            width=max(1.0, (spot.high - spot.low) * pixels),
            height=_ROD,
            fill=_shade(value),
        )
        for spot, value in zip(spots, frame.tolist(), strict=True)
    ]
    frame_ = element("rect", x=_LEFT, y=16.0, width=WIDTH - 2 * _LEFT, height=_ROD, fill="none", stroke="#59636e")
    words = f"{quantity.quantity}: blue below 0, red above"
    numbers = text(_LEFT, 78, f"{low:.6g}"), text(WIDTH - _LEFT, 78, f"{high:.6g}")
    return [*pieces, frame_, *numbers, text(WIDTH / 2, 78, f"{axis_text('', quantity.length)}; {words}")], 92.0


def _shade(value: float) -> str:
    """White for 0, the strongest red or blue for 1 and -1; as the script has it."""
    size = abs(value)
    pale = round(247 * (1 - size))
    if value > 0:
        return f"rgb({pale + round(178 * size)},{pale},{pale})"
    return f"rgb({pale},{pale},{pale + round(168 * size)})"
