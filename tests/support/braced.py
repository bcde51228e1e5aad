"""A fourth system, in one file: a building with a dashpot between its roof and the ground beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import ClassVar, Literal

from pydantic import Field

from wavesym.fields.loads import LoadKinds
from wavesym.fields.numbers import Positives
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, System
from wavesym.systems.building import BUILDING_GROUND, Acceleration, SampledAcceleration
from wavesym.systems.preset import Preset


def _braked(roof: Family, m: Quantity, p: Parameters, x: Quantity) -> Node:
    return replace(roof.node_at(x), damping=p.dashpot[m])


def _families(m: Quantity, p: Parameters) -> tuple[Family, ...]:
    *others, roof = BUILDING_GROUND.families(m, p)
    return (*others, replace(roof, node_at=partial(_braked, roof, m, p)))


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(m + 1), "dashpot": range(m, m + 1)}


BRACED = System("braced", _families, _indices, smallest=2)


class Braced(Preset):
    """m storeys on moving ground, with a dashpot at the roof."""

    variants: ClassVar[tuple[System, ...]] = (BRACED,)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m + 1", "dashpot": "1"}
    load_kinds: ClassVar[LoadKinds] = (Acceleration, SampledAcceleration)

    type: Literal["braced"] = Field(description='"braced"')
    kappa: Positives = Field(description="a list of m + 1 positive numbers")
    dashpot: Positives = Field(description="a list of 1 positive number")
