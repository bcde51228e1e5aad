"""NAME_selftest.c: reference values, and how far from them an output may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

from flint import arb

from wavesym.numbers.doubles import bound
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.program import Program, ReferenceValues, SteppedValues, StreamedValues
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_literals

_ORIGINS = {"mode_sets": "of modes that are proved to leave out next to nothing"}
_LENIENT = 10  # times the error that is estimated, where no bound is proved: what is right comes nowhere near it


@dataclass(frozen=True)
class CSelfTest:
    """templates/c/selftest.c.j2: `expected` by output, then by tau; doubles whatever the program's type is.

    What takes parameters is `built` with the scene's own; names of its functions begin with `function`, and their
    arguments with `model`. `origin` says where reference values are from.
    """

    scene: Description
    count: str
    tables: dict[str, Lines]
    built: bool
    origin: str
    function: str
    model: str


@dataclass(frozen=True)
class CSteppedSelfTest:
    """templates/c/stepped_selftest.c.j2: `expected` by step, then by output; doubles whatever the program's type is.

    What takes parameters is `built` with the scene's own. Steps are `equal` where all have one length.
    """

    scene: Description
    count: str
    tables: dict[str, Lines]
    built: bool
    equal: bool


def selftest(scene: Description, program: Program, reference: ReferenceValues) -> str:
    """The program that holds the C of a program against reference values."""
    built = program.laws is not None
    # the reference is rounded once, and the largest value is too
    allowed = [
        (_LENIENT * output.bound if built else output.bound + 2.0**-52) * output.largest for output in program.outputs
    ]
    context = CSelfTest(
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
    return render("c/selftest.c.j2", context)


def stepped_selftest(scene: Description, program: Program, reference: StreamedValues | SteppedValues) -> str:
    """The program that holds a stream against reference values."""
    lengths: Sequence[float] = ()
    rows: Sequence[tuple[Sequence[float], Sequence[float]]]  # the loads of each step, and the outputs after it, or none
    if isinstance(reference, StreamedValues):
        rows = list(zip(reference.loads, zip(*reference.values, strict=True), strict=True))
        # the reference is rounded once; two digits are the same on every machine
        errors = zip(reference.errors, reference.values, strict=True)
        allowed = [bound(arb(error + 2.0**-52 * max(map(abs, row)))) for error, row in errors]
    else:
        lengths = [row.dtau for row in reference.rows]
        rows = [(row.loads, row.values) for row in reference.rows]
        found = zip(*(values for _, values in rows if values), strict=True)
        sizes = [max(map(abs, column), default=0.0) for column in found]
        least = 2 * program.constants["tolerance"]
        allowed = [
            max(_LENIENT * output.bound, least) * max(size, output.largest)
            for output, size in zip(program.outputs, sizes, strict=True)
        ]
    places = accumulate((len(values) for _, values in rows), initial=0)
    context = CSteppedSelfTest(
        scene=scene,
        count=str(len(rows)),
        tables={
            "dtau": c_literals(lengths, program.real),
            "loads": c_literals((load for loads, _ in rows for load in loads), program.real),
            "looked": c_literals((at if values else -1 for (_, values), at in zip(rows, places, strict=False)), DOUBLE),
            "expected": c_literals((value for _, values in rows for value in values), DOUBLE),
            "allowed": c_literals(allowed, DOUBLE),
        },
        built=program.laws is not None,
        equal=not lengths,
    )
    return render("c/stepped_selftest.c.j2", context)
