"""What a formula is worth at a place: trees evaluated in a scope, which says what their letters mean there.

A scope is the whole meaning of a formula: an adapter writes one, and there is no other way to state a reading.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from flint import fmpq

from wavesym.papers.exact_numbers import exponential
from wavesym.papers.tree import (
    Addition,
    AtValue,
    Blank,
    Call,
    Cases,
    Derivative,
    FormulaList,
    Fraction,
    Group,
    Interval,
    Minus,
    Number,
    Power,
    Product,
    Progression,
    Relation,
    Series,
    Symbol,
    Tree,
    latex,
)

MOST_TERMS = 1000
"""A sum with more terms than any formula has: its limits are wrong."""


class MeaninglessError(Exception):
    """A symbol, an index or a limit means nothing at a place: the reason, in a few words."""


def missing_meaning(symbol: Symbol, index: Sequence[int]) -> MeaninglessError:
    """A letter has no meaning with these indices, or without any."""
    which = f"with indices ({', '.join(map(str, index))})" if index else "without an index"
    return MeaninglessError(f"{latex(symbol)} is not defined {which}")


class Scope:
    """What letters mean; `variables` are the plain ones by name: indices, sizes, variables of sums.

    `constants` are those that the ranges of a formula say the value of (`given`). `letters` are functions of their
    indices, `functions` of their indices and arguments, both by `Symbol.letter`; a subclass fills them. Values are what
    Python's operators can combine: integers, fmpq, `Exponentials`.
    """

    heaviside_at_0 = 1
    """H(0), which the paper does not give."""

    def __init__(self, bound: Mapping[str, Any] | None = None, constants: Mapping[Tree, Tree] | None = None) -> None:
        self.variables: dict[str, Any] = dict(bound or {})
        self.constants: Mapping[Tree, Tree] = dict(constants or {})
        self.letters: dict[str, Callable[..., Any]] = {}
        self.functions: dict[str, Callable[..., Any]] = {}

    # what a test says

    def symbol(self, symbol: Symbol) -> Any:
        """The value of a letter that is not in `variables`, or has marks."""
        return self.meaning(self.letters, symbol)

    def call(self, call: Call) -> Any:
        """The value of a function other than H and E."""
        return self.meaning(self.functions, call.function, *map(self.value, call.arguments))

    def meaning(self, known: Mapping[str, Callable[..., Any]], symbol: Symbol, *arguments: Any) -> Any:
        """What a letter or function is there; MeaninglessError where it is not known, or has not these indices."""
        if (means := known.get(symbol.letter)) is None or symbol.superscript:
            raise MeaninglessError(f"{latex(symbol)} is not defined")
        index = self.indices(symbol)
        try:
            return means(*index, *arguments)
        except (LookupError, TypeError):
            raise missing_meaning(symbol, index) from None

    def derivative(self, derivative: Derivative) -> Any:
        """The value of a partial derivative."""
        raise MeaninglessError(f"{latex(derivative)} is not defined")

    def at_value(self, tree: AtValue) -> Any:
        """What something is where a variable has a value."""
        variable, value = sides(tree.condition)
        if not isinstance(variable, Symbol):
            raise MeaninglessError(f"{latex(tree.condition)} gives no value")
        with self.bind({variable.name: self.value(value)}):
            return self.value(tree.expression)

    # what all formulas share

    def value(self, tree: Tree) -> Any:
        """The value of a tree; MeaninglessError."""
        return _runner(tree)(self)

    def literal(self, value: Any) -> Any:
        """A number as it is written."""
        return value

    def whole(self, tree: Tree) -> int:
        """The value of an index or a limit."""
        return _as_whole(_runner(tree)(self), tree)

    def indices(self, symbol: Symbol) -> tuple[int, ...]:
        """The lower indices."""
        return _index_runners(symbol)[0](self)

    def upper(self, symbol: Symbol) -> tuple[int, ...]:
        """The upper indices."""
        return _index_runners(symbol)[1](self)

    def bind(self, names: Mapping[str, Any]) -> _Binding:
        """The same scope with other values of plain letters, in a `with` statement."""
        return _Binding(self, {**self.variables, **names})

    def _constant(self, symbol: Symbol) -> Any:
        """Its value, in letters that are no constants themselves."""
        constants, self.constants = self.constants, {}
        try:
            return self.value(constants[symbol])
        finally:
            self.constants = constants

    def step(self, value: Any) -> Any:
        """H."""
        return self.heaviside_at_0 if value == 0 else int(value > 0)

    def entier(self, value: Any) -> Any:
        """E."""
        return int(fmpq(value).floor())

    def series(self, series: Series) -> Any:
        """A sum with limits."""
        first, last = self.whole(series.first), self.whole(series.last)
        if last - first > MOST_TERMS:
            raise MeaninglessError(f"a sum from {first} to {last}")
        total: Any = 0
        body, name, before = _runner(series.body), series.variable.name, self.variables
        try:
            self.variables = dict(before)
            for number in range(first, last + 1):
                self.variables[name] = number
                total = total + body(self)
        finally:
            self.variables = before
        return total

    def power(self, power: Power) -> Any:
        """A base with an exponent."""
        exponent = self.value(power.exponent)
        if power.base == _E:
            return exponential(exponent)
        base = self.value(power.base)
        whole = _as_whole(exponent, power.exponent)
        if whole < 0 and base == 0:
            raise MeaninglessError(f"{latex(power)} divides by 0")
        return fmpq(base) ** whole if not isinstance(base, int) or whole < 0 else base**whole

    def _cases(self, cases: Cases) -> Any:
        values = [value for value, where in cases.branches if holds(where, self)]
        if len(values) != 1:
            raise MeaninglessError(f"{'no' if not values else 'more than one'} case for {self.variables}")
        return self.value(values[0])

    def _refuse(self, tree: Tree) -> Any:
        raise MeaninglessError(f"{latex(tree)} is no value")


class _Binding:
    """Variables of a scope while a `with` statement runs; `contextmanager` would be four times as slow."""

    __slots__ = ("_others", "_scope")

    def __init__(self, scope: Scope, variables: dict[str, Any]) -> None:
        self._scope, self._others = scope, variables

    def __enter__(self) -> None:
        self._scope.variables, self._others = self._others, self._scope.variables

    def __exit__(self, *error: object) -> None:
        self._scope.variables = self._others


def sides(tree: Tree) -> tuple[Tree, ...]:
    """The two sides of an equation; MeaninglessError where it is none."""
    if not isinstance(tree, Relation) or tree.signs != ("=",):
        raise MeaninglessError(f"{latex(tree)} is no equation")
    return tree.sides


def items(tree: Tree) -> tuple[Tree, ...]:
    """The formulas of a list; one alone is a list of one."""
    return tree.items if isinstance(tree, FormulaList) else (tree,)


def without_brackets(tree: Tree) -> Tree:
    """What stands within brackets."""
    return without_brackets(tree.inner) if isinstance(tree, Group) else tree


_COMPARED: dict[str, Callable[[Any, Any], bool]] = {
    "=": lambda a, b: bool(a == b),
    "<": lambda a, b: bool(a < b),
    ">": lambda a, b: bool(a > b),
    r"\leq": lambda a, b: bool(a <= b),
    r"\le": lambda a, b: bool(a <= b),
    r"\geq": lambda a, b: bool(a >= b),
    r"\ge": lambda a, b: bool(a >= b),
    r"\neq": lambda a, b: bool(a != b),
}


def holds(where: Tree, scope: Scope) -> bool:
    """Whether a range holds at a place."""
    match where:
        case Relation(sides, signs):
            values = [scope.value(side) for side in sides]
            return all(_COMPARED[sign](a, b) for sign, a, b in zip(signs, values, values[1:], strict=False))
        case Progression(variable):
            value = scope.value(variable)
            return value in span(where, scope, most=value)
        case Interval(variable, (opening, closing), low, high):
            value, first, last = scope.value(variable), scope.value(low), scope.value(high)
            after = first <= value if opening == r"\langle" else first < value
            return bool(after and (value <= last if closing == r"\rangle" else value < last))
    raise MeaninglessError(f"{latex(where)} is no range")


def constants_in(ranges: Iterable[Tree]) -> dict[Tree, Tree]:
    """The constants that ranges say the value of, such as "v_0 = c_f U_0 / l"."""
    return {
        r.variable: r.first_values[0]
        for r in ranges
        if isinstance(r, Progression) and len(r.first_values) == 1 and not r.dots
    }


def span(progression: Tree, scope: Scope, most: int = 0) -> tuple[int, ...]:
    """The values of a range in its order; one that does not end has those up to `most`, its first ones at least.

    The step is that of the values shown. Where the last value comes before the first, there are none, unless all
    values are shown.
    """
    if not isinstance(progression, Progression):
        raise MeaninglessError(f"{latex(progression)} is no range of values")
    shown = [scope.whole(value) for value in progression.first_values]
    if not progression.dots:
        return tuple(shown)
    if len(shown) < 2:
        step = 1
    else:
        steps = {b - a for a, b in itertools.pairwise(shown)}
        if len(steps) != 1 or 0 in steps:
            raise MeaninglessError(f"{latex(progression)} has no one step")
        (step,) = steps
    if progression.last is None:
        last = max(most, shown[-1])
        last -= (last - shown[0]) % step
    else:
        last = scope.whole(progression.last)
    if (last - shown[0]) % step:
        raise MeaninglessError(f"{latex(progression)}: {last} is not reached from {shown[0]} in steps of {step}")
    return tuple(range(shown[0], last + (1 if step > 0 else -1), step))


def places(ranges: Iterable[Tree], scope: Scope, most: int = 0) -> list[dict[str, Any]]:
    """The values of all running letters, range by range, for which the other ranges hold."""
    kept = [scope.variables]
    for range_ in ranges:
        before, kept = kept, []
        for place in before:
            with scope.bind(place):
                if isinstance(range_, Progression) and latex(range_.variable) not in scope.variables:
                    kept += [{**place, latex(range_.variable): value} for value in span(range_, scope, most)]
                elif holds(range_, scope):
                    kept.append(place)
    return kept


def _switches(factor: Tree) -> bool:
    """Not H; for sorting, H first."""
    return not (isinstance(factor, Call) and factor.function.name == "H")


Runner = Callable[[Scope], Any]
"""A tree made ready: its value in a scope. Trees that share a part share its runner."""


def _runner(tree: Tree) -> Runner:
    try:
        return tree.__dict__["_runner"]  # type: ignore[no-any-return]
    except KeyError:
        runner = _MAKERS[type(tree)](tree)
        tree.__dict__["_runner"] = runner
        return runner


def _as_whole(value: Any, tree: Tree) -> int:
    if type(value) is int:
        return value
    if isinstance(value, fmpq) and value.denom() == 1:
        return int(value.numer())
    raise MeaninglessError(f"{latex(tree)} = {value} is no whole number")


def _index_runners(symbol: Symbol) -> tuple[Callable[[Scope], tuple[int, ...]], Callable[[Scope], tuple[int, ...]]]:
    """What gives the lower and the upper indices of a letter."""
    try:
        return symbol.__dict__["_index_runners"]  # type: ignore[no-any-return]
    except KeyError:
        runners = _indices(symbol.subscript), _indices(symbol.superscript)
        symbol.__dict__["_index_runners"] = runners
        return runners


def _indices(trees: tuple[Tree, ...]) -> Callable[[Scope], tuple[int, ...]]:
    if all(isinstance(tree, Number) for tree in trees):
        fixed = tuple([_as_whole(_runner(tree)(Scope()), tree) for tree in trees])
        return lambda scope: fixed
    runners = [(_runner(tree), tree) for tree in trees]
    return lambda scope: tuple([_as_whole(runner(scope), tree) for runner, tree in runners])


def _number(tree: Number) -> Runner:
    before, point, after = tree.digits.partition(".")
    value = fmpq(int(before + after), 10 ** len(after)) if point else int(before)
    return lambda scope: scope.literal(value)


def _symbol(tree: Symbol) -> Runner:
    name = tree.name

    def plain(scope: Scope) -> Any:
        bound = scope.variables
        return bound[name] if name in bound else with_marks(scope)

    def with_marks(scope: Scope) -> Any:
        if scope.constants and tree in scope.constants:
            return scope._constant(tree)
        return scope.symbol(tree)

    return with_marks if tree.subscript or tree.superscript or tree.primes or tree.accent else plain


def _minus(tree: Minus) -> Runner:
    term = _runner(tree.term)
    return lambda scope: -term(scope)


def _addition(tree: Addition) -> Runner:
    first, *others = map(_runner, tree.terms)

    def run(scope: Scope) -> Any:
        total = first(scope)
        for term in others:
            total = total + term(scope)
        return total

    return run


def _product(tree: Product) -> Runner:
    """A factor 0 in front (H, mostly) leaves the rest unread: what it switches off need not exist."""
    factors = [_runner(factor) for factor in sorted(tree.factors, key=_switches)]

    def run(scope: Scope) -> Any:
        total: Any = 1
        for factor in factors:
            total = total * factor(scope)
            if type(total) is int and total == 0:
                return 0
        return total

    return run


def _fraction(tree: Fraction) -> Runner:
    above, below = _runner(tree.numerator), _runner(tree.denominator)

    def run(scope: Scope) -> Any:
        over, under = above(scope), below(scope)
        if under == 0:
            raise MeaninglessError(f"{latex(tree)} divides by 0")
        try:
            return fmpq(over) / under if isinstance(over, int) else over / under
        except TypeError:
            raise MeaninglessError(f"{latex(tree)} divides by what is no rational number") from None

    return run


def _call(tree: Call) -> Runner:
    if tree.function in (_H, _ENTIER) and len(tree.arguments) == 1:
        argument = _runner(tree.arguments[0])
        if tree.function == _H:
            return lambda scope: scope.step(argument(scope))
        return lambda scope: scope.entier(argument(scope))
    return lambda scope: scope.call(tree)


def _method_runner(method: Callable[[Scope, Any], Any]) -> Callable[[Any], Runner]:
    return lambda tree: lambda scope: method(scope, tree)


_E, _H, _ENTIER = Symbol("e"), Symbol("H"), Symbol("E")
_MAKERS: dict[type, Callable[[Any], Runner]] = {
    Number: _number,
    Symbol: _symbol,
    Minus: _minus,
    Addition: _addition,
    Product: _product,
    Fraction: _fraction,
    Power: _method_runner(lambda scope, tree: scope.power(tree)),
    Group: lambda tree: _runner(tree.inner),
    Call: _call,
    Series: _method_runner(lambda scope, tree: scope.series(tree)),
    Derivative: _method_runner(lambda scope, tree: scope.derivative(tree)),
    AtValue: _method_runner(lambda scope, tree: scope.at_value(tree)),
    Cases: _method_runner(Scope._cases),
    **dict.fromkeys((Blank, Relation, FormulaList, Progression, Interval), _method_runner(Scope._refuse)),
}
