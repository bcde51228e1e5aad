"""What every generated file says of itself: the scene it was made from and what was proved for it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap

from wavesym.exact.contacts.events import ContactEnd
from wavesym.mechanics.model import Model
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.program import Program
from wavesym.targets.literals import c_literal, literal, number_format

_WIDTH = 110
API_VERSION = 1
"""Of what headers declare: one more whenever a program that was written for one of them would not work any more."""


_SIGNS = {
    "drive": "Moments on discs count along positive rotation, but that on the last disc against it; those in shafts "
    "are positive where they turn what is left of them forward, as strains are.",
    "chain": "Loads on nodes count in the direction of x, on branches outwards; forces in rods are positive where they "
    "pull, moments where they turn what is left of them forward.",
}
"""By the type of a system: which way loads act, and forces in rods."""


@dataclass(frozen=True)
class NamedOutput:
    """An output's name, as text and as a constant, its proved bound, relative to its largest value, and its unit.

    The unit is empty where the scene has none, and for what has no dimension; `told` is the name with it.
    """

    name: str
    constant: str
    bound: str
    unit: str
    heading: str


@dataclass(frozen=True)
class NamedContact:
    """The end of a contact: its place for identifiers, tau as a literal of C and of Python, and with 20 digits."""

    position: str
    c_tau: str
    tau: str
    digits: str


@dataclass(frozen=True)
class NamedEvent:
    """What a contact or friction does: its place, what, tau as a literal of Python and with 20 digits; its subject."""

    x: str
    kind: str
    tau: str
    digits: str
    subject: str


@dataclass(frozen=True)
class Description:
    """Strings for the templates. `prefix` is the name in capitals, `model` the scene in lines of text.

    `api` is the version of what generated C declares, `sha256` that of the scene in canonical JSON.
    `name_size` is what the longest name of an output takes in C; `command` makes the same file again.
    `real` and `numpy_real` are the type of all values in C and in NumPy; numbers that C reads have its suffix.
    Of a scene with units `seconds` is what one tau is, in Python, and `c_seconds` in C; `step` how long a step of a
    stream is, or its panel, in the unit of time; else these are empty.
    `trust` says what bounds of errors are: "proved" or "estimated". Where contacts open and close, `events` says what
    they do, and `event_count` how often; else that is empty.
    """

    name: str
    prefix: str
    api: str
    sha256: str
    command: str
    model: tuple[str, ...]
    real: str
    numpy_real: str
    reason: str
    shortfall: str
    units: str
    signs: tuple[str, ...]
    quantities: str
    tolerance: str
    trust: str
    outputs: tuple[NamedOutput, ...]
    output_count: str
    name_size: str
    tau_max: str
    c_tau_max: str
    error_bound: str
    c_error_bound: str
    contacts: tuple[NamedContact, ...]
    events: tuple[NamedEvent, ...]
    event_count: str
    seconds: str
    c_seconds: str
    step: str


def describe(program: Program) -> Description:
    """The description of a program and of what it was made from."""
    origin, real = program.provenance, program.real
    model = origin.model
    called = number_format(real)
    names = [output.name for output in program.outputs]
    bound = _not_below(program.error_bound, real)
    return Description(
        name=model.name,
        prefix=model.name.upper(),
        api=str(API_VERSION),
        sha256=model.labels.sha256,
        command=f"wavesym generate {model.name}.toml{origin.options}",
        model=tuple(line for part in _model(model) for line in wrap(part, _WIDTH, subsequent_indent="  ")),
        real=called.c_type,
        numpy_real=called.numpy_type,
        reason=origin.reason,
        shortfall=origin.shortfall,
        quantities=_quantities(names),
        units=_units(model),
        signs=tuple(wrap(_SIGNS.get(model.labels.system["type"], ""), _WIDTH)),
        tolerance=_tolerance(model),
        trust="proved" if program.proved else "estimated",
        outputs=tuple(
            NamedOutput(
                output.name,
                constant,
                literal(_not_below(output.bound, DOUBLE)),
                probe.unit,
                _with_title(probe.heading, probe.title),
            )
            for output, constant, probe in zip(program.outputs, constants(names), model.probes, strict=True)
        ),
        output_count=str(len(names)),
        name_size=str(max(map(len, names)) + 1),
        tau_max=literal(program.tau_max),  # a double in Python: the shortest text of a float may lie below it
        c_tau_max=c_literal(program.tau_max, real),
        error_bound=literal(bound, real),
        c_error_bound=c_literal(bound, real),
        contacts=tuple(_contact(end, real) for end in origin.contacts),
        events=tuple(
            NamedEvent(one.x, one.kind, literal(real.nearest(rational(one.double)), real), one.digits, one.subject)
            for one in origin.events or ()
        ),
        event_count="" if origin.events is None else str(len(origin.events)),
        seconds=literal(nearest(model.clock.seconds)) if model.clock else "",
        c_seconds=c_literal(real.nearest(model.clock.seconds), real) if model.clock else "",
        step=_step(program),
    )


def _step(program: Program) -> str:
    """How long a step of a stream is, or a panel of one whose steps are not equal, in the unit of time."""
    clock, name = program.provenance.model.clock, program.step or "spacing"
    return clock.format(rational(program.constants[name])) if clock and name in program.constants else ""


def _quantities(names: Sequence[str]) -> str:
    """In which order rows come: the first three always, of the others those that there are."""
    found = [name.partition("@")[0] for name in names]
    return ", ".join(each.plural for each in QUANTITIES.values() if each.usual or each.name in found)


def _units(model: Model) -> str:
    """What numbers count."""
    if model.clock is None:
        return f"Everything is dimensionless: {model.labels.dimensions}, strain positive in tension."
    return f"Time is tau, of which one is {literal(nearest(model.clock.seconds))} s; outputs have the units below."


def _with_title(heading: str, title: str) -> str:
    """An output, or a load, as a comment names it."""
    return f"{heading}: {ascii(title)[1:-1]}" if title else heading


def named_loads(program: Program) -> tuple[tuple[str, str], ...]:
    """Each load that a stream takes: as a comment names it, with its unit, and its constant."""
    titles = program.provenance.model.labels.titles
    keys = [source.partition(" [")[0] for source in program.sources]
    found = (titles.get(key) or titles.get(f"{key}:step") or titles.get(f"{key}:ramp", "") for key in keys)
    named = constants([f"load@{source.partition(' ')[0]}" for source in program.sources])
    return tuple(zip(map(_with_title, program.sources, found), named, strict=True))


def constants(names: Sequence[str]) -> list[str]:
    """Identifiers for outputs: STRAIN_0_5 for strain@0.5, STRAIN_1_PLUS for strain@1+."""
    found: dict[str, None] = {}
    for name in names:
        quantity, _, place = name.partition("@")
        side = {"+": "_PLUS", "-": "_MINUS"}.get(place[-1], "")
        place = re.sub(r"\W", "_", place[:-1] if side else place)
        constant = f"{quantity}_{place}".upper() + side
        # 1/2 and 1.2 are different places
        found[constant if constant not in found else f"{constant}_ROW_{len(found)}"] = None
    return list(found)


def _not_below(value: float, real: Real) -> float:
    """The smallest number not below a bound; the largest for an infinite one, which no program can write down."""
    largest = number_format(real).largest
    return real.not_below(rational(value)) if value <= largest else largest


def _contact(end: ContactEnd, real: Real) -> NamedContact:
    tau = real.nearest(rational(end.double))
    return NamedContact(str(end.x), c_literal(tau, real), literal(tau, real), end.digits)


def _model(model: Model) -> list[str]:
    kind, *choices = model.labels.system.items()
    lines = [
        f"{kind[1]}, all of it" if model.endless else f"{kind[1]}, as far as the light cone of the outputs reaches"
    ]
    lines += [f"{key} = {value}" for key, value in choices]
    for name, numbers in model.letters.items():
        if numbers:
            lines.append(", ".join(f"{name}_{index} = {value}" for index, value in numbers.items()))
    named = zip(model.labels.load_names, model.labels.loads, strict=True)
    lines += [f"{label}: {line}" for label, line in named if line]
    until = model.clock.format(model.until) if model.clock else model.until
    return [*lines, f"until = {until}, tolerance = {_tolerance(model)}"]


def _tolerance(model: Model) -> str:
    return literal(nearest(model.tolerance))
