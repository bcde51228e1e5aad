"""The laws that are run, in the scene's own numbers: of its joints, and of the paper's wave functions on clocks."""

from __future__ import annotations

from collections.abc import Iterator

from wavesym.derivation.rules import Linear, LoadTerm, Rule, Term, Weights
from wavesym.derivation.table import Function, Rules
from wavesym.documents.inspection.modelled import cone, nodes_in_reach
from wavesym.documents.inspection.networked import joint_laws, not_served
from wavesym.documents.inspection.section import Listing, Plain, Section, Told
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model


def laws(model: Model, chain: Chain | None) -> Iterator[Section]:
    """The law of each joint in the light cone, and of a chain of the paper the recurrences of its wave functions."""
    yield cone(model, chain)
    yield joint_laws(model)
    if chain is None:
        yield not_served(model)
        return
    nodes = nodes_in_reach(model)
    rules = Rules(chain)
    functions = [Function(name, rod) for rod in nodes[1:] for name in ("f", "g")]
    yield Listing(
        "functions",
        f"Exponentials times powers, which tables and the closed form run, in intervals n of length {rules.interval}."
        "\nf_1[n] stands for the coefficient F[g,k] of exp(-g w) w**k in rod 1, f_1'[n] for F[g,k+1]."
        "\nAt a rate g where F[n] on the left has the factor 0, F[g,0] follows from the jumps: sums of F[g,0] over all"
        "\ng, each times the factor of its F' at k = 0",
        [_of_function(rules[function]) for function in functions],
        ("own", "terms", "loads"),
    )


def _of_function(rule: Rule) -> dict[str, Plain]:
    terms, loads = list(map(_right, rule.terms)), list(map(_added, rule.loads))
    return {
        "function": rule.function,
        "rod": rule.rod,
        "own": Told(_weights(rule.own), f"{_product(rule.own, f'{rule.function}_{rule.rod}', 0)} ="),
        "terms": Told(list(map(_term, rule.terms)), "\n".join(terms) or ("" if loads else "0")),
        "loads": Told(list(map(_load, rule.loads)), "\n".join(loads)),
    }


def _linear(linear: Linear, variable: str) -> Told:
    return Told({"constant": str(linear.constant), "slope": str(linear.slope)}, _in(linear, variable))


def _in(linear: Linear, variable: str) -> str:
    """constant + slope variable, as one writes it."""
    if not linear.slope:
        return str(linear.constant)
    sign, size = ("-", -linear.slope) if linear.slope < 0 else ("+", linear.slope)
    factor = variable if size == 1 else f"{size} {variable}"
    if not linear.constant:
        return factor if sign == "+" else f"-{factor}"
    return f"{linear.constant} {sign} {factor}"


def _product(weights: Weights, name: str, back: int) -> str:
    interval = f"n-{back}" if back else "n"
    return " + ".join(
        f"({_in(linear, variable)}) {name}{prime}[{interval}]"
        for linear, variable, prime in ((weights.same, "g", ""), (weights.raised, "k", "'"))
        if linear.constant or linear.slope
    )


def _right(term: Term) -> str:
    return f"+ {_product(term.weights, f'{term.function}_{term.rod}', term.back)}"


def _added(load: LoadTerm) -> str:
    return f"+ ({load.value}) {load.source}, at g = 0, k = {load.power}, n = {1 + load.back}"


def _weights(weights: Weights) -> dict[str, Plain]:
    return {
        "same": _linear(weights.same, "g").value,
        "raised": _linear(weights.raised, "k").value,
        "jump": str(weights.jump),
    }


def _term(term: Term) -> dict[str, Plain]:
    return {"function": term.function, "rod": term.rod, "back": term.back, **_weights(term.weights)}


def _load(load: LoadTerm) -> dict[str, Plain]:
    return {"source": load.source, "back": load.back, "power": load.power, "value": str(load.value)}
