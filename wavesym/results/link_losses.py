"""What links lose where they rub or yield, as a summary tells it: the permanent set, and the energy dissipated."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from flint import ctx, fmpq

from wavesym.errors import CostError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link
from wavesym.numbers.doubles import midpoint
from wavesym.results.presentation import number_text

if TYPE_CHECKING:
    from wavesym.exact.losses import LinkLoss

_PLAIN = (fmpq(1), "")
_BITS = 128
_AT_REST = ("ground", "fixed")  # what does not move is called


class MeasuredQuantity(NamedTuple):
    """A `value` in a `unit`, which is empty for what has none."""

    value: float
    unit: str

    def __str__(self) -> str:
        return self.describe()

    def describe(self, digits: int = 7) -> str:
        """With its unit, to so many digits."""
        return number_text(self.value, self.unit, digits)


class LinkSummary(NamedTuple):
    """A link with friction or a spring with a corner (`law`), at a `place` as the scene calls it, `between` two points.

    Points are called by their names, else by their places: links at one place differ in them, or in their laws. `set`
    is how far it slid or yielded until the end of the horizon, lengthening it (or, of friction, along x) where that is
    positive; `dissipated` the energy that this took, without that of a dashpot beside it. Of a spring that has a gap,
    or only pulls or pushes, `set` is 0 and `dissipated` what the dashpot took that acts with it; without one it is not
    told of. Both are right to rounding. The `note` is a sentence on a spring that yielded without a force as soon as it
    was loaded, and never with one; empty of all others.
    """

    place: str
    law: str
    between: tuple[str, str]
    set: MeasuredQuantity
    dissipated: MeasuredQuantity
    note: str = ""

    @property
    def where(self) -> str:
        """Its place, with the names of its points."""
        return _where(self.place, self.between)

    def __str__(self) -> str:
        return self.describe()

    def describe(self, digits: int = 7) -> str:
        """A line that says what it lost, to so many digits."""
        lost = f"set {self.set.describe(digits)}, dissipated {self.dissipated.describe(digits)}"
        return f"{self.law} at {self.where}: {lost}"


def _where(place: str, between: tuple[str, str]) -> str:
    names = ", ".join(name for name in between if name not in _AT_REST and not name.startswith(place))
    return f"{place} ({names})" if names else place


def losing_links(model: Model) -> tuple[tuple[str, str], ...]:
    """The `where` and `law` of all links of a model that rub or yield, as their summaries have them."""
    links = (model.network.links[n] for n in model.network.corners)
    return tuple(
        (_where(link.place, _names(model, link)), link.law)
        for link in links
        if link.friction != 0 or link.limits is not None
    )


def set_unit(model: Model) -> str:
    """The unit of permanent sets."""
    return model.inputs.get("displacement", _PLAIN)[1]


def _names(model: Model, link: Link) -> tuple[str, str]:
    left, right = (model.network.points[number] for number in (link.left, link.right))
    return left.label, right.label


def link_summaries(model: Model, solved: Model | None = None) -> tuple[LinkSummary, ...] | None:
    """Those of a model's links that can reach an output; None where that would cost too much.

    `solved` is the same with more outputs, where what its links do is known already.
    GrazingError where no number of bits tells what a link does.
    """
    if not model.network.corners:
        return ()
    from wavesym.exact.losses import losses  # how contacts touch: few scenes have any

    stretch, energy = (model.inputs.get(name, _PLAIN) for name in ("displacement", "energy"))
    try:
        found = losses(model, solved)
    except CostError:
        return None
    with ctx.workprec(_BITS):  # rounded once, to doubles
        return tuple(
            LinkSummary(
                each.link.place,
                each.link.law,
                _names(model, each.link),
                MeasuredQuantity(midpoint(each.set * stretch[0]), stretch[1]),
                MeasuredQuantity(midpoint(each.dissipated * energy[0]), energy[1]),
                _note(each) if each.gives_way else "",
            )
            for each in found
        )


def _note(loss: LinkLoss) -> str:
    """What a spring that gives way is, and what may have been meant."""
    pulled = loss.set > 0
    one, other, written = ("pulled", "pushes", "[0, B]") if pulled else ("pushed", "pulls", "[A, 0]")
    return (
        f"the spring at {loss.link.place} bore no force when it was loaded: it was {one}, and yield = {written} bears "
        f"only what {other} it; exchange the two?"
    )
