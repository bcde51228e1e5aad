"""What parameters that come at run time make of a chain: functions, and how exactly they are computed.

What is multiplied and added up on the way to a law has to be a number with all its digits. A product beyond the
largest number makes a quotient 0, one below the smallest normal number loses digits, and nothing tells afterwards: what
would be wrong is the chain itself. So such parameters are refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from flint import fmpq, fmpq_mat, fmpq_mpoly

from wavesym.numbers.ratio import Ratio
from wavesym.programs.march.plan import MarchedJoint
from wavesym.programs.runtime.network import RuntimeField
from wavesym.programs.tables import firsts

Function = Ratio | fmpq
"""Of the parameters."""

Product = tuple[fmpq_mpoly, ...]
"""Its factors, which are sums of products of symbols."""

MATRICES = {"rates": "rates", "pushed": "input_rates", "shown": "state_velocities", "passed": "feedthrough"}
"""The laws of a joint that are matrices: the name in tables, and the field of a `JointSpace`."""

OPEN = 1e30
"""So many roundings where nothing is known: terms that may cancel."""


@dataclass(frozen=True)
class RuntimeLaws:
    """`fields` are the parameters; `functions` of them, by the name of an array, are what a march takes: of nodes
    alpha, beta, rate (0 without inertia) and motion, rods, strengths of loads, gains of waves in outputs.

    `amplitudes` are those of the loads where these are no parameters.
    """

    fields: tuple[RuntimeField, ...]
    functions: Mapping[str, tuple[Function, ...]]
    amplitudes: tuple[float, ...]

    @property
    def places(self) -> Mapping[str, tuple[str, int]]:
        """The field, and the place in it, of every symbol."""
        return {label: (field.name, k) for field in self.fields for k, label in enumerate(field.labels)}

    @cached_property
    def slopes(self) -> tuple[tuple[int, str, int, Ratio], ...]:
        """Derivatives that are not 0: the number of the parameter, the name and the place of the function, and it."""
        return tuple(
            (lane, name, k, slope)
            for lane, label in enumerate(self.places)
            for name, functions in self.functions.items()
            for k, function in enumerate(functions)
            if isinstance(function, Ratio) and label in function.ring.names
            for slope in [function.derivative(label)]
            if slope != 0
        )

    @property
    def every(self) -> tuple[Ratio, ...]:
        """All functions but constants."""
        return tuple(one for functions in self.functions.values() for one in functions if isinstance(one, Ratio))

    @property
    def positive(self) -> frozenset[str]:
        """The symbols of numbers that have to be."""
        return frozenset(label for field in self.fields if field.positive for label in field.labels)


def matrix_laws(joints: Sequence[MarchedJoint]) -> dict[str, tuple[Function, ...]]:
    """The matrices of all joints, each by rows, one joint after the other."""
    return {
        name: tuple(chain.from_iterable(_entries(joint, field) for joint in joints)) for name, field in MATRICES.items()
    }


def matrix_places(joints: Sequence[MarchedJoint]) -> dict[str, tuple[int, ...]]:
    """Tables of where those of each joint begin, and where the last one ends."""
    return {f"at_{name}": firsts(len(_entries(joint, field)) for joint in joints) for name, field in MATRICES.items()}


def _entries(joint: MarchedJoint, field: str) -> list[Function]:
    matrix = getattr(joint.space, field)
    # where no parameter changes a joint its matrices are numbers
    return list(matrix.entries() if isinstance(matrix, fmpq_mat) else chain.from_iterable(matrix))


def products(function: Ratio, positive: Set[str]) -> Iterator[Product]:
    """Those of a law, in the order in which it is computed. `positive` are the symbols that have to be; what others are
    in may be 0.
    """
    names = function.ring.names
    forms = [(function.ring.forms[form], power) for form, power in sorted(function.denominator.items())]
    below = tuple(form for form, power in forms for _ in range(power))
    for polynomial in (function.numerator, *(form for form, _ in forms)):
        if {names[place] for place, power in enumerate(polynomial.degrees()) if power} <= positive:
            yield from _parts(polynomial)
    for count in range(2, len(below) + 1):
        yield below[:count]


def _parts(polynomial: fmpq_mpoly) -> Iterator[Product]:
    """Each term factor by factor; and the sum, where nothing cancels."""
    terms = {tuple(map(int, powers)): fmpq(value) for powers, value in polynomial.to_dict().items()}
    for powers, value in terms.items():
        letters = [place for place, power in enumerate(powers) for _ in range(power)]
        for count in range(1 if abs(value) != 1 else 2, len(letters) + 1):
            factors = tuple(letters[:count].count(place) for place in range(len(powers)))
            yield (polynomial.context().from_dict({factors: value}),)
    if len(terms) > 1 and len({value > 0 for value in terms.values()}) == 1:
        yield (polynomial,)


def most_roundings(laws: Mapping[str, Iterable[Function]], positive: Iterable[str]) -> float:
    """How often a law is rounded in floating-point numbers, at most. `positive` are the symbols that are positive; sums
    of what they are in have terms of one sign.

    Each number in a law is rounded, each operation, and each parameter that is the scene's decimal.
    """
    given = frozenset(positive)
    return max((_roundings(function, given) for functions in laws.values() for function in functions), default=1.0)


def _roundings(function: Function, positive: frozenset[str]) -> float:
    if not isinstance(function, Ratio):
        return 1.0
    names = function.ring.names
    below = [(function.ring.forms[form], power) for form, power in function.denominator.items()]
    sums = [(function.numerator, 1), *below]
    return sum(power * (1 + _of_sum(polynomial, names, positive)) for polynomial, power in sums)


def _of_sum(polynomial: fmpq_mpoly, names: tuple[str, ...], positive: frozenset[str]) -> float:
    terms = {powers: fmpq(value) for powers, value in polynomial.to_dict().items()}
    if len(terms) > 1:
        signed = {value > 0 for value in terms.values()}
        of = {name for powers in terms for name, power in zip(names, powers, strict=True) if power}
        if len(signed) > 1 or not of <= positive:
            return OPEN
    return len(terms) + max((2.0 + sum(map(int, powers)) for powers in terms), default=0.0)
