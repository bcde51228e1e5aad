"""NAME_selftest.c: reference values, and how far from them an output may be."""

from __future__ import annotations

from itertools import accumulate

from flint import arb

from wavesym.numbers.doubles import bound
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.program import Program, ReferenceValues, SteppedValues
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literals

_ORIGINS = {"mode_sets": "of modes that are proved to leave out next to nothing"}
_LENIENT = 10  # times the error that is estimated, where no bound is proved: what is right comes nowhere near it


def selftests(scene: Description, program: Program) -> dict[str, str]:
    """NAME_selftest.c where a program has reference values, step by step for a stream; nothing where it has none."""
    match program.reference:
        case ReferenceValues():
            return {f"{scene.name}_selftest.c": _selftest(scene, program, program.reference)}
        case SteppedValues():
            return {f"{scene.name}_selftest.c": _stepped_selftest(scene, program, program.reference)}
    return {}


def _selftest(scene: Description, program: Program, reference: ReferenceValues) -> str:
    """The program that holds the C of a program against reference values: doubles whatever the program's type is.

    What takes parameters is `built` with the scene's own.
    """
    built = program.laws is not None
    # the reference is rounded once, and the largest value is too
    allowed = [
        (_LENIENT * output.bound if built else output.bound + 2.0**-52) * output.largest for output in program.outputs
    ]
    return render(
        "c/selftest.c.j2",
        scene=scene,
        count=str(len(reference.taus)),
        tables={
            "taus": c_literals(reference.taus, program.real),
            "expected": c_literals((value for row in reference.values for value in row), DOUBLE),
            "allowed": c_literals(allowed, DOUBLE),
        },
        built=built,
        origin=_ORIGINS.get(program.kernel, "computed in ball arithmetic and rounded once"),
        function=f"{scene.name}_model_" if built else f"{scene.name}_",
        model="&model, " if built else "",
    )


def _stepped_selftest(scene: Description, program: Program, reference: SteppedValues) -> str:
    """The same of a stream, step by step."""
    rows, equal = reference.rows, program.has_equal_steps
    sizes = [
        max(map(abs, column), default=0.0) for column in zip(*(row.values for row in rows if row.values), strict=True)
    ]
    if reference.errors:
        # the reference is rounded once; two digits are the same on every machine
        pairs = zip(reference.errors, sizes, strict=True)
        allowed = [bound(arb(error + 2.0**-52 * size)) for error, size in pairs]
    else:
        least = 2 * program.constants["tolerance"]
        allowed = [
            max(_LENIENT * output.bound, least) * max(size, output.largest)
            for output, size in zip(program.outputs, sizes, strict=True)
        ]
    places = accumulate((len(row.values) for row in rows), initial=0)
    return render(
        "c/stepped_selftest.c.j2",
        scene=scene,
        count=str(len(rows)),
        tables={
            "dtau": c_literals(() if equal else [row.dtau for row in rows], program.real),
            "loads": c_literals((load for row in rows for load in row.loads), program.real),
            "looked": c_literals((at if row.values else -1 for row, at in zip(rows, places, strict=False)), DOUBLE),
            "expected": c_literals((value for row in rows for value in row.values), DOUBLE),
            "allowed": c_literals(allowed, DOUBLE),
        },
        built=program.laws is not None,
        equal=equal,
        origin=_ORIGINS.get(program.kernel, ""),
    )
