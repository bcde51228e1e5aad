"""A chain that is written out: its points, bars, links and joints, and what is not served for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flint import fmpq

from wavesym.documents.inspection.section import Facts, Listing, Plain, Section, Told
from wavesym.errors import CostError, UnservedError
from wavesym.exact.breakpoints import Breakpoints
from wavesym.exact.joints.joint import JointLaw
from wavesym.exact.tables.joint_response import joint_polynomial, rates, written
from wavesym.exact.tables.network_joints import MOST_POINTS
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Joint
from wavesym.numbers.doubles import rational

LAW = "M q' + C q + K u = sum over ends of 2 n Z a + F, where u' = q, n q - a goes back into an end"


def counted(model: Model) -> dict[str, Plain]:
    """How much there is of each kind of part."""
    network = model.network
    return {
        "points": len(network.points),
        "bars": len(network.bars),
        "links": len(network.links),
        "joints": len(network.joints),
    }


def not_served(model: Model) -> Facts:
    """What named systems have and written-out chains have not."""
    try:
        model.network.refuse_contacts()
        refusal = (
            f"system.type: {model.labels.type} has no closed form, as collision, drive and building have; take "
            "pieces, march or `run`"
        )
    except UnservedError as error:
        refusal = str(error)
    words = "Symbolic tables, walks and highest powers are not served"
    return Facts("not_served", words, {"refusal": refusal})


def parts(model: Model) -> Iterator[Section]:
    """Points, bars and links."""
    network = model.network
    yield Listing(
        "points",
        "Points: what moves as one, with what holds it to the ground",
        [
            {
                "point": _named(model, number),
                "mass": str(point.mass),
                "dashpot": str(point.damping),
                "spring": str(point.stiffness),
                "velocity": str(point.velocity),
                "motion": point.motion,
                "loads": Told([load.source for load in point.loads], ", ".join(load.source for load in point.loads)),
            }
            for number, point in enumerate(network.points)
        ],
    )
    yield Listing(
        "bars",
        "Bars: elastic rods between two points; a wave crosses one in its delay",
        [
            {
                "bar": bar.name or number,
                "left": _named(model, bar.left),
                "right": _named(model, bar.right),
                "length": str(bar.length),
                "delay": str(bar.delay),
                "impedance": str(bar.impedance),
                "ratios": Told(list(map(str, bar.ratios)), f"{bar.ratios[0]}, {bar.ratios[1]}"),
                "velocity": str(bar.velocity),
                "strain": str(bar.strain),
            }
            for number, bar in enumerate(network.bars, 1)
        ],
    )
    yield Listing(
        "links",
        "Links: springs and dashpots between two points",
        [
            {
                "left": _named(model, link.left),
                "right": _named(model, link.right),
                "ratio": str(link.ratio),
                "spring": str(link.stiffness),
                "dashpot": str(link.damping),
            }
            for link in network.links
            if not link.has_corner
        ],
    )
    if any(link.friction != 0 for link in network.links):
        yield Listing(
            "friction",
            "Friction: where a node rubs on the ground, and how much force that takes",
            [{"x": link.place, "friction": str(link.friction)} for link in network.links if link.friction != 0],
        )
    if any(link.contact for link in network.links):
        yield Listing(
            "contacts",
            "Contacts: two points that push each other while they touch, and how far apart they are at tau = 0",
            [
                {
                    "x": link.place,
                    "left": _named(model, link.left),
                    "right": _named(model, link.right),
                    "ratio": str(link.ratio),
                    "gap": str(link.gap),
                }
                for link in network.links
                if link.contact
            ],
        )


def graph_cone(model: Model) -> Facts:
    """The joints that are modelled, and how many are not."""
    count, reached = len(model.network.joints), model.reached(rational(model.horizon()))
    out = count - len(reached)
    values: dict[str, Plain | Told] = {"modelled": list(reached), "left_out": Told(out, f"{out} of {count} joints")}
    return Facts("light_cone", "Light cone: the joints from which something can reach an output in time", values)


def joint_laws(model: Model) -> Listing:
    """M, C and K of the joints in the light cone, and the knots of each."""
    until = rational(model.horizon())
    try:
        found = Breakpoints(model, until)
        knots = {number: found.count(number) for number in found.reached}
        refusal = ""
    except CostError as error:
        knots, refusal = {}, str(error)
    rows: list[dict[str, Plain | Told]] = []
    for number in model.reached(until):
        joint = model.network.joints[number]
        law = JointLaw.of(model.network, joint)
        mass = [[m if a == b else fmpq(0) for b in range(len(law.mass))] for a, m in enumerate(law.mass)]
        rows.append(
            {
                "joint": number,
                "points": Told([_named(model, point) for point in joint.points], _pointed(model, joint)),
                "ends": len(joint.ends),
                "knots": knots.get(number),
                "M": _matrix("M", mass),
                "C": _matrix("C", law.damping),
                "K": _matrix("K", law.stiffness),
                "polynomial": _polynomial(law),
                "refusal": Told(None, "") if rows or not refusal else refusal,
            }
        )
    parted = ", with all contacts open" if model.network.contacts else ""
    return Listing(
        "joints",
        f"Joints in the light cone, with a knot for each start of a stretch without fronts{parted}:\n{LAW}",
        rows,
        ("M", "C", "K", "polynomial", "refusal"),
    )


def _polynomial(law: JointLaw) -> Told:
    """Of a joint that is not large: its polynomial, and the rates where it splits."""
    if len(law.mass) > MOST_POINTS:
        return Told(None, f"more than {MOST_POINTS} points: no polynomial is made")
    found, shown = rates(law), written(joint_polynomial(law))
    if found is None:
        return Told({"coefficients": _listed(law), "rates": None}, f"polynomial {shown}, which does not split")
    words = f", rates {', '.join(map(str, found))}" if found else ""
    return Told({"coefficients": _listed(law), "rates": list(map(str, found))}, f"polynomial {shown}{words}")


def _listed(law: JointLaw) -> list[str]:
    return list(map(str, joint_polynomial(law).coeffs()))


def _named(model: Model, point: int) -> Plain:
    return model.network.points[point].name or point


def _pointed(model: Model, joint: Joint) -> str:
    return ", ".join(str(_named(model, point)) for point in joint.points)


def _matrix(name: str, rows: Sequence[Sequence[fmpq]]) -> Told:
    """Rows apart by semicolons, where it is not 0."""
    words = "; ".join(" ".join(map(str, row)) for row in rows) if any(value for row in rows for value in row) else "0"
    return Told([list(map(str, row)) for row in rows], f"{name} = {words}")
