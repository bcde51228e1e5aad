"""python -m tools.published_numbers: compute what others printed, and write docs/published.md.

A number is the same where ours, rounded to as many digits as are printed, is what is printed. Where it is not, what is
printed may be what an approximation gives, which is computed as well: linear finite elements, or rock that is damped.
Else words say whether it is an approximation or an error of its source.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import wavesym
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.scene import lower

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "published"
PRINTED = FOLDER / "printed.toml"
PAGE = ROOT / "docs" / "published.md"
_REASONS = {"error": "An error of the source", "approximation": "An approximation"}


class ComparedNumber(NamedTuple):
    """A printed number, ours as a double, and what an approximation gives, if one is named, with its name."""

    printed: str
    own: float
    approximation: float | None = None
    method: str = ""

    @property
    def same(self) -> bool:
        """Whether ours is what is printed."""
        return self._is_printed(self.own)

    @property
    def is_approximation(self) -> bool:
        """Whether it is not, and what the approximation gives is."""
        return not self.same and self.approximation is not None and self._is_printed(self.approximation)

    def _is_printed(self, value: float) -> bool:
        """Whether it rounds to what is printed: half of the last digit, and a rounding of ours."""
        last = Decimal(self.printed).as_tuple().exponent
        assert isinstance(last, int)  # a number
        half = Decimal(5).scaleb(last - 1) * (1 + Decimal("1e-9"))
        return abs(Decimal(value) - Decimal(self.printed)) <= half + abs(Decimal(value)) * Decimal("3e-16")

    def _rounded_text(self, value: float) -> str:
        """With two digits more than are printed."""
        digits = len(Decimal(self.printed).as_tuple().digits)
        return f"{value:.{min(digits + 2, 17)}g}"

    @property
    def rounded_text(self) -> str:
        """Ours."""
        return self._rounded_text(self.own)

    @property
    def verdict(self) -> str:
        """In a word, or by how much they differ, and what gives the printed number."""
        if self.same:
            return "same"
        differs = f"differs by {float(Decimal(self.printed)) / self.own - 1:+.1e}"
        if not self.is_approximation or self.approximation is None:
            return differs
        return f"{differs}; {self.method} it is {self._rounded_text(self.approximation)}"


def cases() -> list[Mapping[str, Any]]:
    """What was printed."""
    found: list[Mapping[str, Any]] = tomllib.loads(PRINTED.read_text(encoding="utf-8"))["case"]
    return found


def compare_numbers(case: Mapping[str, Any], numbers: Mapping[str, Any]) -> list[ComparedNumber]:
    """Printed numbers of a case beside ours."""
    factor = float(numbers.get("factor", 1))
    path = str(FOLDER / f"{case['scene']}.toml")
    own = [factor * value for value in _own(path, numbers)]
    approximate, method = _approximate(path, numbers)
    return [ComparedNumber(*each, method) for each in zip(numbers["printed"], own, approximate, strict=True)]


def _approximate(path: str, numbers: Mapping[str, Any]) -> tuple[Sequence[float | None], str]:
    """What an approximation gives, where one is named, and its name."""
    count, model = len(numbers["printed"]), lower(wavesym.Scene.from_toml(path), in_time=False)
    if cells := numbers.get("elements"):
        assert model.clock is not None  # the scene has units
        problem = linear_problem(model)
        made = Elements(problem, np.full(len(model.network.bars), cells))
        free = np.setdiff1d(np.arange(made.size), problem.prescribed_points)
        mass, stiffness = (each.toarray()[np.ix_(free, free)] for each in (made.mass, made.stiffness))
        squares = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)
        hz = np.sqrt(np.maximum(squares, 0)) / (2 * np.pi * float(model.clock.seconds))
        first = numbers.get("from", 1) - 1
        return hz[first : first + count].tolist(), f"of {cells} linear elements"
    if ratio := numbers.get("rock_damping"):
        (layer,), rock = model.network.bars, model.network.points[0]
        # a modulus 1 + 2 i ratio times as large, as programs for equivalent linear soil have it
        impedance = float(layer.impedance / rock.damping) / np.sqrt(1 + 2j * ratio)
        turn = np.linspace(0, np.pi, 100_001)
        return [1 / float(np.abs(np.cos(turn) + 1j * impedance * np.sin(turn)).min())], f"on rock damped by {ratio:g}"
    return [None] * count, ""


def _own(path: str, numbers: Mapping[str, Any]) -> Sequence[float]:
    count = len(numbers["printed"])
    if numbers["read"] == "modes":
        first = numbers.get("from", 1)
        modes = wavesym.modes(path, first - 1 + count)
        return [mode.hz for mode in modes][first - 1 :]
    scene = wavesym.Scene.from_toml(path)
    match numbers["read"]:
        case "values":
            values: list[float] = wavesym.run(scene, numbers["times"])[numbers["output"]].tolist()
            return values
        case "events":
            response = wavesym.evaluator(scene)
            seconds = response.seconds_per_tau or 1.0
            return [event.double * seconds for event in response.events[:count]]
        case "least":
            return [wavesym.summary(scene)[numbers["output"]].min.value]
        case "arrival":
            arrival = wavesym.summary(scene)[numbers["output"]].arrival
            assert arrival is not None  # something arrives
            assert arrival.time is not None  # the scene has units
            return [arrival.time]
        case "response":
            found = wavesym.frf(scene, numbers["frequencies"])[numbers["output"]]
            parts: list[float] = (getattr(found, numbers["part"]) if "part" in numbers else abs(found)).tolist()
            return parts
        case "peak":
            return [wavesym.frf(scene, numbers["band"]).peaks()[numbers["output"]].amplitude]
    raise AssertionError(numbers["read"])


def page(
    found: Callable[[Mapping[str, Any], Mapping[str, Any]], list[ComparedNumber]] = compare_numbers,
) -> Iterator[str]:
    """The lines of docs/published.md."""
    yield "# Numbers that others printed\n\n"
    yield (
        "Scenes of [examples/published](../examples/published/printed.toml) with numbers from papers, books and tests\n"
        "of other programs. *Same*: ours round to all digits that are printed. Written by `make published`.\n\n"
    )
    total = same = approximate = errors = 0
    body: list[str] = []
    differing: dict[str, list[str]] = {"Sources with errors": [], "Sources with approximations": []}
    for case in cases():
        title = f"{case['scene']}: {case['area']}"
        before, wrong = total - same, errors
        body += [
            f"## {title}\n\n",
            f"{case['what'][0].upper()}{case['what'][1:]}. Source: {case['source']}.\n\n",
        ]
        if "inferred" in case:
            body.append(f"Inferred: {case['inferred']}.\n\n")
        body += ["| printed | ours | verdict |\n", "|---|---|---|\n"]
        reasons = []
        for numbers in case["numbers"]:
            for each in found(case, numbers):
                total, same = total + 1, same + each.same
                approximate += each.is_approximation
                errors += "error" in numbers and not each.same
                body.append(f"| {each.printed} | {each.rounded_text} | {each.verdict} |\n")
            reasons += [f"{title}: {numbers[key]}.\n" for key, title in _REASONS.items() if key in numbers]
        body += ["\n", *reasons, *(["\n"] if reasons else [])]
        if differ := total - same - before:
            anchor = re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")
            kind = list(differing)[errors == wrong]
            differing[kind].append(f"- [{title}](#{anchor}), {differ}: {case['source']}\n")
    inferred = sum("inferred" in case for case in cases())
    uncomputed = total - same - approximate - errors
    yield f"{total} numbers of {len(cases())} cases: {same} are the same, {total - same} differ. Of these\n\n"
    yield f"- {errors} are errors of their sources: misprints, and numbers that were rounded before they were used;\n"
    yield f"- {approximate} are what an approximation gives, to all digits: computed here, too, and named beside;\n"
    yield f"- {uncomputed} is an approximation that could not be computed again.\n\n"
    yield f"Some data of {inferred} cases are inferred from results, which prove less then; these say so.\n\n"
    for title, lines in differing.items():
        yield f"{title}, and how many numbers that differ they have:\n\n"
        yield "".join(lines) + "\n"
    printed = {case["scene"] for case in cases()}
    if others := [path for path in sorted(FOLDER.glob("*.toml")) if path != PRINTED and path.stem not in printed]:
        names = ", ".join(f"[{path.stem}](../examples/published/{path.name})" for path in others)
        yield f"Scenes of which no number was printed where we could read it: {names}.\n\n"
    yield "".join(body).rstrip("\n") + "\n"


def main() -> None:
    """Write the page."""
    PAGE.write_text("".join(page()), encoding="utf-8")


if __name__ == "__main__":
    main()
