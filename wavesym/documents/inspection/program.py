"""The program that `generate` takes, and all that were tried for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section, finite
from wavesym.errors import CostError, ToleranceError, WavesymError
from wavesym.exact.contacts.events import contact_ends, events
from wavesym.exact.contacts.schedule import GrazingError
from wavesym.mechanics.model import Model
from wavesym.programs.choice import MAKERS, Attempt, attempt, attempts, best
from wavesym.programs.form import Form
from wavesym.programs.hats import HatMarch
from wavesym.programs.march.evaluator import March
from wavesym.programs.piece_grid import Pieces
from wavesym.programs.program import Program, Provenance
from wavesym.programs.request import Request
from wavesym.programs.stream.making import stream_program
from wavesym.programs.stream.plan import inputs_of

# To fit pieces whose tables are so large once more, in floats or the smallest ones, takes some seconds.
MOST_BYTES = 64 << 10
# Windows times operations of one: a march of so many takes some seconds.
MOST_MARCHED = 2e7

_NOT_TRIED = {
    "modes": "not tried: another program meets the tolerance",
    "march": "not tried: another program meets the tolerance, and trying a march takes as long as a run of all windows",
}
_DAMPED = "not tried: only modes serve damping"
_STREAM = Request(stream=True)


def program_sections(model: Model, sources: Sequence[str]) -> Iterator[Section]:
    """The program in numbers, or why there is none; and the stream of loads that have these `sources`."""
    tried = attempts(model)
    yield choice(model, tried)
    with suppress(ToleranceError):  # which is shown already
        found = best(model, tried)
        yield from _numbers(found.evaluator.program(Provenance(found.model, found.reason)))
    yield contacts(model)
    yield stream(model, sources)
    yield variants(model, tried)


def _numbers(made: Program) -> Iterator[Section]:
    lengths = [{"name": name, "length": len(table)} for name, table in made.tables.items()]
    yield Listing("tables", "Its tables, and how many numbers each has", lengths)
    yield Facts("constants", "Its single numbers", made.constants)
    yield Listing(
        "outputs",
        "Outputs: the proved bound of the error over the largest value, and what that value is at least",
        [{"name": each.name, "bound": finite(each.bound), "largest": finite(each.largest)} for each in made.outputs],
    )


def choice(model: Model, tried: Sequence[Attempt]) -> Facts:
    """What `auto` takes of what was tried."""
    try:
        found = best(model, tried)
    except ToleranceError as refusal:
        return Facts("program", "generate would refuse this scene", {"refusal": str(refusal)})
    form = found.evaluator
    values: dict[str, Plain] = {
        "kind": found.name,
        "precision": form.real.name,
        "tau_max": form.tau_max,
        "bound": form.error_bound,
        "degrees": _degrees(form),
        "bytes": form.bytes,
        "reason": found.reason,
    }
    return Facts("program", "The program that generate takes", values)


def contacts(model: Model) -> Listing:
    """When contacts open, as far as that matters; a scene whose ends are not known in time is refused for that."""
    if model.network.corners:
        return _happening(model)
    words = "Contacts whose opening can reach an output"
    try:
        rows = [{"x": end.x, "tau": end.digits, "refusal": Display(None, "")} for end in contact_ends(model)]
    except (CostError, GrazingError) as error:
        words = "When contacts open is not known in time, for which generate refuses the scene"
        return Listing("contacts", words, [{"x": None, "tau": None, "refusal": str(error)}], ("refusal",))
    return Listing("contacts", words, rows, ("refusal",))


def _happening(model: Model) -> Listing:
    """What contacts do that open and close."""
    words = "When contacts open and close, as far as that can reach an output"
    try:
        rows = [{"x": e.x, "kind": e.kind, "tau": e.digits, "refusal": Display(None, "")} for e in events(model)]
    except (CostError, GrazingError) as error:
        words = "When contacts open and close is not known in time, for which generate refuses the scene"
        return Listing("events", words, [{"x": None, "kind": None, "tau": None, "refusal": str(error)}], ("refusal",))
    return Listing("events", words, rows, ("refusal",))


def stream(model: Model, sources: Sequence[str]) -> Facts:
    """The stream that `generate --stream` makes of a model whose loads have these sources, or why there is none."""
    endless = replace(model, endless=True)
    try:
        made = stream_program(endless, _STREAM, inputs_of(endless, sources))
    except WavesymError as refusal:
        return Facts("stream", "As a stream, whose loads come while it runs, there is none", {"refusal": str(refusal)})
    numbers = made.constants
    waves, each = (
        made.real.bytes * int(numbers[count] * (numbers["degree"] + 1)) for count in ("slot_count", "entry_count")
    )
    direct = {
        output.name: [made.sources[j] for j in of] for output, of in zip(made.outputs, made.direct, strict=True) if of
    }
    return Facts(
        "stream",
        "As a stream (--stream), whose loads come while it runs; multiplications are counted with an addition each",
        {
            "inputs": list(made.sources),
            "direct": direct,
            "panel": numbers["panel"],
            "degree": numbers["degree"],
            "state_bytes": Display(waves, f"about {waves}"),
            "breakpoints": numbers["breakpoints"],
            "breakpoint_bytes": each,
            "bytes": made.bytes,
            "panel_work": numbers["operations"],
            "step_work": numbers["step_operations"],
        },
    )


def variants(model: Model, tried: Sequence[Attempt]) -> Listing:
    """What was `tried`, and its variants."""
    return Listing(
        "tried",
        "Programs tried: about how many operations a value takes (of a march: a window), and the bytes of the tables",
        list(_rows(model, tried)),
        ("refusal",),
    )


def _rows(model: Model, tried: Sequence[Attempt]) -> Iterator[dict[str, Plain]]:
    done = {one.kind: one for one in tried}
    for kind in MAKERS:
        if kind not in done:
            yield _row(Attempt(kind, None, _DAMPED if model.damping else _NOT_TRIED[kind]), "double", "speed")
            continue
        yield _row(first := done[kind], "double", "speed")
        if first.form is None:
            continue
        if dear := _dear(first.form):
            yield _row(Attempt(kind, None, dear), "single", "speed")
            continue
        yield from _smaller(model, first, "double")
        single = attempt(model, kind, "single", optimize="speed")
        yield _row(single, "single", "speed")
        yield from _smaller(model, single, "single")


def _smaller(model: Model, usual: Attempt, precision: str) -> Iterator[dict[str, Plain]]:
    """The program for the aim "size", where it is another one; only pieces have any."""
    if isinstance(usual.form, Pieces) and not usual.refusal:
        small = attempt(model, usual.kind, precision, optimize="size")
        if small.form is None or small.form.bytes != usual.form.bytes:
            yield _row(small, precision, "size")


def _dear(form: Form) -> str:
    """Why its variants are not tried; empty where they are."""
    if isinstance(form, Pieces) and form.bytes > MOST_BYTES:
        return (
            f"not tried, nor the smallest tables: to fit {form.bytes} bytes once more takes long; the limit is "
            f"{MOST_BYTES}"
        )
    if isinstance(form, (March, HatMarch)) and (marched := form.total_work) > MOST_MARCHED:
        return f"not tried: a march would take {marched:.1e} operations; the limit is {MOST_MARCHED:.1e}"
    return ""


def _degrees(form: Form) -> Display | None:
    """The lowest and the highest degree of its polynomials; a closed form has none, nor have modes."""
    match form:
        case Pieces():
            low, high = form.degrees
            return Display([low, high], f"{low}..{high}")
        case March() | HatMarch():
            return Display([form.degree, form.degree], str(form.degree))
        case _:
            return None


def _row(one: Attempt, precision: str, optimize: str) -> dict[str, Plain]:
    form = one.form
    return {
        "program": one.kind,
        "precision": precision,
        "optimize": optimize,
        "bound": finite(form.error_bound) if form else None,
        "work": Display(form.work, f"{form.work:.0f}") if form else None,
        "bytes": form.bytes if form else None,
        "degrees": _degrees(form) if form else None,
        "refusal": one.refusal or Display(None, ""),
    }
