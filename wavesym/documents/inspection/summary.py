"""What is modelled of a scene, and what it is compiled to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wavesym.documents.inspection.laws import joints, unsupported_facts
from wavesym.documents.inspection.model import light_cone, outputs, part_counts
from wavesym.documents.inspection.program import choice, contacts, stream, variants
from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section
from wavesym.documents.inspection.units import in_units
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.programs.choice import attempts
from wavesym.scene.physical.scene import PhysicalScene


def summary_sections(
    model: Model, chain: Chain | None, sources: Sequence[str], physical: PhysicalScene | None = None
) -> Iterator[Section]:
    """From the chain to the programs that were tried; loads have these `sources`."""
    yield Facts(
        "system", "The chain, with the parameters that can matter", {**model.labels.system, **_parameters(model, chain)}
    )
    until = Display(str(model.until), model.clock.format(model.until)) if model.clock else str(model.until)
    yield Facts(
        "horizon",
        "How long and how exactly",
        {"until": until, "tau_max": model.horizon(), "tolerance": str(model.tolerance)},
    )
    if physical:
        yield from in_units(physical, model)
    yield light_cone(model)
    yield joints(model)
    yield Listing("loads", "Loads", [{"load": load} for load in model.labels.loads if load], ("load",))
    yield outputs(model)
    tried = attempts(model)
    yield choice(model, tried)
    yield contacts(model)
    yield stream(model, sources)
    yield variants(model, tried)
    if chain is None:
        yield unsupported_facts(model)


def _parameters(model: Model, chain: Chain | None) -> dict[str, Plain]:
    letters = {
        name: {str(i): str(value) for i, value in numbers.items()} for name, numbers in model.letters.items() if numbers
    }
    return {**({"m": chain.m} if chain else {}), **letters, **part_counts(model)}
