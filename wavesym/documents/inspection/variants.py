"""Every program that was tried, in both precisions and for both aims as far as that takes no minutes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wavesym.documents.inspection.section import Listing, Plain, Told, finite
from wavesym.mechanics.model import Model
from wavesym.programs.choice import MAKERS, Made, Tried, attempt
from wavesym.programs.closed import ClosedForm
from wavesym.programs.hats.evaluator import HatMarch
from wavesym.programs.march.evaluator import March
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.programs.piece_grid import Pieces

# To fit pieces whose tables are so large once more, in floats or the smallest ones, takes some seconds.
MOST_BYTES = 64 << 10
# Windows times operations of one: a march of so many takes some seconds.
MOST_MARCHED = 2e7

_NOT_TRIED = {
    "modes": "not tried: another program meets the tolerance",
    "march": "not tried: another program meets the tolerance, and trying a march takes as long as a run of all windows",
}
_DAMPED = "not tried: only modes serve damping"


def variants(model: Model, tried: Sequence[Tried]) -> Listing:
    """What was `tried`, and its variants."""
    return Listing(
        "tried",
        "Programs tried: about how many operations a value takes (of a march: a window), and the bytes of the tables",
        list(_rows(model, tried)),
        ("refusal",),
    )


def _rows(model: Model, tried: Sequence[Tried]) -> Iterator[dict[str, Plain]]:
    done = {one.kind: one for one in tried}
    for kind in MAKERS:
        if kind not in done:
            yield _row(Tried(kind, None, _DAMPED if model.damping else _NOT_TRIED[kind]), "double", "speed")
            continue
        yield _row(first := done[kind], "double", "speed")
        if first.form is None:
            continue
        if dear := _dear(first.form):
            yield _row(Tried(kind, None, dear), "single", "speed")
            continue
        yield from _smaller(model, first, "double")
        single = attempt(model, kind, "single", optimize="speed")
        yield _row(single, "single", "speed")
        yield from _smaller(model, single, "single")


def _smaller(model: Model, usual: Tried, precision: str) -> Iterator[dict[str, Plain]]:
    """The program for the aim "size", where it is another one; only pieces have any."""
    if isinstance(usual.form, Pieces) and not usual.refusal:
        small = attempt(model, usual.kind, precision, optimize="size")
        if small.form is None or small.form.bytes != usual.form.bytes:
            yield _row(small, precision, "size")


def _dear(form: Made) -> str:
    """Why its variants are not tried; empty where they are."""
    if isinstance(form, Pieces) and form.bytes > MOST_BYTES:
        return (
            f"not tried, nor the smallest tables: to fit {form.bytes} bytes once more takes long; the limit is "
            f"{MOST_BYTES}"
        )
    if isinstance(form, (March, HatMarch)) and (marched := form.total_work) > MOST_MARCHED:
        return f"not tried: a march would take {marched:.1e} operations; the limit is {MOST_MARCHED:.1e}"
    return ""


def told_degrees(form: Made) -> Told | None:
    """The lowest and the highest degree of its polynomials; a closed form has none, nor have modes."""
    match form:
        case ClosedForm() | ModesEvaluator():
            return None
        case Pieces():
            low, high = form.degrees
            return Told([low, high], f"{low}..{high}")
        case March() | HatMarch():
            return Told([form.degree, form.degree], str(form.degree))


def _row(one: Tried, precision: str, optimize: str) -> dict[str, Plain]:
    form = one.form
    return {
        "program": one.kind,
        "precision": precision,
        "optimize": optimize,
        "bound": finite(form.error_bound) if form else None,
        "work": Told(form.work, f"{form.work:.0f}") if form else None,
        "bytes": form.bytes if form else None,
        "degrees": told_degrees(form) if form else None,
        "refusal": one.refusal or Told(None, ""),
    }
