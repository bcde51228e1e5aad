"""The laws that are run, in the scene's own numbers: of its joints, and of the paper's wave functions on clocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flint import fmpq

from wavesym.derivation.rules import Linear, LoadTerm, Rule, Term, Weights
from wavesym.derivation.table import Function, Rules
from wavesym.documents.inspection.model import light_cone
from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section
from wavesym.errors import CostError, UnservedError
from wavesym.exact.breakpoints import Breakpoints
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.tables.joint_response import joint_polynomial, polynomial_text, rates
from wavesym.exact.tables.network_joints import MOST_POINTS
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Joint
from wavesym.numbers.doubles import rational

LAW = "M q' + C q + K u = sum over ends of 2 n Z a + F, where u' = q, n q - a goes back into an end"


def law_sections(model: Model, chain: Chain | None) -> Iterator[Section]:
    """The law of each joint in the light cone, and of a chain of the paper the recurrences of its wave functions."""
    yield light_cone(model)
    yield joint_laws(model)
    if chain is None:
        yield unsupported_facts(model)
        return
    rules = Rules(chain)
    reached = model.joints_in_reach(rational(model.horizon()))
    functions = [Function(name, rod) for rod in range(min(reached) + 1, max(reached) + 1) for name in ("f", "g")]
    yield Listing(
        "functions",
        f"Exponentials times powers, which tables and the closed form run, in intervals n of length {rules.interval}."
        "\nf_1[n] stands for the coefficient F[g,k] of exp(-g w) w**k in rod 1, f_1'[n] for F[g,k+1]."
        "\nAt a rate g where F[n] on the left has the factor 0, F[g,0] follows from the jumps: sums of F[g,0] over all"
        "\ng, each times the factor of its F' at k = 0",
        [_of_function(rules[function]) for function in functions],
        ("own", "terms", "loads"),
    )


def unsupported_facts(model: Model) -> Facts:
    """What named systems have and written-out chains have not."""
    try:
        model.network.refuse_corners()
        refusal = (
            f"system.type: {model.labels.type} has no closed form, as collision, drive and building have; take "
            "pieces, march or `run`"
        )
    except UnservedError as error:
        refusal = str(error)
    words = "Symbolic tables, walks and highest powers are not served"
    return Facts("not_served", words, {"refusal": refusal})


def joints(model: Model) -> Listing:
    """What joints in the light cone are, in a line each: the points that they hold, and how they answer a wave."""
    rows = []
    for number in model.joints_in_reach(rational(model.horizon())):
        joint = model.network.joints[number]
        points = Display([_point_name(model, point) for point in joint.points], _point_names(model, joint))
        law = _polynomial(JointLaw.assemble(model.network, joint))
        rows.append({"joint": number, "points": points, "ends": len(joint.ends), "law": law})
    return Listing("joints", "Joints in the light cone: the points and ends of rods that move together", rows, ("law",))


def joint_laws(model: Model) -> Listing:
    """M, C and K of the joints in the light cone, and the breakpoints of each."""
    until = rational(model.horizon())
    try:
        found = Breakpoints(model, until)
        counts = {number: found.count(number) for number in found.joints_in_reach}
        refusal = ""
    except CostError as error:
        counts, refusal = {}, str(error)
    rows: list[dict[str, Plain | Display]] = []
    for number in model.joints_in_reach(until):
        joint = model.network.joints[number]
        law = JointLaw.assemble(model.network, joint)
        mass = [[m if a == b else fmpq(0) for b in range(len(law.mass))] for a, m in enumerate(law.mass)]
        rows.append(
            {
                "joint": number,
                "points": Display([_point_name(model, point) for point in joint.points], _point_names(model, joint)),
                "ends": len(joint.ends),
                "breakpoints": counts.get(number),
                "M": _matrix("M", mass),
                "C": _matrix("C", law.damping),
                "K": _matrix("K", law.stiffness),
                "polynomial": _polynomial(law),
                "refusal": Display(None, "") if rows or not refusal else refusal,
            }
        )
    parted = ", with all contacts open" if model.network.corners else ""
    return Listing(
        "joints",
        f"Joints in the light cone, with a breakpoint for each start of a stretch without fronts{parted}:\n{LAW}",
        rows,
        ("M", "C", "K", "polynomial", "refusal"),
    )


def _polynomial(law: JointLaw) -> Display:
    """Of a joint that is not large: its polynomial, and the rates where it splits."""
    if len(law.mass) > MOST_POINTS:
        return Display(None, f"more than {MOST_POINTS} points: no polynomial is made")
    found, shown = rates(law), polynomial_text(joint_polynomial(law))
    if found is None:
        return Display({"coefficients": _coefficients(law), "rates": None}, f"polynomial {shown}, which does not split")
    words = f", rates {', '.join(map(str, found))}" if found else ""
    return Display({"coefficients": _coefficients(law), "rates": list(map(str, found))}, f"polynomial {shown}{words}")


def _coefficients(law: JointLaw) -> list[str]:
    return list(map(str, joint_polynomial(law).coeffs()))


def _point_name(model: Model, point: int) -> Plain:
    return model.network.points[point].name or point


def _point_names(model: Model, joint: Joint) -> str:
    return ", ".join(str(_point_name(model, point)) for point in joint.points)


def _matrix(name: str, rows: Sequence[Sequence[fmpq]]) -> Display:
    """Rows apart by semicolons, where it is not 0."""
    words = "; ".join(" ".join(map(str, row)) for row in rows) if any(value for row in rows for value in row) else "0"
    return Display([list(map(str, row)) for row in rows], f"{name} = {words}")


def _of_function(rule: Rule) -> dict[str, Plain]:
    terms, loads = list(map(_right, rule.terms)), list(map(_load_text, rule.loads))
    return {
        "function": rule.function,
        "rod": rule.rod,
        "own": Display(_weights(rule.own), f"{_product(rule.own, f'{rule.function}_{rule.rod}', 0)} ="),
        "terms": Display(list(map(_term, rule.terms)), "\n".join(terms) or ("" if loads else "0")),
        "loads": Display(list(map(_load, rule.loads)), "\n".join(loads)),
    }


def _linear(linear: Linear, variable: str) -> Display:
    return Display({"constant": str(linear.constant), "slope": str(linear.slope)}, _linear_text(linear, variable))


def _linear_text(linear: Linear, variable: str) -> str:
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
        f"({_linear_text(linear, variable)}) {name}{prime}[{interval}]"
        for linear, variable, prime in ((weights.same, "g", ""), (weights.next_power, "k", "'"))
        if linear.constant or linear.slope
    )


def _right(term: Term) -> str:
    return f"+ {_product(term.weights, f'{term.function}_{term.rod}', term.back)}"


def _load_text(load: LoadTerm) -> str:
    return f"+ ({load.value}) {load.source}, at g = 0, k = {load.power}, n = {1 + load.back}"


def _weights(weights: Weights) -> dict[str, Plain]:
    return {
        "same": _linear(weights.same, "g").value,
        "raised": _linear(weights.next_power, "k").value,
        "jump": str(weights.jump),
    }


def _term(term: Term) -> dict[str, Plain]:
    return {"function": term.function, "rod": term.rod, "back": term.back, **_weights(term.weights)}


def _load(load: LoadTerm) -> dict[str, Plain]:
    return {"source": load.source, "back": load.back, "power": load.power, "value": str(load.value)}
