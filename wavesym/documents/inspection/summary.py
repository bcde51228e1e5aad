"""What is modelled of a scene, and what it is compiled to."""

from __future__ import annotations

from collections.abc import Iterator

from wavesym.documents.inspection.modelled import cone, kind, probes, rate
from wavesym.documents.inspection.programmed import chosen, contacts
from wavesym.documents.inspection.section import Facts, Listing, Plain, Section
from wavesym.documents.inspection.variants import variants
from wavesym.model.model import Model
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import attempts


def summary(model: Model) -> Iterator[Section]:
    """From the chain to the programs that were tried."""
    parameters = {
        name: {str(i): str(value) for i, value in numbers.items()} for name, numbers in model.felt.items() if numbers
    }
    values: dict[str, Plain] = {**model.labels.system, "m": model.named.m, **parameters}
    yield Facts("system", "The chain, with the parameters that can matter", values)
    yield Facts(
        "horizon",
        "How long and how exactly",
        {"until": str(model.until), "tau_max": model.horizon(), "tolerance": str(model.tolerance)},
    )
    yield cone(model)
    nodes = model.light_cone(rational(model.horizon()))
    rows = [{"x": x, "kind": kind(node), "rate": rate(node)} for x in nodes for node in (model.named.nodes[x],)]
    yield Listing("nodes", "Nodes in the light cone; a body answers a wave by exp(-rate tau)", rows)
    yield Listing("loads", "Loads", [{"load": told} for told in model.labels.loads if told], ("load",))
    yield probes(model)
    tried = attempts(model)
    yield chosen(model, tried)
    yield contacts(model)
    yield variants(model, tried)
