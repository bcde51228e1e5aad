"""The program that `generate` takes, and all that were tried for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress

from wavesym.documents.inspection.section import Facts, Listing, Plain, Section, Told, finite
from wavesym.documents.inspection.streamed import streamed
from wavesym.documents.inspection.variants import told_degrees, variants
from wavesym.errors import CostError, ToleranceError
from wavesym.exact.contacts.events import contact_ends, events
from wavesym.exact.contacts.schedule import GrazingError
from wavesym.mechanics.model import Model
from wavesym.programs.choice import Tried, attempts, best
from wavesym.programs.program import Program, Provenance


def programmed(model: Model, sources: Sequence[str]) -> Iterator[Section]:
    """The program in numbers, or why there is none; and the stream of loads that have these `sources`."""
    tried = attempts(model)
    yield chosen(model, tried)
    with suppress(ToleranceError):  # which is told already
        choice = best(model, tried)
        yield from _numbers(choice.evaluator.program(Provenance(model, choice.reason)))
    yield contacts(model)
    yield streamed(model, sources)
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


def chosen(model: Model, tried: Sequence[Tried]) -> Facts:
    """What `auto` takes of what was tried."""
    try:
        choice = best(model, tried)
    except ToleranceError as refusal:
        return Facts("program", "generate would refuse this scene", {"refusal": str(refusal)})
    form = choice.evaluator
    values: dict[str, Plain] = {
        "kind": choice.name,
        "precision": form.real.name,
        "tau_max": form.tau_max,
        "bound": form.error_bound,
        "degrees": told_degrees(form),
        "bytes": form.bytes,
        "reason": choice.reason,
    }
    return Facts("program", "The program that generate takes", values)


def contacts(model: Model) -> Listing:
    """When contacts open, as far as that matters; a scene whose ends are not known in time is refused for that."""
    if model.network.contacts:
        return _happening(model)
    words = "Contacts whose opening can reach an output"
    try:
        rows = [{"x": end.x, "tau": end.digits, "refusal": Told(None, "")} for end in contact_ends(model)]
    except (CostError, GrazingError) as error:
        words = "When contacts open is not known in time, for which generate refuses the scene"
        return Listing("contacts", words, [{"x": None, "tau": None, "refusal": str(error)}], ("refusal",))
    return Listing("contacts", words, rows, ("refusal",))


def _happening(model: Model) -> Listing:
    """What contacts do that open and close."""
    words = "When contacts open and close, as far as that can reach an output"
    try:
        rows = [{"x": e.x, "kind": e.kind, "tau": e.digits, "refusal": Told(None, "")} for e in events(model)]
    except (CostError, GrazingError) as error:
        words = "When contacts open and close is not known in time, for which generate refuses the scene"
        return Listing("events", words, [{"x": None, "kind": None, "tau": None, "refusal": str(error)}], ("refusal",))
    return Listing("events", words, rows, ("refusal",))
