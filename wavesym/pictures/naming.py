"""What outputs are called in pictures and on pages: "Base shear", "Storey 1 drift", "Velocity of hub"."""

from __future__ import annotations

import re
from dataclasses import replace

from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.pictures.units import unit_text

_PLACE = re.compile(r"[\d./]+(?: .*)?[+-]?")  # a number, perhaps with a unit and a side


def with_titles(model: Model) -> Model:
    """A model whose outputs have names and units for people; names that a scene gives stay.

    Args:
        model: whose outputs are to be shown.
    """
    return model.watching(
        replace(probe, title=probe.title or output_title(model, probe), unit=unit_text(probe.unit))
        for probe in model.probes
    )


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
    if _PLACE.fullmatch(x):
        where = f"{line}{colon}{x}" if line or re.search("[ +-]", x) else f"x = {x}"
        return f"{words.capitalize()} at {where}"
    return f"{words.capitalize()} of {place}"
