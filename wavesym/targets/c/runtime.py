"""Parameters at run time as C: NAME.h, NAME.c and NAME_selftest.c of a march that is built when they are known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mpoly

from wavesym.numbers.doubles import nearest
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.program import Program, ReferenceValues
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.plan import Function
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_constants, c_literal, c_literals, c_tables

_SIZES = ("windows", "strands", "degree", "panels", "nodes", "forces", "heard", "events", "lanes")


@dataclass(frozen=True)
class CRuntimeField:
    """A field of the parameters: what its numbers are called, and what they are in the scene."""

    name: str
    constant: str
    count: str
    check: str
    labels: tuple[str, ...]
    values: Lines


@dataclass(frozen=True)
class CRuntimeHeader:
    """templates/c/runtime.h.j2."""

    scene: Description
    fields: tuple[CRuntimeField, ...]
    sizes: tuple[tuple[str, str], ...]
    model: str


@dataclass(frozen=True)
class CRuntime:
    """templates/c/runtime.c.j2; `laws` are what is assigned, with the expression; every table as its lines.

    `slopes` are their derivatives, by the number of a parameter; `load_lane` is that of the first load, -1 for none.
    """

    scene: Description
    fields: tuple[CRuntimeField, ...]
    laws: tuple[tuple[str, str], ...]
    slopes: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]
    load_lane: str
    tables: dict[str, Lines]
    constants: dict[str, str]
    amplitudes: Lines
    loads: str
    numbers: str
    kernel: str


@dataclass(frozen=True)
class CRuntimeSelfTest:
    """templates/c/runtime_selftest.c.j2: `expected` by output, then by tau."""

    scene: Description
    count: str
    tables: dict[str, Lines]


def files(scene: Description, program: Program) -> dict[str, str]:
    """The files of a program, by name."""
    laws = program.laws
    assert laws is not None
    fields = tuple(_fields(laws))
    constants = c_constants(program.constants, program.real)
    own = not any(field.name == "load" for field in fields)
    header = CRuntimeHeader(
        scene=scene,
        fields=fields,
        sizes=tuple((name.upper(), constants[name]) for name in _SIZES),
        model=kernel("runtime_model.h", scene),
    )
    context = CRuntime(
        scene=scene,
        fields=fields,
        laws=tuple(_assigned(laws, laws.functions)),
        slopes=tuple(_slopes(laws)),
        load_lane=_load_lane(laws),
        tables=c_tables(program.tables, program.real),
        constants=constants,
        amplitudes=c_literals(laws.amplitudes, program.real) if own else (),
        loads="amplitude" if own else "p->load",
        numbers=kernel("real.h", scene),
        kernel=kernel("runtime.c", scene),
    )
    made = {
        f"{scene.name}.h": render("c/runtime.h.j2", header),
        f"{scene.name}.c": render("c/runtime.c.j2", context),
    }
    if isinstance(program.reference, ReferenceValues):
        made[f"{scene.name}_selftest.c"] = _selftest(scene, program, program.reference)
    return made


def sets(scene: Description, program: Program) -> dict[str, str]:
    """The files, with what runs many sets of parameters in NAME.c."""
    made = files(scene, program)
    name = f"{scene.name}.c"
    return made | {name: f"{made[name]}\n{kernel('runtime_sets.c', scene)}\n"}


def _selftest(scene: Description, program: Program, reference: ReferenceValues) -> str:
    # errors are estimated: ten times the tolerance is what no program that is right comes near to
    allowed = [10 * output.bound * output.largest for output in program.outputs]
    context = CRuntimeSelfTest(
        scene=scene,
        count=str(len(reference.taus)),
        tables={
            "taus": c_literals(reference.taus, program.real),
            "expected": c_literals((value for row in reference.values for value in row), DOUBLE),
            "allowed": c_literals(allowed, DOUBLE),
        },
    )
    return render("c/runtime_selftest.c.j2", context)


def _fields(laws: RuntimeLaws) -> Iterator[CRuntimeField]:
    for field in laws.fields:
        yield CRuntimeField(
            name=field.name,
            constant=field.name.upper(),
            count=str(len(field.values)),
            check="positive_number" if field.positive else "finite_number",
            labels=field.labels,
            values=c_literals(map(nearest, field.values), DOUBLE),
        )


def _assigned(laws: RuntimeLaws, arrays: Mapping[str, Sequence[Function]]) -> Iterator[tuple[str, str]]:
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    for array, functions in arrays.items():
        for k, function in enumerate(functions):
            yield f"{array}[{k}]", expression(function, places)


def _slopes(laws: RuntimeLaws) -> Iterator[tuple[str, tuple[tuple[str, str], ...]]]:
    """The derivatives that are not 0, by the number of the parameter."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    for lane, label in enumerate(places):
        found = [
            (f"{array}[{k}]", expression(slope, places))
            for array, functions in laws.functions.items()
            for k, function in enumerate(functions)
            if isinstance(function, Ratio) and label in function.ring.names
            for slope in [function.derivative(label)]
            if slope != 0
        ]
        if found:
            yield str(lane), tuple(found)


def _load_lane(laws: RuntimeLaws) -> str:
    before = 0
    for field in laws.fields:
        if field.name == "load":
            return str(before)
        before += len(field.values)
    return "-1"


def expression(function: Function, places: Mapping[str, str]) -> str:
    """A rational function in C, with `places` for its symbols; one product over another, sums multiplied out."""
    if not isinstance(function, Ratio):
        return c_literal(nearest(function), DOUBLE)
    names = [places[name] for name in function.ring.names]
    above = _sum(function.numerator, names)
    below = [
        factor
        for form, power in sorted(function.denominator.items())
        for factor in [_sum(function.ring.forms[form], names)] * power
    ]
    return f"{above} / ({' * '.join(below)})" if below else above


def _sum(polynomial: fmpq_mpoly, names: list[str]) -> str:
    terms = [_term(fmpq(value), powers, names) for powers, value in polynomial.to_dict().items()]
    return terms[0] if len(terms) == 1 else f"({' + '.join(terms)})" if terms else "0.0"


def _term(value: fmpq, powers: tuple[int, ...], names: list[str]) -> str:
    factors = [name for name, power in zip(names, powers, strict=True) for _ in range(int(power))]
    if value == -1 and factors:
        return f"-{' * '.join(factors)}"
    return " * ".join(([] if value == 1 and factors else [c_literal(nearest(value), DOUBLE)]) + factors)
