"""`wavesym advise`: which model of a scene is enough, as text or JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, isfinite

WAVES = "waves"
_MEANING = {
    "massless": "masses on springs: rods weigh nothing",
    "consistent": "the same, each rod with its consistent mass (1/3, 1/6) at its ends",
}


@dataclass(frozen=True)
class Discrepancy:
    """How far an output is from that of waves, in parts of its largest value: its history and its peak at most.

    inf where waves have not come to an output that moves without them.
    """

    history: float
    peak: float


@dataclass(frozen=True)
class Candidate:
    """A model in place of waves, "massless" or "consistent": a difference for each output, or why it is `refused`."""

    name: str
    differences: tuple[Discrepancy, ...] = ()
    refusal: str = ""

    @property
    def worst(self) -> float:
        """The largest difference of a history."""
        return inf if self.refusal else max(each.history for each in self.differences)


@dataclass(frozen=True)
class Advice:
    """The candidates from cheap to dear, compared with waves by `program` at so many `instants`.

    `outputs` has the name, the unit and the largest value of each output. Where all candidates are refused nothing is
    compared, and there are neither program nor instants.
    """

    scene: str
    tolerance: float
    candidates: tuple[Candidate, ...]
    outputs: tuple[tuple[str, str, float], ...] = ()
    program: str = ""
    instants: int = 0

    @property
    def enough(self) -> str:
        """The cheapest model whose histories differ from those of waves by no more than the tolerance."""
        return next((each.name for each in self.candidates if each.worst <= self.tolerance), WAVES)

    def json(self) -> str:
        """The advice as JSON; null for what is infinite."""
        names = [name for name, *_ in self.outputs]
        models: dict[str, object] = {}
        for each in self.candidates:
            found = zip(names, each.differences, strict=False)
            rows = [{"name": name, "history": _finite(d.history), "peak": _finite(d.peak)} for name, d in found]
            models[each.name] = {"refused": each.refusal} if each.refusal else {"outputs": rows}
        largest = [{"name": name, "unit": unit, "largest": value} for name, unit, value in self.outputs]
        models[WAVES] = {"program": self.program, "outputs": largest}
        fields = {"name": self.scene, "tolerance": self.tolerance, "enough": self.enough, "instants": self.instants}
        return json.dumps({**fields, "models": models}, indent=2, allow_nan=False) + "\n"

    def text(self) -> str:
        """The advice in words, and a table."""
        return "".join(f"{line}\n" for line in self._lines())

    def _lines(self) -> Iterator[str]:
        enough = f"enough to {self.tolerance:g} of the largest value of every output: {self.enough}"
        yield f"{self.scene}: {enough if self.outputs else 'nothing is compared with waves, as no other model serves'}"
        yield ""
        for each in self.candidates:
            yield f"  {each.name:10}  {each.refusal or _MEANING[each.name]}"
        if not self.outputs:
            return
        yield f"  {WAVES:10}  {self.program}"
        yield ""
        yield "How far histories and their peaks are from those of waves, in parts of the largest value,"
        yield f"at {self.instants} instants:"
        yield ""
        compared = [each for each in self.candidates if not each.refusal]
        width = max(len("output"), *(len(name) for name, *_ in self.outputs))
        heads = "".join(f"  {each.name:>12} {'peak':>8}" for each in compared)
        yield f"  {'output':{width}}  {'largest':>12}{heads}"
        for k, (name, unit, value) in enumerate(self.outputs):
            found = (each.differences[k] for each in compared)
            cells = "".join(f"  {_number_text(each.history):>12} {_number_text(each.peak):>8}" for each in found)
            yield f"  {name:{width}}  {value:>12.6g}{cells}  {unit}".rstrip()


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _number_text(value: float) -> str:
    return f"{value:.1e}" if isfinite(value) else "-"
