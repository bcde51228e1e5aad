"""What a scene needs to model: the nodes from which something can reach an output in time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields

from flint import fmpq

from wavesym.mechanics.chain import Chain
from wavesym.mechanics.gauge import Gauge
from wavesym.mechanics.node import Parameters


def light_cone(chain: Chain, watched: Iterable[Gauge], until: fmpq) -> range:
    """The numbers of the nodes that can influence what is watched by tau = `until`, and of all nodes between those.

    A wave crosses a rod in one unit of tau, so these are the nodes no more than `until` rod lengths from a place;
    one that is just as far counts, as a jump that it sends at tau = 0 is seen at `until`. The ends of its rod
    are always among them. What comes into the range from outside is what its rods held at tau = 0, or comes too late.

    Where all is at rest before a first load, the time from that load on may stand for `until`.
    """
    places = list(watched)
    first = min(min(place.rod - 1, int((place.x - until).ceil())) for place in places)
    last = max(max(place.rod, int((place.x + until).floor())) for place in places)
    return range(max(0, first), min(chain.m, last) + 1)


def felt(chain: Chain, watched: Iterable[Gauge], until: fmpq) -> dict[str, dict[int, fmpq]]:
    """The parameters, by name and index, of the nodes whose law can matter to what is watched by tau = `until`.

    A body that is first met at `until` has not turned anything by then; a node without mass has.
    """
    places = [reading.x for reading in watched]
    taken: dict[str, dict[int, fmpq]] = {}
    recorded = _Recorded.parameters(chain.parameters, taken)
    for family in chain.system.families(chain.m, recorded):
        for x in range(family.first, family.last + 1, family.step):
            distance = min(abs(x - place) for place in places)
            if distance < until or (distance == until and not chain.nodes[x].inertia):
                family.at(x)
    return {name: dict(sorted(numbers.items())) for name, numbers in taken.items()}


class _Recorded(dict[int, fmpq]):
    """Numbers that note which of them were asked for."""

    def __init__(self, numbers: Mapping[int, fmpq], taken: dict[int, fmpq]) -> None:
        super().__init__(numbers)
        self._taken = taken

    def __getitem__(self, index: int) -> fmpq:
        value = super().__getitem__(index)
        self._taken[index] = value
        return value

    @classmethod
    def parameters(cls, given: Parameters, taken: dict[str, dict[int, fmpq]]) -> Parameters:
        """The given parameters; `taken` will hold, by name, those that were asked for."""
        lists = {field.name: getattr(given, field.name) for field in fields(given)}
        return Parameters(
            **{name: numbers and cls(numbers, taken.setdefault(name, {})) for name, numbers in lists.items()}
        )
