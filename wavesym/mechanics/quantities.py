"""The quantities that an output may be: one table, which scenes, headers, pictures and pages take their words from."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Quantity:
    """A quantity of outputs.

    Attributes:
        name: as a scene writes it.
        axis: what the dimensionless number is, for an axis; {0} stands for the letter of the displacement.
        place_quantity: the one read at the same places, with a side where that has one; "" for what counts rods.
        order: how often the waves are differentiated: -1 for an integral.
        multiple_of: the quantity that it is a multiple of, as a scene's units say.
        words: in a sentence; the name where there is nothing better.
        title: the same in a title.
        torsion: what people call it of a shaft.
        usual: whether it has been there from the start, so that it is part of every scene's canonical form.
    """

    name: str
    axis: str
    place_quantity: str
    order: int = 0
    multiple_of: str = ""
    words: str = ""
    title: str = ""
    torsion: str = ""
    usual: bool = False

    def in_words_of(self, kind: str) -> Quantity:
        """The same in the words for a `kind` of rods."""
        return replace(self, words=self.torsion, title="") if kind == "torsional" and self.torsion else self

    @property
    def phrase(self) -> str:
        """In a sentence."""
        return self.words or self.name

    @property
    def heading(self) -> str:
        """In a title."""
        return self.title or self.phrase

    @property
    def plural(self) -> str:
        """Several of them."""
        phrase = self.phrase
        return f"{phrase[:-1]}ies" if phrase.endswith("y") else f"{phrase}es" if phrase.endswith("s") else f"{phrase}s"


QUANTITIES = {
    each.name: each
    for each in (
        Quantity("strain", "(l / {0}\u2080) \u2202{0}/\u2202x", "strain", usual=True),
        Quantity(
            "velocity", "(l / (c {0}\u2080)) \u2202{0}/\u2202t", "velocity", torsion="angular velocity", usual=True
        ),
        Quantity("displacement", "{0} / {0}\u2080", "displacement", -1, torsion="rotation", usual=True),
        Quantity(
            "acceleration",
            "(l\u00b2 / (c\u00b2 {0}\u2080)) \u2202\u00b2{0}/\u2202t\u00b2",
            "velocity",
            1,
            torsion="angular acceleration",
        ),
        Quantity("force", "impedance \u00d7 strain", "force", torsion="moment"),
        Quantity("drift", "\u0394{0} / {0}\u2080", "", torsion="twist"),
        Quantity(
            "relative",
            "({0} \u2212 ground) / {0}\u2080",
            "displacement",
            words="relative displacement",
            title="displacement relative to the ground",
            torsion="relative rotation",
        ),
        Quantity("stress", "impedance \u00d7 strain / section", "strain", multiple_of="force", torsion="shear stress"),
    )
}
"""By name, in the order of the outputs of a scene."""


def order_of(quantity: str) -> int:
    """How often the waves are differentiated in what is read; a load is none of an output's quantities."""
    return QUANTITIES[quantity].order if quantity in QUANTITIES else 0
