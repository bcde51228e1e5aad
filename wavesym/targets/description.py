"""What every generated file says of itself: the scene it was made from and what was proved for it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from textwrap import wrap

from flint import fmpq

from wavesym.exact.contact import ContactEnd
from wavesym.model.chain import chain
from wavesym.model.light_cone import felt
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.choice import Evaluator
from wavesym.scene import Building, Record, Scene
from wavesym.scene.loads import Load
from wavesym.targets.literals import c_literal, literal
from wavesym.targets.number_format import number_format
from wavesym.targets.reference import ReferenceValues

_WIDTH = 110
_LONG = 4 * _WIDTH  # characters of a load that is written out


@dataclass(frozen=True)
class NamedOutput:
    """An output's name, as text and as a constant, and its proved bound, relative to its largest value."""

    name: str
    constant: str
    bound: str


@dataclass(frozen=True)
class NamedContact:
    """The end of a contact: its place for identifiers, tau as a literal of C and of Python, and with 20 digits."""

    position: str
    c_tau: str
    tau: str
    digits: str


@dataclass(frozen=True)
class Description:
    """Strings for the templates. `prefix` is the name in capitals, `model` the scene in lines of text.

    `name_size` is what the longest name of an output takes in C; `command` makes the same file again.
    `real` and `numpy_real` are the type of all values in C and in NumPy; numbers that C reads have its suffix.
    `reference` is what a self-test compares with, None where there is to be none.
    """

    name: str
    prefix: str
    command: str
    model: tuple[str, ...]
    real: str
    numpy_real: str
    reason: str
    tolerance: str
    outputs: tuple[NamedOutput, ...]
    output_count: str
    name_size: str
    tau_max: str
    c_tau_max: str
    error_bound: str
    c_error_bound: str
    contacts: tuple[NamedContact, ...]
    reference: ReferenceValues | None = None


def describe(
    scene: Scene,
    evaluator: Evaluator,
    reason: str,
    contacts: Sequence[ContactEnd],
    options: str = "",
    reference: ReferenceValues | None = None,
) -> Description:
    """The description of a scene and of the evaluator chosen for it; `options` are those that the files depend on."""
    real = evaluator.real
    called = number_format(real)
    names = [output.name for output in evaluator.outputs]
    bound = _not_below(evaluator.error_bound, real)
    return Description(
        name=scene.name,
        prefix=scene.name.upper(),
        command=f"wavesym generate {scene.name}.toml{options}",
        model=tuple(line for part in _model(scene) for line in wrap(part, _WIDTH, subsequent_indent="  ")),
        real=called.c_type,
        numpy_real=called.numpy_type,
        reason=reason,
        tolerance=_tolerance(scene),
        outputs=tuple(
            NamedOutput(output.name, constant, literal(_not_below(output.bound, DOUBLE)))
            for output, constant in zip(evaluator.outputs, constants(names), strict=True)
        ),
        output_count=str(len(names)),
        name_size=str(max(map(len, names)) + 1),
        tau_max=literal(evaluator.tau_max),  # a double in Python: the shortest text of a float may lie below it
        c_tau_max=c_literal(evaluator.tau_max, real),
        error_bound=literal(bound, real),
        c_error_bound=c_literal(bound, real),
        contacts=tuple(_contact(end, real) for end in contacts),
        reference=reference,
    )


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


def parameters(scene: Scene) -> dict[str, dict[int, fmpq]]:
    """The parameters that can matter to an output within the horizon, by name and index."""
    return felt(chain(scene), scene.outputs, scene.output.until)


def _model(scene: Scene) -> list[str]:
    parts = scene.system
    lines = [f"{parts.type}, as far as the light cone of the outputs reaches"]
    if isinstance(parts, Building):
        lines.append(f"base = {parts.base}")
    for name, numbers in parameters(scene).items():
        if numbers:
            lines.append(", ".join(f"{name}_{index} = {value}" for index, value in numbers.items()))
    lines += [line for number, load in enumerate(scene.load) if (line := _load(load, number))]
    return [*lines, f"until = {scene.output.until}, tolerance = {_tolerance(scene)}"]


def _load(load: Load, number: int) -> str:
    """A load in one line, and a long one by its size."""
    if isinstance(load, Record):
        last = (len(load.samples) - 1) * load.spacing
        return f"load {number}: {len(load.samples)} samples at {load.spacing}, to tau = {last}"
    told = ", ".join(f"{piece.weight} {piece.source} at {piece.time}" for piece in load.pieces() if piece.weight)
    if len(told) > _LONG:
        return f"load {number}: {len(load.times)} changes from tau = {load.times[0]} to {load.times[-1]}"
    return f"load {number}: {told}" * bool(told)


def _tolerance(scene: Scene) -> str:
    return literal(nearest(rational(Fraction(scene.output.tolerance))))
