"""Parameters at run time as C: NAME.h, NAME.c and NAME_selftest.c of a march that is built when they are known."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby

from flint import fmpq, fmpq_mpoly

from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import Real
from wavesym.programs.program import Program
from wavesym.programs.runtime.laws import Function, RuntimeLaws, products
from wavesym.programs.runtime.network import ParameterUnit
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.memory import Memory
from wavesym.targets.c.selftest import selftests
from wavesym.targets.c.tables import program_tables, sizes
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_literal, c_literals

_MODEL, _READ, _LANES = (f"runtime/{name}.c" for name in ("model", "read", "lanes"))
"""Models of one set, and what stands below them: what reads them, and where many march in lanes."""
_OF_PARTS = {"peaks": "runtime/peaks.c", "gradients": "runtime/tangents.c", "bound": "runtime/bound.c"}
"""What reads models besides."""
_DECLARED = {"peaks": "peaks", "gradients": "gradients", "batch": "batches", "misfit": "misfits", "bound": "bounds"}
"""What headers declare besides models."""
_SETS = {"misfit": "sets.c", "gradients": "sets_tangents.c", "bound": "sets_bounds.c"}
_MOST_ON_STACK = 1 << 16
"""Bytes of work that `build` puts there: more is kept in the model."""
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


def files(scene: Description, program: Program) -> dict[str, str]:
    """The C of a program whose parameters come at run time.

    Its work space is in models where it is too large for a stack.

    Args:
        scene: what headers say of it, and its name, the prefix of all.
        program: with laws, functions of the parameters.

    Returns:
        NAME.h, NAME.c and NAME_selftest.c, the texts by name of the file.
    """
    assert program.laws is not None
    fields = tuple(parameter_fields(program.laws, program.real))
    structs = partial(
        render,
        "c/runtime/structs.h.j2",
        scene=scene,
        sizes=tuple(sizes("runtime/tables.h", program)),
        fields=fields,
        work="\n\n".join((kernel("runtime/wide.h", scene), _one_set(scene), kernel("runtime/work.h", scene))),
        model=kernel("runtime/model.h", scene),
        others=tuple(
            kernels(scene, *files)
            for part, files in (
                ("gradients", ("runtime/tangent.h",)),
                ("batch", ("runtime/batch.h",)),
                ("misfit", ("runtime/data.h",)),
            )
            if part in program.parts
        ),
    )
    memory = Memory(scene.name, program.real.bytes, len(program.outputs))
    memory.read(structs(inside=False))
    inside = memory.size(f"{scene.name}_work") > _MOST_ON_STACK
    text = structs(inside=inside)
    memory.read(text)
    source = _source(scene, program, fields, inside=inside)
    memory.read(source)
    declared = (name for part, name in _DECLARED.items() if part in program.parts)
    header = render(
        "c/runtime/runtime.h.j2",
        scene=scene,
        declared="\n\n".join(kernel(f"runtime/{name}.h", scene) for name in ("models", *declared)),
        memory=tuple(_struct_sizes(scene, program.parts, memory, inside)),
        stack=tuple(_stack_sizes(scene, program.parts, memory, inside)),
        structs=text,
    )
    return {f"{scene.name}.h": header, f"{scene.name}.c": source, **selftests(scene, program)}


def _one_set(scene: Description) -> str:
    """What templates/c/runtime/set.h declares, for one set of parameters."""
    text = re.sub(r"\bnum\b", scene.real, kernel("runtime/set.h", scene))
    return re.sub(r"\bOF\((\w+)\)", rf"{scene.name}_\1", text)


def _source(scene: Description, program: Program, fields: Sequence[CRuntimeField], *, inside: bool) -> str:
    """NAME.c.

    `laws` are what is assigned, with the expression, `products` what is multiplied and added up on the way to them,
    `slopes` derivatives by the number of a parameter. Plain C is the `kernel`, which builds models, what is `read` of
    them, and with batches `lanes` and `batch`. `arrays` are the laws with how many numbers each has.
    """
    laws, real, parts = program.laws, program.real, program.parts
    assert laws is not None
    own = not any(field.name == "load" for field in laws.fields)
    derived, bounded = "gradients" in program.parts, "bound" in program.parts
    largest, least = (f"{LIMITS[real.name]}_{name}" for name in ("MAX", "MIN"))
    known = replace(program, tables=program.tables | ({"amplitude": laws.amplitudes} if own else {}))
    unneeded = () if bounded else ("roundings",)
    known = replace(known, constants={name: of for name, of in program.constants.items() if name not in unneeded})
    length, unit = (c_literal(program.constants[name], real) for name in ("step", "unit"))
    constants = {
        "load_lane": load_lane(laws),
        "largest_number": largest,
        "faint": f"{least} / {unit}",
        "window_length": length,
        **({"least_number": least} if bounded else {}),
    }
    # what energies are made of only bounds need
    needed = {
        name: functions for name, functions in laws.functions.items() if bounded or name not in ("weight", "impedance")
    }
    return render(
        "c/runtime/runtime.c.j2",
        scene=scene,
        parts=program.parts,
        inside=inside,
        fields=fields,
        products=product_lines(laws, laws.every, real),
        laws=(*assignments(laws, needed, real), ("load", "amplitude" if own else "p->load")),
        slope_products=product_lines(laws, (slope for *_, slope in laws.slopes), real) if derived else (),
        slopes=tuple(slopes(laws, needed, real)) if derived else (),
        tables=program_tables("runtime/tables.h", scene, known, constants),
        largest=largest,
        least=least,
        numbers=kernels(scene, "real.h", "vectors.h"),
        kernel=kernels(scene, _MODEL),
        read=kernels(scene, _READ, *(_OF_PARTS[part] for part in parts if part in _OF_PARTS), above=(_MODEL,)),
        lanes=kernel(_LANES, scene),
        batch=kernels(scene, _batch(parts), above=(_LANES,)),
        arrays=tuple((name, str(len(functions))) for name, functions in needed.items()),
    )


def _batch(parts: Sequence[str]) -> str:
    """What is of many sets side by side."""
    return f"runtime/{'misfit' if 'misfit' in parts else 'batch'}.c"


def _struct_sizes(scene: Description, parts: Sequence[str], memory: Memory, inside: bool) -> Iterator[tuple[str, str]]:
    """The size of each struct, and what it is."""
    where = "kept in a model: it is too much for a stack" if inside else "`build` has it on its stack"
    for struct, part, description in (
        ("model", "", "of each set of parameters that is kept"),
        ("work", "", f"while one is built; {where}"),
        ("tangent", "gradients", "with all that it needs while it is built"),
        ("batch", "batch", "with all that it needs while it is built"),
        ("data", "misfit", "and besides as many numbers as data_size says"),
    ):
        if not part or part in parts:
            yield str(memory.size(f"{scene.name}_{struct}")), f"{scene.name}_{struct}, {description}"


def _stack_sizes(scene: Description, parts: Sequence[str], memory: Memory, inside: bool) -> Iterator[tuple[str, str]]:
    """What functions need of a stack, at most."""

    def stack(file: str, num: str = "real") -> int:
        return memory.stack(kernels(scene, file, above=(_MODEL,)), num=num)

    building = stack(_MODEL)
    work = 0 if inside else memory.size(f"{scene.name}_work")
    yield str(building + work), "build"
    yield str(building), "build_with"
    yield str(stack(_READ)), "error_estimate, model_eval, model_sample"
    if "peaks" in parts:
        yield str(stack(_OF_PARTS["peaks"])), "model_peaks"
    if "gradients" in parts:
        yield str(building + stack(_OF_PARTS["gradients"])), "functions of a tangent"
    if "batch" in parts:
        description = "functions of a batch and of data" if "misfit" in parts else "functions of a batch"
        yield str(building + stack(_batch(parts), num="wide")), description
    if "bound" in parts:
        bounded = building + stack(_OF_PARTS["bound"])
        yield str(bounded + work), "error_bound"
        yield str(bounded), "error_bound_with"


def sets(scene: Description, program: Program) -> dict[str, str]:
    """The files, with what of each part runs many sets of parameters in NAME.c; values and peaks go with misfits."""
    made = files(scene, program)
    name = f"{scene.name}.c"
    more = "\n\n".join(kernel(f"runtime/{file}", scene) for part, file in _SETS.items() if part in program.parts)
    return {**made, name: f"{made[name]}\n{more}\n"}


def parameter_fields(laws: RuntimeLaws, real: Real) -> Iterator[CRuntimeField]:
    """The fields of the parameters, as C tells them."""
    for field in laws.fields:
        yield CRuntimeField(
            name=field.name,
            constant=field.name.upper(),
            count=str(len(field.values)),
            check="positive_number" if field.positive else "finite_number",
            labels=tuple(map(_describe, field.captions, field.units)),
            values=c_literals(map(real.nearest, field.values), real),
        )


def _describe(label: str, unit: ParameterUnit) -> str:
    return f"{label} [{unit.text}]" if unit.text else label


def assignments(laws: RuntimeLaws, arrays: Mapping[str, Sequence[Function]], real: Real) -> Iterator[tuple[str, str]]:
    """What is assigned, with the expression."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    for array, functions in arrays.items():
        for k, function in enumerate(functions):
            yield f"{array}[{k}]", expression(function, places, real)


def product_lines(laws: RuntimeLaws, functions: Iterable[Ratio], real: Real) -> Lines:
    """What is multiplied and added up on the way to some functions, each once."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    found = (
        " * ".join(_sum(factor, [places[name] for name in function.ring.names], real) for factor in product)
        for function in functions
        for product in products(function, laws.positive)
    )
    return tuple(dict.fromkeys(found))


def slopes(laws: RuntimeLaws, arrays: Container[str], real: Real) -> Iterator[tuple[str, tuple[tuple[str, str], ...]]]:
    """The derivatives that are not 0, by the number of the parameter."""
    places = {label: f"p->{name}[{k}]" for label, (name, k) in laws.places.items()}
    for lane, found in groupby((slope for slope in laws.slopes if slope[1] in arrays), key=lambda slope: slope[0]):
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
