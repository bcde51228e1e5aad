"""What a scene needs to model: the nodes from which something can reach an output in time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.model.node import Parameters
from wavesym.scene import Observable


def rod_of(output: Observable) -> int:
    """The rod in which an output lies; at a node the one on its left, where no side is asked for."""
    after = -(-output.x.numerator // output.x.denominator)
    return max(1, after + 1 if output.side > 0 else after)


def light_cone(chain: Chain, outputs: Iterable[Observable], until: float | Fraction) -> range:
    """The numbers of the nodes that can influence an output by tau = `until`, and of all nodes between those.

    A wave crosses a rod in one unit of tau, so these are the nodes no more than `until` rod lengths from an output;
    one that is just as far counts, as a jump that it sends at tau = 0 is seen at `until`. The ends of an output's rod
    are always among them. What comes into the range from outside is what its rods held at tau = 0, or comes too late.

    Where all is at rest before a first load, the time from that load on may stand for `until`.
    """
    reach = Fraction(until)
    places = list(outputs)
    first = min(min(rod_of(output) - 1, _ceiling(output.x - reach)) for output in places)
    last = max(max(rod_of(output), _floor(output.x + reach)) for output in places)
    return range(max(0, first), min(chain.m, last) + 1)


def felt(chain: Chain, outputs: Iterable[Observable], until: Fraction) -> dict[str, dict[int, fmpq]]:
    """The parameters, by name and index, of the nodes whose law can matter to an output by tau = `until`.

    A body that is first met at `until` has not turned anything by then; a node without mass has.
    """
    places = list(outputs)
    taken: dict[str, dict[int, fmpq]] = {}
    recorded = _Recorded.parameters(chain.parameters, taken)
    for family in chain.system.families(chain.m, recorded):
        for x in range(family.first, family.last + 1, family.step):
            distance = min(abs(x - place.x) for place in places)
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
        lists = {name: getattr(given, name) for name in ("kappa", "inertia", "velocity")}
        return Parameters(
            **{name: numbers and cls(numbers, taken.setdefault(name, {})) for name, numbers in lists.items()}
        )


def _floor(value: Fraction) -> int:
    return value.numerator // value.denominator


def _ceiling(value: Fraction) -> int:
    return -_floor(-value)
