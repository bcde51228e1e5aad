"""What is modelled of a scene, and what it is compiled to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wavesym.documents.inspection.modelled import cone, kind, probes, rate
from wavesym.documents.inspection.networked import counted, joint_laws, not_served
from wavesym.documents.inspection.programmed import chosen, contacts
from wavesym.documents.inspection.section import Facts, Listing, Plain, Section, Told
from wavesym.documents.inspection.streamed import streamed
from wavesym.documents.inspection.units import in_units
from wavesym.documents.inspection.variants import variants
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import attempts
from wavesym.scene.physical.scene import PhysicalScene


def summary(model: Model, sources: Sequence[str], physical: PhysicalScene | None = None) -> Iterator[Section]:
    """From the chain to the programs that were tried; loads have these `sources`."""
    yield Facts(
        "system", "The chain, with the parameters that can matter", {**model.labels.system, **_parameters(model)}
    )
    until = Told(str(model.until), model.clock.told(model.until)) if model.clock else str(model.until)
    yield Facts(
        "horizon",
        "How long and how exactly",
        {"until": until, "tau_max": model.horizon(), "tolerance": str(model.tolerance)},
    )
    if physical:
        yield from in_units(physical, model)
    yield cone(model)
    yield joint_laws(model) if model.chain is None else _nodes(model)
    yield Listing("loads", "Loads", [{"load": told} for told in model.labels.loads if told], ("load",))
    yield probes(model)
    tried = attempts(model)
    yield chosen(model, tried)
    yield contacts(model)
    yield streamed(model, sources)
    yield variants(model, tried)
    if model.chain is None:
        yield not_served(model)


def _parameters(model: Model) -> dict[str, Plain]:
    if model.chain is None:
        return counted(model)
    felt = {
        name: {str(i): str(value) for i, value in numbers.items()} for name, numbers in model.felt.items() if numbers
    }
    return {"m": model.chain.m, **felt}


def _nodes(model: Model) -> Listing:
    nodes = model.light_cone(rational(model.horizon()))
    rows = [{"x": x, "kind": kind(node), "rate": rate(node)} for x in nodes for node in (model.named.nodes[x],)]
    return Listing("nodes", "Nodes in the light cone; a body answers a wave by exp(-rate tau)", rows)
