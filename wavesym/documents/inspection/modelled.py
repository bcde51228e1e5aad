"""The model: what engines take, every number exact."""

from __future__ import annotations

from collections.abc import Iterator

from wavesym.documents.inspection.damped import damped_modes
from wavesym.documents.inspection.networked import counted, graph_cone, parts
from wavesym.documents.inspection.section import Facts, Listing, Plain, Section, Told
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.mechanics.node import Node, UnitLoad
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, SINGLE


def modelled(model: Model, chain: Chain | None) -> Iterator[Section]:
    """The parts of a model; of one that the paper has, its nodes and rods."""
    yield Facts(
        "model",
        "What is computed",
        {
            **model.labels.system,
            **(counted(model) if chain is None else {"m": chain.m}),
            "until": str(model.until),
            "tolerance": str(model.tolerance),
            "horizon_double": model.horizon(DOUBLE),
            "horizon_single": model.horizon(SINGLE),
            "sha256": model.labels.sha256,
        },
    )
    yield cone(model, chain)
    yield from parts(model) if chain is None else _named_parts(chain)
    yield Listing(
        "loads",
        "Loads: unit responses, each from its time on and times its weight",
        [{"source": load.source, "time": str(load.time), "weight": str(load.weight)} for load in model.loads],
    )
    yield probes(model)
    yield from damped_modes(model)


def _named_parts(chain: Chain) -> Iterator[Section]:
    yield Listing(
        "nodes", "Nodes: the conditions between two rods, and at the ends", list(map(_node, enumerate(chain.nodes)))
    )
    yield Listing(
        "rods",
        "Rods: where the clocks of their waves begin, and how fast they move at tau = 0",
        [
            {"rod": i, "tau0": str(rod.tau0), "x0": str(rod.x0), "velocity": str(rod.velocity)}
            for i in range(1, chain.m + 1)
            for rod in (chain.rod(i),)
        ],
    )


def nodes_in_reach(model: Model) -> range:
    """The nodes of a chain of the paper from the first to the last one that can influence an output."""
    joints = model.reached(rational(model.horizon()))
    return range(min(joints), max(joints) + 1)


def cone(model: Model, chain: Chain | None) -> Facts:
    """The nodes that are modelled, and how many are not."""
    if chain is None:
        return graph_cone(model)
    modelled_nodes = nodes_in_reach(model)
    out = chain.m + 1 - len(modelled_nodes)
    left_out = Told(out, f"{out} of {chain.m + 1} nodes")
    values = {"first": modelled_nodes[0], "last": modelled_nodes[-1], "left_out": left_out}
    return Facts("light_cone", "Light cone: the nodes from which something can reach an output in time", values)


def probes(model: Model) -> Listing:
    """The outputs, as they are computed."""
    rows = [
        {"name": probe.name, "quantity": probe.quantity, "rod": probe.rod, "place": str(probe.place)}
        for probe in model.probes
    ]
    return Listing("outputs", "Outputs: a quantity at a place on a rod, from its left end", rows)


def kind(node: Node) -> str:
    """What a node is, in a word or two."""
    if node.contact:
        return "contact"
    if node.inertia:
        return "body"
    if not node.alpha and not node.beta:
        return "prescribed velocity"
    if node.loads:
        return "prescribed force"
    return "joint" if node.left and node.right else "free end"


def rate(node: Node) -> str | None:
    """The rate of a body; a node without inertia has none."""
    return str(node.rate) if node.inertia else None


def _node(placed: tuple[int, Node]) -> dict[str, Plain]:
    x, node = placed
    return {
        "x": x,
        "kind": kind(node),
        "inertia": str(node.inertia),
        "alpha": str(node.alpha),
        "beta": str(node.beta),
        "damping": str(node.damping),
        "rate": rate(node),
        "loads": Told(
            {load.source: list(map(str, load.coefficients)) for load in node.loads},
            ", ".join(map(_acting, node.loads)) or "-",
        ),
        "contact": node.contact,
    }


def _acting(load: UnitLoad) -> str:
    powers = [f"{c} tau**{k}" if k else str(c) for k, c in enumerate(load.coefficients) if c]
    return f"{load.source}: {' + '.join(powers)}"
