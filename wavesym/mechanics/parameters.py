"""The numbers of a model by name: what may be changed of it, and the network that it is then.

The parts of a network have masses, dashpots, springs, impedances and velocities. A preset has letters of its own, as
the paper's kappa, and is a network for any values of these.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol

from flint import fmpq

from wavesym.mechanics.chain import Chain
from wavesym.mechanics.network import Network, network_of
from wavesym.mechanics.node import Parameters

_SETTABLE = ("kappa", "inertia", "velocity")
_ONE = fmpq(1)


class ModelParameter(NamedTuple):
    """A number of a model: its label, "kappa_1" or "mass_point_2", its value (dimensionless), what it is for people."""

    label: str
    value: fmpq
    about: str


class Factors(NamedTuple):
    """How many times as large as the network says loads, and forces that are read, are in units that stay."""

    load: Any = _ONE
    force: Any = _ONE


class Parametrization(Protocol):
    """The numbers of a model, and its network as a function of them."""

    @property
    def numbers(self) -> Mapping[str, tuple[ModelParameter, ...]]:
        """Those that can be given at run time, by the names of lists; none of these is empty."""

    @property
    def usual(self) -> tuple[str, ...]:
        """The names that a simulator may set unless others are requested."""

    @property
    def lightness(self) -> str:
        """The list whose numbers make bodies lighter where they grow; empty where there is none."""

    def network(self, values: Mapping[str, Any]) -> Network:
        """The network with other values.

        Args:
            values: numbers or functions by label, dimensionless; what is not among them stays.
        """

    def factors(self, values: Mapping[str, Any]) -> Factors:
        """What other values change of the units of a scene that has units."""

    def letters(self, matters: Callable[[int], bool]) -> dict[str, dict[int, fmpq]]:
        """The numbers that have letters and matter, by letter and index.

        Args:
            matters: whether the law of a point does.
        """

    def fixed_part(self, names: Sequence[str]) -> object:
        """What is left of it without some lists: equal where nothing else differs."""


@dataclass(frozen=True)
class SystemParameters:
    """The parameters of a system of the paper, by the paper's letters; the speeds of its rods where they are not 1."""

    chain: Chain
    speeds: tuple[fmpq, ...] = ()

    @cached_property
    def numbers(self) -> Mapping[str, tuple[ModelParameter, ...]]:
        given = {name: getattr(self.chain.parameters, name) or {} for name in _SETTABLE}
        return {
            name: tuple(ModelParameter(f"{name}_{i}", value, f"{name}_{i}") for i, value in sorted(numbers.items()))
            for name, numbers in given.items()
            if numbers
        }

    @property
    def usual(self) -> tuple[str, ...]:
        return tuple(self.numbers)

    @property
    def lightness(self) -> str:
        return "kappa"

    def network(self, values: Mapping[str, Any]) -> Network:
        network = network_of(replace(self.chain, parameters=self._parameters(values)))
        if not self.speeds:
            return network
        pairs = zip(network.bars, self.speeds, strict=True)
        return replace(network, bars=tuple(replace(bar, speed=speed) for bar, speed in pairs))

    def factors(self, values: Mapping[str, Any]) -> Factors:
        """A moment of 1 is that of the first shaft: it changes where discs or that shaft do."""
        own, new = self.chain.parameters, self._parameters(values)
        if own.inertia is None:
            return Factors()
        force = new.inertia[1] / own.inertia[1]
        return Factors(own.kappa[1] * own.inertia[1] / (new.kappa[1] * new.inertia[1]), force)

    def letters(self, matters: Callable[[int], bool]) -> dict[str, dict[int, fmpq]]:
        used: dict[str, dict[int, fmpq]] = {}
        own = self.chain.parameters
        lists = {field.name: getattr(own, field.name) for field in fields(own)}
        recorded = Parameters(**{k: of and _ReadLog(of, used.setdefault(k, {})) for k, of in lists.items()})
        for family in self.chain.system.families(self.chain.m, recorded):
            for x in filter(matters, range(family.first, family.last + 1, family.step)):
                family.node_at(x)
        return {name: dict(sorted(numbers.items())) for name, numbers in used.items()}

    def fixed_part(self, names: Sequence[str]) -> object:
        kept = replace(self.chain.parameters, **{name: None for name in names if name in self.numbers})
        return replace(self.chain, parameters=kept)

    def _parameters(self, values: Mapping[str, Any]) -> Parameters:
        own = self.chain.parameters
        lists = {field.name: getattr(own, field.name) for field in fields(own)}
        return Parameters(
            **{k: of and {i: values.get(f"{k}_{i}", value) for i, value in of.items()} for k, of in lists.items()}
        )


class _ReadLog(dict[int, fmpq]):
    """Numbers that note which of them were read."""

    def __init__(self, numbers: Mapping[int, fmpq], read: dict[int, fmpq]) -> None:
        super().__init__(numbers)
        self._read = read

    def __getitem__(self, index: int) -> fmpq:
        value = super().__getitem__(index)
        self._read[index] = value
        return value


Part = tuple[str, int]
"""A "point", "bar" or "link", and its number."""


@dataclass(frozen=True)
class PartParameters:
    """The numbers of the points, bars and links of a network: those that are not 0, and all velocities."""

    base: Network

    @cached_property
    def numbers(self) -> Mapping[str, tuple[ModelParameter, ...]]:
        return {
            name: tuple(
                ModelParameter(f"{name}_{kind}_{number}", value, f"{name} of {describe_part(self.base, kind, number)}")
                for (kind, number), value in parts
            )
            for name, of in _LISTS.items()
            if (parts := tuple(of(self.base)))
        }

    @property
    def usual(self) -> tuple[str, ...]:
        return ()

    @property
    def lightness(self) -> str:
        return ""

    def network(self, values: Mapping[str, Any]) -> Network:
        """What absorbs a rod's waves has the impedance that the rod has then."""
        base = self.base

        def with_values(part: Any, kind: str, number: int, **names: str) -> Any:
            labels = {key: f"{name}_{kind}_{number}" for key, name in names.items()}
            new = {key: values[label] for key, label in labels.items() if label in values}
            return replace(part, **new) if new else part

        bars = [
            with_values(bar, "bar", k, impedance="impedance", velocity="velocity") for k, bar in enumerate(base.bars)
        ]
        points = [
            with_values(point, "point", k, mass="mass", damping="dashpot", stiffness="spring", velocity="velocity")
            for k, point in enumerate(base.points)
        ]
        for k, point in enumerate(points):
            if point.absorbing:
                points[k] = replace(point, damping=bars[base.ends_at[k][0].bar].impedance)
        links = [
            with_values(link, "link", k, stiffness="spring", damping="dashpot") for k, link in enumerate(base.links)
        ]
        return Network(tuple(points), tuple(bars), tuple(links))

    def factors(self, values: Mapping[str, Any]) -> Factors:
        return Factors()

    def letters(self, matters: Callable[[int], bool]) -> dict[str, dict[int, fmpq]]:
        return {}

    def fixed_part(self, names: Sequence[str]) -> object:
        numbers = (one for name in names for one in self.numbers.get(name, ()))
        return self.network({one.label: fmpq(0) for one in numbers})


def _masses(network: Network) -> Iterator[tuple[Part, fmpq]]:
    return ((("point", k), point.mass) for k, point in enumerate(network.points) if point.mass != 0)


def _dashpots(network: Network) -> Iterator[tuple[Part, fmpq]]:
    for k, point in enumerate(network.points):
        if point.damping != 0 and not point.absorbing:
            yield ("point", k), point.damping
    yield from ((("link", k), link.damping) for k, link in enumerate(network.links) if link.damping != 0)


def _springs(network: Network) -> Iterator[tuple[Part, fmpq]]:
    yield from ((("point", k), point.stiffness) for k, point in enumerate(network.points) if point.stiffness != 0)
    yield from ((("link", k), link.stiffness) for k, link in enumerate(network.links) if link.stiffness != 0)


def _impedances(network: Network) -> Iterator[tuple[Part, fmpq]]:
    return ((("bar", k), bar.impedance) for k, bar in enumerate(network.bars))


def _velocities(network: Network) -> Iterator[tuple[Part, fmpq]]:
    """Of masses and rods, each its own."""
    yield from ((("point", k), point.velocity) for k, point in enumerate(network.points) if point.mass != 0)
    yield from ((("bar", k), bar.velocity) for k, bar in enumerate(network.bars))


_LISTS: Mapping[str, Callable[[Network], Iterator[tuple[Part, fmpq]]]] = {
    "mass": _masses,
    "dashpot": _dashpots,
    "spring": _springs,
    "impedance": _impedances,
    "velocity": _velocities,
}


def describe_part(network: Network, kind: str, number: int) -> str:
    """What a number belongs to."""
    if kind == "point":
        return _describe_point(network, number)
    if kind == "bar":
        bar = network.bars[number]
        return f"rod {number + 1}{bar.name and ', '}{bar.name}"
    link = network.links[number]
    return f"what links {_describe_point(network, link.left)} and {_describe_point(network, link.right)}"


def _describe_point(network: Network, number: int) -> str:
    point = network.points[number]
    return f"{point.name or 'the node'} at {point.place}"
