"""The chains that the paper is tried on: their exact tables, their motion under loads, and scenes that show it.

The exact tables are the derived laws run, with parameters in which nothing coincides by chance; a chain under loads is
their response, at rational instants, in numbers that are equal only if they are the same (exact_numbers.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

from flint import arb, arb_poly, ctx, fmpq

from wavesym.derivation.increments import Increment, combine, differentiate, integrate, start
from wavesym.derivation.table import Function, Rules, unit_response
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, System
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.exact_numbers import Exponentials
from wavesym.papers.record import Reproduction
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

INTERVALS = {"I": 9, "II": 14, "III": 9}
"""How many intervals of every function are tabulated, per example."""

_SAMPLED_BITS = 160
"""Enough for doubles: the terms of nearly equal rates cancel by less than 2^100 of a value."""

Response = dict[Function, list[Increment]]


@dataclass(frozen=True)
class Exact:
    """A chain and the increments of all its functions for a unit of every source."""

    chain: Chain
    interval: int
    responses: dict[str, Response]

    @property
    def m(self) -> int:
        return self.chain.m

    def increment(self, source: str, letter: str, rod: int, interval: int) -> Increment:
        """What a function gains in interval 1, 2, ...; nothing before. KeyError, IndexError beyond the table."""
        return self.responses[source][Function(letter, rod)][interval - 1] if interval > 0 else {}

    def sample(self, source: str, letter: str, rod: int, instants: Sequence[float], order: int = 1) -> list[float]:
        """A function at many z (order 1), or its integral from 0 on (order 0), to the last bit but a few."""
        step, found = self.interval, []
        with ctx.workprec(_SAMPLED_BITS):
            later, pieces = arb_poly([step, 1]), [dict[fmpq, arb_poly]()]
            for gain in self.responses[source][Function(letter, rod)]:
                piece = {rate: powers(later) * (-rate * arb(step)).exp() for rate, powers in pieces[-1].items()}
                for rate, powers in (integrate(gain) if order == 0 else gain).items():
                    piece[rate] = piece.get(rate, arb_poly()) + arb_poly(powers)
                pieces.append(piece)
            for z in instants:
                number = max(int(z // step) + 1, 0)
                w = arb(z) - step * (number - 1)
                values = [powers(w) * (-rate * w).exp() for rate, powers in pieces[number].items()]
                found.append(float(sum(values, arb(0)).mid()))
        return found

    def degree(self, letter: str, rod: int, interval: int, rate: fmpq, source: str | None = None) -> int:
        """The highest power at a rate, over all sources or for one; -1 where the rate does not occur."""
        sources = self.responses if source is None else (source,)
        return max(len(self.increment(s, letter, rod, interval).get(rate, ())) for s in sources) - 1

    @cached_property
    def rates(self) -> dict[int, fmpq]:
        """The rates of the bodies, by the number that kappa or gamma has for them."""
        first = 1 if self.interval == 1 else 0
        return {x + first: fmpq(node.rate) for x, node in enumerate(self.chain.nodes) if node.inertia}


@cache
def collision(m: int) -> Exact:
    """Example I with unequal bodies."""
    bodies = range(1, m, 2)
    kappa = {i: fmpq(i + 2, 2 * i + 5) for i in bodies}
    return _exact("I", Chain(COLLISION, m, Parameters(kappa=kappa, velocity={i: fmpq(5, i + 1) - i for i in bodies})))


@cache
def unequal_collision(m: int) -> Exact:
    """Example I with unequal rods too."""
    parameters = collision(m).chain.parameters
    areas = {i: fmpq(i + 3, 2 * i + 1) for i in range(1, m + 1)}
    return _exact("I", Chain(UNEQUAL_COLLISION, m, replace(parameters, inertia=areas)))


@cache
def meeting(velocities: tuple[int, ...]) -> Exact:
    """Example I with equal bodies that have these velocities, falling or not."""
    bodies = range(1, 2 * len(velocities), 2)
    given = Parameters(
        kappa=dict.fromkeys(bodies, fmpq(1, 2)), velocity=dict(zip(bodies, map(fmpq, velocities), strict=True))
    )
    return _exact("I", Chain(COLLISION, 2 * len(velocities), given))


@cache
def drive(m: int) -> Exact:
    """Example II with unequal shafts and discs, all rates different."""
    kappa = {i: fmpq(2 * i + 1, i + 3) for i in range(1, m + 1)}
    return _exact(
        "II", Chain(DRIVE, m, Parameters(kappa=kappa, inertia={i: fmpq(i + 4, 2 * i + 3) for i in range(1, m + 2)}))
    )


@cache
def building(m: int) -> Exact:
    """Example III with equal floors: kappa_1 = ... = kappa_(m-1), as the paper's coefficients have it."""
    return _building(m, {i: fmpq(3, 5) for i in range(1, m)})


@cache
def uneven_building(m: int) -> Exact:
    """Example III with a different mass on every floor."""
    return _building(m, {i: fmpq(2 * i + 1, i + 4) for i in range(1, m)})


@cache
def grounded_building(m: int) -> Exact:
    """The same, on a foundation that moves with the ground."""
    return _building(m, {i: fmpq(2 * i + 1, i + 4) for i in range(1, m)}, BUILDING_GROUND)


def _of_unequal_rods(m: Quantity, p: Parameters) -> tuple[Family, ...]:
    """The nodes of a collision between rods that are A_i as stiff, and as heavy, as that of kappa."""

    def unequal(family: Family) -> Family:
        def node_at(x: Quantity) -> Node:
            node = family.node_at(x)
            left = p.inertia[x] if node.left else 0
            right = p.inertia[x + 1] if node.right else 0
            return replace(node, alpha=node.alpha * left, beta=node.beta * right)

        return replace(family, node_at=node_at)

    return tuple(map(unequal, COLLISION.families(m, p)))


UNEQUAL_COLLISION = replace(COLLISION, name="collision of unequal rods", families=_of_unequal_rods)
"""Its `inertia` are the A_i of (2.4)."""


def _building(m: int, floors: dict[int, fmpq], system: System = BUILDING_FORCE) -> Exact:
    return _exact("III", Chain(system, m, Parameters(kappa={0: fmpq(2, 7), **floors, m: fmpq(4, 11)})))


def _exact(example: str, chain: Chain) -> Exact:
    return exact_tables(chain, INTERVALS[example] * Rules(chain).interval)


def exact_tables(chain: Chain, most_z: int) -> Exact:
    """The increments of all functions of a chain that begin before `most_z`."""
    rules = Rules(chain)
    count = -(-most_z // rules.interval)
    wanted = {Function(letter, rod): count for letter in "fg" for rod in range(1, chain.m + 1)}
    return Exact(chain, rules.interval, {source: unit_response(rules, source, wanted) for source in chain.sources})


def with_parameters(exact: Exact, parameters: Parameters) -> Exact:
    """The same chain with other parameters."""
    system = exact.chain.system
    example = "I" if system is COLLISION else "II" if system is DRIVE else "III"
    return _exact(example, Chain(system, exact.m, parameters))


@dataclass(frozen=True)
class PaperExample:
    """An example: its name, its derivation, its tables, and the m that they are tried with."""

    name: str
    system: System
    tables: Callable[[int], Exact]
    sizes: range


EXAMPLES: Mapping[str, PaperExample] = {
    "I": PaperExample("I", COLLISION, collision, range(4, 9, 2)),
    "II": PaperExample("II", DRIVE, drive, range(1, 5)),
    "III": PaperExample("III", BUILDING_FORCE, uneven_building, range(2, 6)),
}


@dataclass(frozen=True)
class LoadStep:
    """A piece of a load: when it begins, and how much of its unit it is."""

    time: fmpq
    weight: fmpq


Loads = Mapping[str, Sequence[LoadStep]]
"""The pieces of every source of a chain, number k of each from 0 on."""


@dataclass(frozen=True, eq=False)
class LoadedChain:
    """A chain under loads: the motion that the derived laws give it."""

    exact: Exact
    loads: Loads

    def wave(self, letter: str, rod: int, z: fmpq, order: int = 1) -> Exponentials:
        """f or g of a rod at z, just after any jump there: itself (order 0), its derivative (1), the next (2).

        MeaninglessError where there is no such rod or derivative, or z is beyond the tables.
        """
        z = fmpq(z)
        key = letter, rod, int(z.p), int(z.q), order  # which are hashed faster than z
        if key not in self.memory:
            self.memory[key] = self._compute_wave(letter, rod, z, order)
        found: Exponentials = self.memory[key]
        return found

    @cached_property
    def memory(self) -> dict[Any, Any]:
        """What was computed, by what it is."""
        return {}

    def _compute_wave(self, letter: str, rod: int, z: fmpq, order: int) -> Exponentials:
        self._check(rod)
        if order > 2:
            raise MeaninglessError(f"there is no derivative of order {order} here")
        terms: list[tuple[fmpq, fmpq]] = []
        step, function = self.exact.interval, Function(letter, rod)
        for source, pieces in self.loads.items():
            for piece in pieces:
                since = z - piece.time
                if since >= step * len(self.exact.responses[source][function]):
                    raise MeaninglessError(f"z = {z} is beyond the tables")
                for number in range(int(since / step) + 1 if since >= 0 else 0):
                    gain = self._derivative_of_order(source, function, number, order)
                    terms += _terms(gain, since - step * number, piece.weight)
        return Exponentials.total(terms)

    def _check(self, rod: int) -> None:
        if not 1 <= rod <= self.exact.m:
            raise MeaninglessError(f"there is no rod {rod}")

    def _derivative_of_order(self, source: str, function: Function, number: int, order: int) -> Increment:
        """An increment, or its integral or derivative."""
        key = source, *function, number, order
        if key not in self.memory:
            increment = self.exact.responses[source][function][number]
            self.memory[key] = {0: integrate, 1: lambda same: same, 2: differentiate}[order](increment)
        found: Increment = self.memory[key]
        return found

    def waves_at(self, rod: int, x: int, tau: fmpq, order: int = 1) -> tuple[Exponentials, Exponentials]:
        """f and g of a rod at x, where (4.2) has them: g - f is the strain, f + g and v the velocity.

        MeaninglessError where there is no such rod.
        """
        self._check(rod)
        clock = self.exact.chain.rod(rod)
        late = clock.tau0 + x - clock.x0, clock.tau0 - x + clock.x0
        return self.wave("f", rod, tau - late[0], order), self.wave("g", rod, tau - late[1], order)

    def gain(self, letter: str, rod: int, interval: int, source: str, piece: int | None = None) -> Increment:
        """What a unit of a source, or a piece of a load, gives to f or g in interval 1, 2, ...; "ab" is a with b.

        MeaninglessError where there is no such source, piece or rod, or the interval is beyond the tables.
        """
        key = letter, rod, interval, source, piece, "gain"
        if key not in self.memory:
            sources = ["a", "b"] if source == "ab" else [source]
            if not 1 <= rod <= self.exact.m or not {*sources} <= self.exact.responses.keys():
                raise MeaninglessError(f"there is no rod {rod}, or no {source}")
            weights = [fmpq(1) if piece is None else self.piece(name, piece).weight for name in sources]
            try:
                parts = [self.exact.increment(name, letter, rod, interval) for name in sources]
            except IndexError:
                raise MeaninglessError(f"interval {interval} is beyond the tables") from None
            self.memory[key] = combine(zip(weights, parts, strict=True))
        found: Increment = self.memory[key]
        return found

    def piece(self, source: str, number: int) -> LoadStep:
        """A piece of a load; MeaninglessError where there is none."""
        pieces = self.loads.get(source, ())
        if not 0 <= number < len(pieces):
            raise MeaninglessError(f"{source} has no piece {number}")
        return pieces[number]

    def start_time(self, *index: int) -> fmpq:
        """tau_(s,k) of a piece of moment s, tau_k of a piece of the load of a building."""
        *moment, number = index
        return self.piece(f"M{moment[0]}" if moment else "a", number).time

    def load(self, source: str, z: fmpq, power: int = 0) -> fmpq:
        """The sum of the source's pieces that have begun, each times the time since then to a power."""
        return sum((p.weight * (z - p.time) ** power for p in self.loads.get(source, ()) if z >= p.time), fmpq(0))


class JumpingChain(LoadedChain):
    """The jumps of a motion chain: what second derivatives have of f' and g' where these jump; all else has none."""

    def wave(self, letter: str, rod: int, z: fmpq, order: int = 1) -> Exponentials:
        """The jump of f' or g' of a rod at z, for order 2. MeaninglessError as for the motion."""
        self._check(rod)
        total = fmpq(0)
        if order != 2:
            return Exponentials.from_number(total)
        for source, pieces in self.loads.items():
            increments = self.exact.responses[source][Function(letter, rod)]
            for piece in pieces:
                number = (fmpq(z) - piece.time) / self.exact.interval
                if number >= 0 and number.denom() == 1:
                    total += piece.weight * start(increments[int(number.numer())])
        return Exponentials.from_number(total)

    @property
    def fronts(self) -> tuple[fmpq, ...]:
        """When something may jump, within the first intervals."""
        times = {piece.time for pieces in self.loads.values() for piece in pieces}
        return tuple(sorted({time + self.exact.interval * n for time in times for n in range(JUMPS)}))


JUMPS = 4
"""Intervals after a load in which jumps are looked at."""


def _terms(increment: Increment, w: fmpq, weight: fmpq | int = 1) -> Iterator[tuple[fmpq, fmpq]]:
    """What an increment is w after its start, as exponents and what stands before their powers of e."""
    for rate, powers in increment.items():
        value = fmpq(0)
        for power in reversed(powers):
            value = value * w + power
        yield -rate * w, weight * value


@cache
def loaded_chain(example: str, m: int) -> LoadedChain:
    """An example under loads in which nothing coincides: every source has pieces of its own, at times of its own."""
    exact = EXAMPLES[example].tables(m)
    return LoadedChain(exact, loads(exact))


def loads(exact: Exact) -> Loads:
    """Pieces for every source of a chain: moment s has 1 + (s + 1) mod 4; an impact is one, at 0."""
    if exact.chain.sources == ("impact",):
        return {source: (LoadStep(fmpq(0), fmpq(1)),) for source in exact.responses}
    if exact.chain.system is DRIVE:
        return {
            f"M{s}": tuple(
                LoadStep(fmpq(k * (s + 2), 3), fmpq(2 * s + 1, k + 2) * (-1) ** k) for k in range(1 + (s + 1) % 4)
            )
            for s in range(1, exact.m + 2)
        }
    times = (fmpq(0), fmpq(3, 4), fmpq(7, 3))
    a, b = (fmpq(1), fmpq(-2, 3), fmpq(5, 7)), (fmpq(1, 3), fmpq(-3, 5), fmpq(2, 9))
    return {
        "a": tuple(map(LoadStep, times, a)),
        "b": tuple(map(LoadStep, times, b)),
    }


def instants(
    until: fmpq | int, start: fmpq | int = 0, between: Sequence[fmpq] = (fmpq(2, 7), fmpq(5, 6))
) -> tuple[fmpq, ...]:
    """Rational instants at which formulas are compared: starts of intervals, and some `between`."""
    found = []
    z = fmpq(start)
    while z < until:
        found += [z, *(z + part for part in between)]
        z += 1
    return tuple(t for t in found if t < until)


def example(
    exact: Exact, loads: Loads, until: fmpq | int, outputs: Mapping[str, Sequence[str]], command: str, look: str
) -> Callable[[], Reproduction]:
    """A case's example: the chain under its loads as a scene, the command that shows it, and what to look at.

    `outputs` are as in a scene, {"strain": ["1-"]}; `command` has SCENE for the file.
    """
    return lambda: Reproduction(scene_text(exact.chain, loads, until, outputs), command, look)


def scene_text(chain: Chain, loads: Loads, until: fmpq | int, outputs: Mapping[str, Sequence[str]]) -> str:
    """A chain under loads as a scene file."""
    kind, given = _SYSTEMS.get(chain.system, ("building", ("kappa",)))
    lines = ['name = "counterexample"', "", "[system]", f'type = "{kind}"', f"m = {chain.m}"]
    values = {name: sorted(getattr(chain.parameters, name).items()) for name in given}
    lines += [_toml_list(name, [value for _, value in numbered]) for name, numbered in values.items()]
    if kind == "building":
        base = "ground" if chain.system is BUILDING_GROUND else "force"
        lines.append(f'base = "{base}"')
    for source, pieces in loads.items() if kind != "collision" else ():
        times, weights = [piece.time for piece in pieces], [piece.weight for piece in pieces]
        lines += ["", "[[load]]"]
        if kind == "drive":
            lines += [f"body = {source.removeprefix('M')}", _toml_list("times", times), _toml_list("steps", weights)]
        else:
            other = "b" if source == "a" else "a"
            lines += [_toml_list("times", times), _toml_list(source, weights), _toml_list(other, [0] * len(times))]
    lines += ["", "[output]", f'until = "{until}"', *(_toml_list(name, places) for name, places in outputs.items())]
    return "\n".join(lines) + "\n"


_SYSTEMS = {COLLISION: ("collision", ("kappa", "velocity")), DRIVE: ("drive", ("kappa", "inertia"))}


def _toml_list(name: str, values: Sequence[object]) -> str:
    quoted = (f'"{value}"' for value in values)
    return f"{name} = [{', '.join(quoted)}]"
