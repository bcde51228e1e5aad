"""What outputs are called in pictures and on pages: "Base shear", "Storey 1 drift", "Velocity of hub"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.pictures.histories import History
from wavesym.pictures.units import unit_text
from wavesym.results.presentation import readable_unit

_PLACE = re.compile(r"([\d./]+(?: .*?)?)([+-]?)")  # a number, perhaps with a unit, and a side
_SIDES = {"": "at", "-": "just before", "+": "just after"}


def with_titles(model: Model) -> Model:
    """A model whose outputs have names and units for people; names that a scene gives stay.

    Args:
        model: whose outputs are to be shown.
    """
    return model.watching(
        replace(probe, title=probe.title or output_title(model, probe), unit=unit_text(probe.unit))
        for probe in model.probes
    )


def in_readable_units(histories: Sequence[History]) -> tuple[History, ...]:
    """Histories in the units that people write for values so large, one for all of a quantity: kN in place of N.

    Args:
        histories: of outputs or loads, in the units of results.
    """
    largest: dict[tuple[str, str], float] = {}
    for each in histories:
        kind = each.output.quantity, each.output.unit
        largest[kind] = max(largest.get(kind, 0.0), float(np.max(np.abs(each.points[:, 1]))))
    return tuple(
        _in_unit(each, *readable_unit(largest[each.output.quantity, each.output.unit], each.output.unit))
        for each in histories
    )


def _in_unit(history: History, size: int, unit: str) -> History:
    if size == 1:
        return history
    output = replace(history.output, factor=history.output.factor / size, unit=unit)
    return replace(history, output=output, stretches=tuple(each / (1.0, size) for each in history.stretches))


def output_title(model: Model, probe: Probe) -> str:
    """The name of an output for people.

    Args:
        model: a building, whose floors are counted from its foundation, 0, or any chain.
        probe: its name is QUANTITY@PLACE.
    """
    quantity, _, place = probe.name.partition("@")
    words = QUANTITIES[quantity].in_words_of(model.labels.kind).heading
    side = {"+": "above", "-": "below"}.get(place[-1:], "at")
    if model.labels.system["type"] == "building" and quantity != "strain" and place.rstrip("+-").isdecimal():
        place = place.rstrip("+-")
        if quantity == "drift":
            return f"Storey {place} drift"
        if quantity == "force":
            return "Base shear" if place == "0" else f"Shear {side} floor {place}"
        floor = {"0": "Foundation", str(len(model.network.bars)): "Roof"}.get(place, f"Floor {place}")
        return f"{floor} {words}"
    if quantity == "drift":
        return f"{'Twist' if model.labels.kind == 'torsional' else 'Deformation'} of rod {place}"
    line, colon, x = place.rpartition(":")
    if found := _PLACE.fullmatch(x):
        where = found[1] if " " in found[1] else f"x = {found[1]}"
        return f"{words.capitalize()} {_SIDES[found[2]]} {where}{line and f' of {in_words(line)}'}"
    return f"{words.capitalize()} of {in_words(line)}{colon}{in_words(x)}"


def in_words(name: str) -> str:
    """A name of a scene, with spaces."""
    return name.replace("_", " ")


def heading(name: str) -> str:
    """The name of a scene as a title begins with it: "Steel frame" of steel_frame."""
    return in_words(name[:1].upper() + name[1:])
