"""What is modelled of a scene, and what it is compiled to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wavesym.documents.inspection.modelled import cone, kind, nodes_in_reach, probes, rate
from wavesym.documents.inspection.networked import counted, joint_laws, not_served
from wavesym.documents.inspection.programmed import chosen, contacts
from wavesym.documents.inspection.section import Facts, Listing, Plain, Section, Told
from wavesym.documents.inspection.streamed import streamed
from wavesym.documents.inspection.units import in_units
from wavesym.documents.inspection.variants import variants
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.programs.choice import attempts
from wavesym.scene.physical.scene import PhysicalScene


def summary(
    model: Model, chain: Chain | None, sources: Sequence[str], physical: PhysicalScene | None = None
) -> Iterator[Section]:
    """From the chain to the programs that were tried; loads have these `sources`."""
    yield Facts(
        "system", "The chain, with the parameters that can matter", {**model.labels.system, **_parameters(model, chain)}
    )
    until = Told(str(model.until), model.clock.told(model.until)) if model.clock else str(model.until)
    yield Facts(
        "horizon",
        "How long and how exactly",
        {"until": until, "tau_max": model.horizon(), "tolerance": str(model.tolerance)},
    )
    if physical:
        yield from in_units(physical, model)
    yield cone(model, chain)
    yield joint_laws(model) if chain is None else _nodes(model, chain)
    yield Listing("loads", "Loads", [{"load": told} for told in model.labels.loads if told], ("load",))
    yield probes(model)
    tried = attempts(model)
    yield chosen(model, tried)
    yield contacts(model)
    yield streamed(model, sources)
    yield variants(model, tried)
    if chain is None:
        yield not_served(model)


def _parameters(model: Model, chain: Chain | None) -> dict[str, Plain]:
    if chain is None:
        return counted(model)
    letters = {
        name: {str(i): str(value) for i, value in numbers.items()} for name, numbers in model.letters.items() if numbers
    }
    return {"m": chain.m, **letters}


def _nodes(model: Model, chain: Chain) -> Listing:
    rows = [
        {"x": x, "kind": kind(node), "rate": rate(node)} for x in nodes_in_reach(model) for node in (chain.nodes[x],)
    ]
    return Listing("nodes", "Nodes in the light cone; a body answers a wave by exp(-rate tau)", rows)
