"""An output as a formula: what it gains at each breakpoint, an exponential polynomial in the time since then.

The coefficients are exact: fractions, or rational functions of the parameters (`symbolic`). As text, as LaTeX, as one
expression for SymPy, or as a function in C, whose numbers are the nearest doubles. What has numbers is added there as
the closed form is, so that its bound holds, and refused where that is beyond the tolerance.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from flint import fmpq

from wavesym.derivation.increments import Increment, add, integrate, trim
from wavesym.derivation.increments import start as begin
from wavesym.derivation.symbolic import SymbolicChain
from wavesym.derivation.table import Function, Rules, unit_response
from wavesym.documents.latex_number import latex_number
from wavesym.errors import CostError, UnservedError, WavesymError, did_you_mean
from wavesym.exact.tables.signal import Signal, signals
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.numbers.ratio import Ratio
from wavesym.programs.closed_form import closed_form
from wavesym.programs.request import unmet_tolerance
from wavesym.rendering import render as render_template

MOST_TERMS = 2000
_POWER = re.compile(r"(\w+|\([^()]*\))\*\*(\d+)")
_INTEGER = re.compile(r"(?<![\w.])\d+(?![\w.])")

Number = fmpq | Ratio


class Gain(NamedTuple):
    """What an output gains at tau = `start`: sum_g exp(-g w) sum_k increment[g][k] w^k, w = tau - start."""

    start: fmpq
    increment: Increment


@dataclass(frozen=True)
class Formula:
    """An output until tau = `until`.

    Attributes:
        scene: the scene's name.
        name: the output's; `unit` its unit, empty without [units].
        until: the horizon.
        gains: in order of time.
        letters: what the coefficients are functions of, each with its value in the scene; empty where they are numbers.
        seconds: what one tau is; None without [units].
        signal: the same as `gains`; None where coefficients are functions.
        tolerance: on the error of a function in C, relative to its largest value.
        tau_max: the last double that it is for.
    """

    scene: str
    name: str
    unit: str
    until: fmpq
    gains: tuple[Gain, ...]
    letters: Mapping[str, fmpq]
    seconds: fmpq | None
    signal: Signal | None
    tolerance: fmpq
    tau_max: float

    def render(self, format: str) -> str:
        """As text. `format` is "text", "latex", "sympy" or "c". ToleranceError where C would lose too many digits."""
        return {"text": self._text, "latex": self._latex, "sympy": self._sympy, "c": self._c}[format]()

    @property
    def title(self) -> str:
        """What it is, in a line."""
        unit = f" [{self.unit}]" if self.unit else ""
        clock = f", tau = time/({self.seconds} s)" if self.seconds is not None else ""
        letters = "; ".join(f"{name} is {value} in the scene" for name, value in self.letters.items())
        return f"{self.name}{unit} of {self.scene}, tau from 0 to {self.until}{clock}{letters and '; '}{letters}"

    def _text(self) -> str:
        if not self.gains:
            return f"{self.title}\n0\n"
        lines = [f"from tau = {g.start} on, {_clock_text(g.start)}:\n    {_sum(g, _plain)}\n" for g in self.gains]
        return f"{self.title}: the sum of\n" + "".join(lines)

    def _latex(self) -> str:
        rows = [rf"H(\tau{_latex_ago(g.start)})\left[{_sum(g, _latex_term, g.start)}\right]" for g in self.gains]
        body = " \\\\\n  &\\quad + ".join(rows) or "0"
        return f"% {self.title}\n\\begin{{aligned}}\n  &{body}\n\\end{{aligned}}\n"

    def _sympy(self) -> str:
        terms = (f"Heaviside({_ago(g.start)}, 1)*({_sum(g, _sympy_term, g.start)})" for g in self.gains)
        return " + ".join(terms) + "\n" if self.gains else "Integer(0)\n"

    def _c(self) -> str:
        gains = []
        for gain in self.gains:
            first = not_below(gain.start)
            rates = sorted(gain.increment) if self.signal else _rates(gain)  # the closed form's order
            families = tuple(_c_family(rate, gain.increment[rate]) for rate in rates)
            late = nearest(rational(first) - gain.start)
            gains.append(CGain(repr(first), repr(late) if late else "", _is_constant(gain), families))
        function = f"{self.scene}_{_identifier(self.name)}"
        return render_template(
            "c/formula.c.j2",
            title=self.title,
            bound=self._bound(),
            function=function,
            letters=tuple(self.letters.items()),
            gains=tuple(gains),
        )

    def _bound(self) -> str:
        """What is proved of the function in C, in a line."""
        if self.signal is None:
            return "not bounded: digits are lost where terms cancel, as those of nearly equal rates do"
        closed = closed_form((self.signal,), self.tau_max)
        if rational(min(closed.error_bound, 2.0)) > self.tolerance:
            refusal = closed.shortfall(self.tolerance).removeprefix("closed: ")
            refusals = {"--format c": f"{refusal}, other formats are exact"}
            raise unmet_tolerance(self.tolerance, refusals, closed.error_bound)
        return f"right to {closed.error_bound:g} of its largest value, proved"


@dataclass(frozen=True)
class CGain:
    """What is added from a tau on: the first double that counts, how late that is, whether it stays, and the terms."""

    first: str
    late: str
    constant: bool
    terms: tuple[str, ...]


Term = Callable[[Number, Number, int], str]


def _is_constant(gain: Gain) -> bool:
    return all(rate == 0 and not any(row[1:]) for rate, row in gain.increment.items())


def _rates(gain: Gain) -> list[fmpq]:
    """0 first, then as they are written."""
    return sorted(gain.increment, key=lambda rate: (rate != 0, str(rate)))


def _terms(gain: Gain, term: Term) -> Iterator[str]:
    for rate in _rates(gain):
        for power, value in enumerate(gain.increment[rate]):
            if value != 0:
                yield term(value, rate, power)


def _sum(gain: Gain, term: Callable[..., str], *more: object) -> str:
    joined = " + ".join(_terms(gain, lambda value, rate, power: term(value, rate, power, *more)))
    return joined.replace("+ -", "- ")


def _factor(value: object) -> str:
    text = str(value)
    return f"({text})" if " " in text or (not isinstance(value, fmpq) and "/" in text) else text


def _clock_text(since: fmpq) -> str:
    return f"w = tau - {since}" if since != 0 else "w = tau"


def _plain(value: Number, rate: Number, power: int) -> str:
    bare = power == 0 and rate == 0
    number = "" if value == 1 and not bare else "-" if value == -1 and not bare else f"{_factor(value)} "
    parts = ["w" if power == 1 else f"w^{power}"] if power else []
    if rate != 0:
        parts.append("exp(-w)" if rate == 1 else f"exp(-{_factor(rate)} w)")
    return f"{number}{' '.join(parts)}".rstrip().replace("**", "^")


def _rational(value: object) -> str:
    if isinstance(value, fmpq):
        return f"Rational({value.p}, {value.q})" if value.q != 1 else f"Integer({value.p})"
    # a rational function with integers: one of them over another would be a float
    return "(" + _INTEGER.sub(lambda found: f"Integer({found[0]})", str(value)) + ")"


def _ago(since: fmpq) -> str:
    return f"tau - {_rational(since)}" if since != 0 else "tau"


def _sympy_term(value: Number, rate: Number, power: int, since: fmpq) -> str:
    w = f"({_ago(since)})" if since != 0 else "tau"
    parts = [_rational(value), *([w if power == 1 else f"{w}**{power}"] if power else [])]
    return "*".join([*parts, *([f"exp(-{_rational(rate)}*{w})"] if rate != 0 else [])])


def _latex_ago(since: fmpq) -> str:
    return f" - {latex_number(since)}" if since != 0 else ""


def _latex_term(value: Number, rate: Number, power: int, since: fmpq) -> str:
    w = rf"(\tau{_latex_ago(since)})" if since != 0 else r"\tau"
    bare = power == 0 and rate == 0
    number = "" if value == 1 and not bare else "-" if value == -1 and not bare else latex_number(value)
    number = rf"\left({number}\right)" if " + " in number or " - " in number else number
    once = "" if isinstance(rate, fmpq) and rate == 1 else latex_number(rate)
    once = rf"\left({once}\right)" if " + " in once or " - " in once else once
    parts = [number, *([w + (f"^{{{power}}}" if power > 1 else "")] if power else [])]
    return r"\,".join(each for each in [*parts, *([f"e^{{-{once}{w}}}"] if rate != 0 else [])] if each)


def _c_number(value: object) -> str:
    if isinstance(value, fmpq):
        return repr(nearest(value))
    text, found = str(value), 1
    while found:
        text, found = _POWER.subn(r"pow(\1, \2)", text)
    return "(" + _INTEGER.sub(lambda found: f"{found[0]}.0", text) + ")"


def _c_family(rate: Number, powers: Sequence[Number]) -> str:
    """exp(-rate w) times a polynomial of w, by Horner's rule."""
    *others, last = powers
    text = _c_number(last)
    for value in reversed(others):
        text = f"{f'({text})' if ' + ' in text else text} * w"
        text += f" + {_c_number(value)}" if value != 0 else ""
    if rate == 0:
        return text
    return f"{f'({text})' if ' + ' in text else text} * exp(-{_c_number(rate)} * w)"


def _identifier(name: str) -> str:
    """`strain_1_plus` for strain@1+."""
    sided = name.removesuffix(name[-1]) + {"+": "_plus", "-": "_minus"}.get(name[-1], name[-1])
    return re.sub(r"[^A-Za-z0-9]+", "_", sided)


def output_formula(model: Model, name: str) -> Formula:
    """An output of a model, its coefficients in numbers.

    Args:
        model: with the horizon that is wanted.
        name: the output's.

    Raises:
        WavesymError: for an output that there is not.
        UnservedError: for contacts that open, damped modes, and joints whose polynomial does not split.
        CostError: for a formula of too many terms.
    """
    model.refuse_damping("leave it out: sums of damped modes have no closed form between fronts; `frf` has theirs")
    probe = _probe(model, name)
    (signal,) = signals(model.watching([probe]), most=50 * MOST_TERMS)
    gains = tuple(Gain(arrival.time, arrival.increment) for arrival in signal.arrivals)
    return _formula(model, probe, gains, {}, signal)


def symbolic_formula(model: Model, name: str, symbols: SymbolicChain, frame: fmpq) -> Formula:
    """An output of one of the paper's systems, its coefficients functions of the parameters; loads stay numbers.

    Args:
        model: with the horizon that is wanted.
        name: the output's: a strain, a velocity, a displacement, a drift, or a displacement relative to the ground.
        symbols: the chain of the model with symbols for its numbers; its last body rests.
        frame: how fast that body moves in the model at first.

    Raises:
        WavesymError, CostError: as for `output_formula`.
        UnservedError: for other outputs.
    """
    probe = _probe(model, name)
    if probe.computed_quantity in ("force", "acceleration"):
        raise UnservedError(
            f"--symbolic: {probe.name} is no sum of waves without parameters; a strain, velocity, displacement, drift "
            "or relative displacement is"
        )
    rules, chain = Rules(symbols.chain), symbols.chain
    readings = [term for term in model.sums[probe] if term.reading.moves]
    parts = [
        (weight * sign, Function(letter, reading.rod), reading.place, reading.order < 0)
        for weight, reading in readings
        for letter, sign in zip("fg", reading.weights, strict=True)
    ]
    gains: dict[fmpq, list[tuple[fmpq, Increment, bool]]] = {}
    for source in dict.fromkeys(load.source for load in model.loads):
        wanted: dict[Function, int] = {}
        for _, function, place, _ in parts:
            delay = _delay(symbols, function, place)
            count = int(((model.until - delay) / rules.interval).floor()) + 1
            wanted[function] = max(count, wanted.get(function, 0))
        response = unit_response(rules, source, {function: count for function, count in wanted.items() if count > 0})
        for weight, function, place, integral in parts:
            delay = _delay(symbols, function, place)
            for load in (load for load in model.loads if load.source == source):
                for n, increment in enumerate(response.get(function, ())):
                    time = load.time + delay + rules.interval * n
                    if increment and time <= model.until:
                        gains.setdefault(time, []).append((weight * load.weight, increment, integral))
    for weight, reading in readings:
        velocity = chain.rod(reading.rod).velocity + frame
        if reading.quantity != "strain" and velocity != 0:
            constant: Increment = {fmpq(0): [velocity]}
            gains.setdefault(fmpq(0), []).append((weight, constant, reading.order < 0))
    made = []
    for time in sorted(gains):
        total: Increment = {}
        for weight, increment, integral in gains[time]:
            add(total, integrate(increment) if integral else increment, weight)
        whole = trim(total)
        if whole and not (time == model.until and begin(whole) == 0):
            made.append(Gain(time, whole))
    return _formula(model, probe, tuple(made), symbols.values, None)


def _delay(symbols: SymbolicChain, function: Function, place: fmpq) -> fmpq:
    """When the first interval of a function begins at a place of its rod."""
    way = place if function.function == "f" else 1 - place
    return way + symbols.chain.leaves(*function, 0)


def _probe(model: Model, name: str) -> Probe:
    named = [probe for probe in model.probes if probe.name == name]
    if not named:
        names = [probe.name for probe in model.probes]
        hint = did_you_mean(name, names)
        raise WavesymError(
            f"--output: {name} is no output of {model.name}; it has {', '.join(names)}{hint and '. '}{hint}"
        )
    return named[0]


def _formula(
    model: Model, probe: Probe, gains: Sequence[Gain], letters: Mapping[str, fmpq], signal: Signal | None
) -> Formula:
    count = sum(len(powers) for gain in gains for powers in gain.increment.values())
    if count > MOST_TERMS:
        raise CostError(
            f"--until: {count} terms, the limit is {MOST_TERMS} (an earlier one or fewer changes of loads help)"
        )
    seconds = model.clock.seconds if model.clock else None
    text = " ".join(str(each) for g in gains for rate, row in g.increment.items() for each in (rate, *row))
    met = {name: value for name, value in letters.items() if name in set(re.findall(r"[a-z]\w*", text))}
    told = (model.name, probe.name, probe.unit, model.until, tuple(gains), met, seconds)
    return Formula(*told, signal, model.tolerance, model.horizon())
