"""Parameters at run time as C: NAME.h, NAME.c and NAME_selftest.c of a march that is built when they are known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from flint import fmpq, fmpq_mpoly

from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.program import Program, ReferenceValues
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.products import products
from wavesym.programs.runtime.units import Function, ParameterUnit
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_constants, c_literal, c_literals, c_tables

_SIZES = ("windows", "strands", "degree", "panels", "nodes", "forces", "heard", "events", "lanes", "groups")
LIMITS = {"double": "DBL", "single": "FLT"}


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
    """templates/c/runtime/runtime.h.j2."""

    scene: Description
    fields: tuple[CRuntimeField, ...]
    sizes: tuple[tuple[str, str], ...]
    model: str
    batch: str


@dataclass(frozen=True)
class CRuntime:
    """templates/c/runtime/runtime.c.j2; `laws` are what is assigned, with the expression; every table as its lines.

    `products` are what is multiplied and added up on the way to them, `slope_products` to their derivatives. `slopes`
    are these, by the number of a parameter; `load_lane` is that of the first load, -1 for none.
    """

    scene: Description
    fields: tuple[CRuntimeField, ...]
    products: Lines
    laws: tuple[tuple[str, str], ...]
    slope_products: Lines
    slopes: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]
    load_lane: str
    tables: dict[str, Lines]
    constants: dict[str, str]
    amplitudes: Lines
    largest: str
    least: str
    loads: str
    series: str
    numbers: str
    kernel: str
    read: str
    bound: str
    batch: str
    misfit: str


@dataclass(frozen=True)
class CRuntimeSelfTest:
    """templates/c/runtime/selftest.c.j2: `expected` by output, then by tau."""

    scene: Description
    count: str
    tables: dict[str, Lines]


def files(scene: Description, program: Program) -> dict[str, str]:
    """The files of a program, by name."""
    laws = program.laws
    assert laws is not None
    fields = tuple(parameter_fields(laws, program.real))
    constants = c_constants(program.constants, program.real)
    own = not any(field.name == "load" for field in fields)
    header = CRuntimeHeader(
        scene=scene,
        fields=fields,
        sizes=tuple((name.upper(), constants[name]) for name in _SIZES),
        model=kernel("runtime/model.h", scene),
        batch=kernels(scene, "runtime/wide.h", "runtime/batch.h", "runtime/data.h"),
    )
    context = CRuntime(
        scene=scene,
        fields=fields,
        products=multiplied(laws, laws.every, program.real),
        laws=tuple(assigned(laws, laws.functions, program.real)),
        slope_products=multiplied(laws, laws.every_slope, program.real),
        slopes=tuple(slopes(laws, program.real)),
        largest=f"{LIMITS[program.real.name]}_MAX",
        least=f"{LIMITS[program.real.name]}_MIN",
        load_lane=load_lane(laws),
        tables=c_tables(program.tables, program.real),
        constants=constants,
        amplitudes=c_literals(laws.amplitudes, program.real) if own else (),
        loads="amplitude" if own else "p->load",
        series=kernel("runtime/series.c", scene),
        numbers=kernel("real.h", scene),
        kernel=kernels(scene, "runtime/runtime.c", "runtime/builds.c"),
        read=kernel("runtime/read.c", scene),
        bound=kernels(scene, "runtime/wrong.c", "runtime/bound.c", "runtime/bounds.c"),
        batch=kernels(scene, "runtime/lanes.c", "runtime/batch.c", "runtime/batches.c"),
        misfit=kernel("runtime/misfit.c", scene),
    )
    made = {
        f"{scene.name}.h": render("c/runtime/runtime.h.j2", header),
        f"{scene.name}.c": render("c/runtime/runtime.c.j2", context),
    }
    if isinstance(program.reference, ReferenceValues):
        made[f"{scene.name}_selftest.c"] = runtime_selftest(scene, program, program.reference)
    return made


def sets(scene: Description, program: Program) -> dict[str, str]:
    """The files, with what runs many sets of parameters in NAME.c."""
    made = files(scene, program)
    name = f"{scene.name}.c"
    more = kernels(scene, "runtime/peaks.c", "runtime/sets.c", "runtime/sets_batch.c", "runtime/sets_bounds.c")
    return made | {name: f"{made[name]}\n{more}\n"}


def runtime_selftest(scene: Description, program: Program, reference: ReferenceValues) -> str:
    """What compares values of the scene's own parameters with reference values."""
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
    return render("c/runtime/selftest.c.j2", context)


def parameter_fields(laws: RuntimeLaws, real: Real) -> Iterator[CRuntimeField]:
    """The fields of the parameters, as C tells them."""
    for field in laws.fields:
        yield CRuntimeField(
            name=field.name,
            constant=field.name.upper(),
            count=str(len(field.values)),
            check="positive_number" if field.positive else "finite_number",
            labels=tuple(map(_told, field.told, field.units)),
            values=c_literals(map(real.nearest, field.values), real),
        )


def _told(label: str, unit: ParameterUnit) -> str:
    return f"{label} [{unit.text}]" if unit.text else label


def assigned(laws: RuntimeLaws, arrays: Mapping[str, Sequence[Function]], real: Real) -> Iterator[tuple[str, str]]:
    """What is assigned, with the expression."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    for array, functions in arrays.items():
        for k, function in enumerate(functions):
            yield f"{array}[{k}]", expression(function, places, real)


def multiplied(laws: RuntimeLaws, functions: Iterable[Ratio], real: Real) -> Lines:
    """What is multiplied and added up on the way to some functions, each once."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    found = (
        " * ".join(_sum(factor, [places[name] for name in function.ring.names], real) for factor in product)
        for function in functions
        for product in products(function, laws.positive)
    )
    return tuple(dict.fromkeys(found))


def slopes(laws: RuntimeLaws, real: Real) -> Iterator[tuple[str, tuple[tuple[str, str], ...]]]:
    """The derivatives that are not 0, by the number of the parameter."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    for lane, found in groupby(laws.slopes, key=lambda slope: slope[0]):
        yield str(lane), tuple((f"{array}[{k}]", expression(slope, places, real)) for _, array, k, slope in found)


def load_lane(laws: RuntimeLaws) -> str:
    """The number of the first load among all parameters, -1 where loads are none."""
    before = 0
    for field in laws.fields:
        if field.name == "load":
            return str(before)
        before += len(field.values)
    return "-1"


def expression(function: Function, places: Mapping[str, str], real: Real) -> str:
    """A rational function in C, with `places` for its symbols; one product over another, sums multiplied out."""
    if not isinstance(function, Ratio):
        return c_literal(real.nearest(function), real)
    names = [places[name] for name in function.ring.names]
    above = _sum(function.numerator, names, real)
    below = [
        factor
        for form, power in sorted(function.denominator.items())
        for factor in [_sum(function.ring.forms[form], names, real)] * power
    ]
    return f"{above} / ({' * '.join(below)})" if below else above


def _sum(polynomial: fmpq_mpoly, names: list[str], real: Real) -> str:
    terms = [_term(fmpq(value), powers, names, real) for powers, value in polynomial.to_dict().items()]
    return terms[0] if len(terms) == 1 else f"({' + '.join(terms)})" if terms else c_literal(0.0, real)


def _term(value: fmpq, powers: tuple[int, ...], names: list[str], real: Real) -> str:
    factors = [name for name, power in zip(names, powers, strict=True) for _ in range(int(power))]
    if value == -1 and factors:
        return f"-{' * '.join(factors)}"
    return " * ".join(([] if value == 1 and factors else [c_literal(real.nearest(value), real)]) + factors)
