"""A derivation as people read it: from the equations of motion of a system to its coefficients, family by family."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sympy import Expr, Indexed, IndexedBase

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, delay_equations
from wavesym.derivation.delay_terms import exact
from wavesym.derivation.recurrence import CoefficientLaw, recurrence
from wavesym.derivation.rods import rod_kinds
from wavesym.documents.derivation.chain_laws import Meaning, meanings, merged_parameters, own_laws
from wavesym.documents.derivation.dimensions import LENGTH, SPEED, Dimensions, dimensions
from wavesym.documents.derivation.families import integral, substitute
from wavesym.documents.derivation.highest_powers import POWERS, PowerFamily
from wavesym.documents.derivation.notation import Text
from wavesym.documents.derivation.patterns import Pattern, pattern_laws, patterns, rates
from wavesym.documents.derivation.writer import Place, Writer
from wavesym.errors import WavesymError
from wavesym.mechanics.node import Node, System
from wavesym.systems import presets

if TYPE_CHECKING:
    from wavesym.derivation.symbolic import SymbolicChain

LARGEST_WRITTEN_OUT = 100
MOST_FAMILIES = 6  # beyond that the law at one rate g is easier to read than a line for each


@dataclass(frozen=True)
class Entry:
    """What is said of one kind of node, rod or function: which, and its formulas."""

    of: str
    formulas: tuple[str, ...]


@dataclass(frozen=True)
class Families:
    """The laws at each rate, for one pattern of equal parameters: which are equal, and the different rates.

    `symbols` says what symbols stand for, where they are those of a scene.
    """

    name: str
    size: str
    symbols: tuple[str, ...]
    given: tuple[str, ...]
    rates: tuple[str, ...]
    laws: tuple[Entry, ...]


@dataclass(frozen=True)
class Powers:
    """The highest powers K beside the rate of a family of bodies; what their leading coefficients count, if that."""

    of: str
    size: str
    rate: str
    rows: tuple[Entry, ...]
    walks: str
    leading: tuple[str, ...]


@dataclass(frozen=True)
class Statement:
    """A system's derivation in one notation; interval n of every function starts at z = `start`.

    `quantities` are those of section 2, `rods` has (4.2) with Table 1, `nodes` the conditions with (4.2) put in;
    `stretches` has the laws of the nodes on powers of time.
    """

    name: str
    size: str
    start: str
    legend: tuple[Entry, ...]
    note: str
    quantities: tuple[str, ...]
    conditions: tuple[Entry, ...]
    rods: tuple[Entry, ...]
    nodes: tuple[Entry, ...]
    equations: tuple[Entry, ...]
    recurrences: tuple[Entry, ...]
    displacements: tuple[Entry, ...]
    stretches: tuple[Entry, ...]
    families: tuple[Families, ...]
    powers: tuple[Powers, ...]


def systems(name: str, m: int | None) -> tuple[System, ...]:
    """ "collision", "drive" or "building" (both bases). WavesymError for an m that these do not have or none reads."""
    variants = presets()[name].variants
    for system in variants:
        if m is not None and m not in range(system.smallest, LARGEST_WRITTEN_OUT + 1, system.step):
            even = "even, " if system.step == 2 else ""
            raise WavesymError(f"--m: {m} is not supported; write {even}{system.smallest} ... {LARGEST_WRITTEN_OUT}")
    return variants


def statements(name: str, m: int | None, notation: Text) -> tuple[Statement, ...]:
    """The derivation of a system (see `systems`), for symbolic m or written out for one m. WavesymError."""
    author = _Author(notation, m)
    return tuple(author.statement(system, author.patterns(system)) for system in systems(name, m))


def scene_statement(name: str, symbols: SymbolicChain, notation: Text) -> Statement:
    """The derivation of a scene's system for symbolic m, and the families of the scene's own m and pattern.

    WavesymError where the scene has too many rods to read.
    """
    m = symbols.chain.m
    if m > LARGEST_WRITTEN_OUT:
        raise WavesymError(f"system.m: {m} is more than can be written out; write {LARGEST_WRITTEN_OUT} or less")
    author = _Author(notation, None)
    return author.statement(symbols.chain.system, [author.scene(name, symbols)])


class _Author:
    """Puts a statement together, for symbolic m or for one."""

    def __init__(self, notation: Text, m: int | None) -> None:
        self.n = notation
        self.m = m
        self.w = Writer(notation, m)

    def statement(self, system: System, families: Iterable[Families]) -> Statement:
        laws = recurrence(system)
        units = dimensions(system)
        return Statement(
            name=system.name,
            size=self._size(system),
            start="(n - 1)" if laws.interval == 1 else f"{laws.interval} (n - 1)",
            legend=tuple(self._legend(units)) if units else (),
            note=self.n.word(units.note) if units else "",
            quantities=tuple(self._quantities(units)) if units else (),
            conditions=tuple(self._nodes(system, self.w.condition)),
            rods=tuple(self._rods(system)),
            nodes=tuple(self._nodes(system, self.w.at_node)),
            equations=tuple(self._equations(system)),
            recurrences=tuple(self._laws(laws.laws)),
            displacements=tuple(self._displacements()),
            stretches=tuple(self._nodes(system, self.w.stretch)),
            families=tuple(families),
            powers=tuple(self._powers(system)),
        )

    def _size(self, of: System | PowerFamily) -> str:
        return f"m = {self.m}" if self.m is not None else self.n.lower_limit(of.smallest)

    def _powers(self, system: System) -> Iterator[Powers]:
        for family in POWERS.get(system.name, ()):
            if self.m is not None and self.m < family.smallest:
                continue
            rows = (
                Entry(
                    f"{self.n.with_index(row.function, at(row.rod))}{self.w.range(row.first, row.last, row.step)}",
                    (self.w.power(family, row, at),),
                )
                for row in family.rows
                for at in self.w.places(row.first, row.last, row.step)
            )
            yield Powers(
                of=self.n.word(family.subject),
                size=self._size(family),
                rate=self.n.expression(family.rate),
                rows=tuple(rows),
                walks=self.n.word(family.walks),
                leading=(self.n.expression(family.leading),) if family.leading else (),
            )

    def _legend(self, units: Dimensions) -> Iterator[Entry]:
        for letter, words in units.legend:
            yield Entry(self.n.word(words), (self.n.expression(letter),))

    def _quantities(self, units: Dimensions) -> Iterator[str]:
        u, a, b = (IndexedBase(name)[INDEX] for name in (units.displacement, "A", "B"))
        pairs = [
            (IndexedBase("U")[INDEX], u),
            (SPEED**2, units.speed_squared),
            (a, units.stiffness),
            (b, units.inertia),
            *([units.load] if units.load else []),
            (SYMBOLS.kappa[INDEX], a * LENGTH / (SPEED**2 * b)),
            (SYMBOLS.kappa[INDEX], units.kappa),
        ]
        for left, right in pairs:
            yield f"{self.n.expression(left)} = {self.n.expression(right)}"

    def _nodes(self, system: System, write: Callable[[Node, Expr, Place], Iterator[str]]) -> Iterator[Entry]:
        for family in system.families(COUNT, SYMBOLS):
            alone = exact(family.first - family.last) == 0
            x = exact(family.first) if alone else INDEX
            where = self.w.range(family.first, family.last, family.step)
            for at in self.w.places(family.first, family.last, family.step):
                yield Entry(f"x = {self.n.expression(at(x))}{where}", tuple(write(family.node_at(x), x, at)))

    def _rods(self, system: System) -> Iterator[Entry]:
        for kind in rod_kinds(system):
            where = self.w.range(kind.first, kind.last, kind.step)
            for at in self.w.places(kind.first, kind.last, kind.step):
                yield Entry(f"{self.n.expression(at(kind.number))}{where}", tuple(self.w.rod(kind, at)))

    def _equations(self, system: System) -> Iterator[Entry]:
        for equation in delay_equations(system):
            where = self.w.range(equation.first, equation.last, equation.step)
            for at in self.w.places(equation.first, equation.last, equation.step):
                yield Entry(where, (self.w.equation(equation, at),))

    def _laws(self, laws: Iterable[CoefficientLaw]) -> Iterator[Entry]:
        for law in laws:
            where = self.w.range(law.first, law.last, law.step)
            for at in self.w.places(law.first, law.last, law.step):
                yield Entry(f"{self.n.with_index(law.function, at(law.rod))}{where}", tuple(self.w.law(law, at)))

    def _displacements(self) -> Iterator[Entry]:
        for function in ("f", "g"):
            yield self._family(integral(function, function.upper()), None, {})

    def _family(self, law: CoefficientLaw, found: tuple[Expr, ...] | None, names: Mapping[Expr, Expr]) -> Entry:
        where = self.w.range(law.first, law.last, law.step)
        return Entry(f"{self.n.with_index(law.function, law.rod)}{where}", tuple(self.w.families(law, found, names)))

    def patterns(self, system: System) -> Iterator[Families]:
        """The families for every pattern; of patterns that are one for this m, the last."""
        different: dict[tuple[CoefficientLaw, ...], Pattern] = {}
        for pattern in patterns(system):
            laws = pattern_laws(system, pattern)
            here = (substitute(law, at) for law in laws for at in self.w.places(law.first, law.last, law.step))
            different[tuple(here)] = pattern
        for laws, pattern in different.items():
            yield self._families(
                pattern.name,
                self._size(system),
                laws,
                given=tuple(line for equal in pattern.equalities for line in self.w.equal(equal)),
            )

    def scene(self, name: str, symbols: SymbolicChain) -> Families:
        """The families of a chain of symbols."""
        return self._families(
            name,
            f"m = {symbols.chain.m}",
            own_laws(symbols.chain),
            symbols=tuple(map(self._meaning, meanings(symbols))),
            given=tuple(map(self._meaning, merged_parameters(symbols))),
        )

    def _meaning(self, meaning: Meaning) -> str:
        parts = (self.n.expression(part) for part in (meaning.symbol, meaning.stands_for, meaning.value))
        return " = ".join(dict.fromkeys(parts))

    def _families(
        self,
        name: str,
        size: str,
        laws: Sequence[CoefficientLaw],
        symbols: tuple[str, ...] = (),
        given: tuple[str, ...] = (),
    ) -> Families:
        """A line for each rate where they are few, and none stands for several."""
        found = rates(laws)
        few = found if len(found) <= MOST_FAMILIES and not any(rate.has(INDEX) for rate in found) else None
        names = _names(few) if few else {}
        return Families(
            name=self.n.word(name),
            size=size,
            symbols=symbols,
            given=given,
            rates=tuple(self._rates(laws, found, names)),
            laws=tuple(self._family(law, few, names) for law in laws),
        )

    def _rates(
        self, laws: Sequence[CoefficientLaw], found: Iterable[Expr], names: Mapping[Expr, Expr]
    ) -> Iterator[str]:
        for rate in found:
            of = next((law for law in laws if rate.has(INDEX) and law.own_rate == rate), None)
            where = self.w.range(of.first, of.last, of.step) if of else ""
            name = f"{self.n.expression(names[rate])} = " if rate in names else ""
            yield f"{name}{self.n.expression(rate)}{where}"


def _names(found: Iterable[Expr]) -> dict[Expr, Expr]:
    """gamma_1, gamma_2, ..., as in (4.11), for rates of which one is more than a multiple of a parameter."""
    own = [rate for rate in found if rate != 0]
    if all(len(rate.atoms(Indexed)) == 1 for rate in own):
        return {}
    return {rate: IndexedBase("gamma")[j] for j, rate in enumerate(own, 1)}
