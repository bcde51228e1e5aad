"""The model: what engines take, every number exact. Of the paper's systems also its nodes, and clocks of its rods."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section, dump
from wavesym.errors import CostError, UnservedError
from wavesym.exact.modes.frequencies import frequencies
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.mechanics.node import Node, UnitLoad
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.modes.undamped_modes import damping_ratios

_MODES = 12  # and those that damping is said of
_RIGID = 1  # modes without strain at most


def model_sections(model: Model, chain: Chain | None) -> Iterator[Section]:
    """All that a model holds."""
    network = model.network
    yield Facts(
        "model",
        "What is computed",
        {
            **model.labels.system,
            **({"m": chain.m} if chain else {}),
            **part_counts(model),
            "until": str(model.until),
            "tolerance": str(model.tolerance),
            "horizon_double": model.horizon(DOUBLE),
            "horizon_single": model.horizon(SINGLE),
            "sha256": model.labels.sha256,
        },
    )
    yield light_cone(model)
    yield dump("points", "Points: what moves as one, with what holds it to the ground", network.points, "point")
    yield dump("bars", "Bars: elastic rods, each between two points", network.bars, "rod", 1)
    yield dump(
        "links",
        "Links: springs, dashpots, contacts and friction between two points",
        network.links,
        "link",
    )
    if chain:
        yield from _paper_parts(chain)
    yield dump("loads", "Loads: unit responses, each from its time on and times its weight", model.loads)
    yield outputs(model)
    yield from _damped_modes(model)


def part_counts(model: Model) -> dict[str, Plain]:
    """How much there is of each kind of part."""
    network = model.network
    return {
        "points": len(network.points),
        "bars": len(network.bars),
        "links": len(network.links),
        "joints": len(network.joints),
    }


def light_cone(model: Model) -> Facts:
    """The joints that are modelled, and how many are not."""
    count, reached = len(model.network.joints), model.joints_in_reach(rational(model.horizon()))
    out = count - len(reached)
    values: dict[str, Plain | Display] = {
        "modelled": list(reached),
        "left_out": Display(out, f"{out} of {count} joints"),
    }
    return Facts("light_cone", "Light cone: the joints from which something can reach an output in time", values)


def outputs(model: Model) -> Listing:
    """The outputs, as they are computed."""
    return dump("outputs", "Outputs: a quantity at a place on a rod, from its left end", model.probes)


def _paper_parts(chain: Chain) -> Iterator[Section]:
    yield Listing(
        "nodes",
        "Nodes: the paper's conditions between two rods, and at the ends; a body answers a wave by exp(-rate tau)",
        list(map(_node, enumerate(chain.nodes))),
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


def _node(placed: tuple[int, Node]) -> dict[str, Plain]:
    x, node = placed
    return {
        "x": x,
        "kind": _kind(node),
        "inertia": str(node.inertia),
        "alpha": str(node.alpha),
        "beta": str(node.beta),
        "damping": str(node.damping),
        "rate": str(node.rate) if node.inertia else None,
        "loads": Display(
            {load.source: list(map(str, load.coefficients)) for load in node.loads},
            ", ".join(map(_action, node.loads)) or "-",
        ),
        "contact": node.contact,
    }


def _kind(node: Node) -> str:
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


def _action(load: UnitLoad) -> str:
    powers = [f"{c} tau**{k}" if k else str(c) for k, c in enumerate(load.coefficients) if c]
    return f"{load.source}: {' + '.join(powers)}"


def _damped_modes(model: Model) -> Iterator[Section]:
    """The first modes with strain, and the rule for all; nothing where no damping is given."""
    damping = model.damping
    if damping is None:
        return
    count = max(_MODES, len(damping.ratios), *(damping.modes or (0,)))
    try:
        found = np.array([float(w) for w in frequencies(model.network_as_written, count + _RIGID)])
    except (CostError, UnservedError) as refusal:
        yield Facts("modes", "Modes are not known", {"refusal": str(refusal)})
        return
    w = found[found > 0][:count]
    rule = damping_ratios(damping, w.tolist())
    after = f"all higher ones have {rule.ratios[-1]:g}"
    if rule.rayleigh:
        after = "at any frequency w it is ({:.6g}/w + {:.6g} w)/2".format(*rule.rayleigh)
    rows: list[dict[str, Plain | Display]] = []
    for number, (frequency, ratio) in enumerate(zip(w.tolist(), rule.ratios_at(w).tolist(), strict=True), 1):
        period = 2 * np.pi / frequency
        row: dict[str, Plain | Display] = {"mode": number, "frequency": frequency, "period": period, "damping": ratio}
        if model.clock:
            row["seconds"] = period * float(model.clock.seconds)
        rows.append(row)
    yield Listing("modes", f"Modes: angular frequency and period in tau, and the damping ratio; {after}", rows)
