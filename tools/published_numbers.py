"""python -m tools.published_numbers: compute what others printed, and write docs/published.md.

A number is the same where ours, rounded to as many digits as are printed, is what is printed.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

import wavesym

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "published"
PRINTED = FOLDER / "printed.toml"
PAGE = ROOT / "docs" / "published.md"


class ComparedNumber(NamedTuple):
    """A printed number, ours as a double, and whether they are the same to the digits that are printed."""

    printed: str
    own: float

    @property
    def same(self) -> bool:
        """Whether ours rounds to what is printed: half of the last digit, and a rounding of ours."""
        last = Decimal(self.printed).as_tuple().exponent
        assert isinstance(last, int)  # a number
        half = Decimal(5).scaleb(last - 1) * (1 + Decimal("1e-9"))
        return abs(Decimal(self.own) - Decimal(self.printed)) <= half + abs(Decimal(self.own)) * Decimal("3e-16")

    @property
    def rounded_text(self) -> str:
        """Ours with two digits more than are printed."""
        digits = len(Decimal(self.printed).as_tuple().digits)
        return f"{self.own:.{min(digits + 2, 17)}g}"

    @property
    def verdict(self) -> str:
        """In a word, or by how much they differ."""
        return "same" if self.same else f"differs by {float(Decimal(self.printed)) / self.own - 1:+.1e}"


def cases() -> list[Mapping[str, Any]]:
    """What was printed."""
    found: list[Mapping[str, Any]] = tomllib.loads(PRINTED.read_text(encoding="utf-8"))["case"]
    return found


def compare_numbers(case: Mapping[str, Any], numbers: Mapping[str, Any]) -> list[ComparedNumber]:
    """Printed numbers of a case beside ours."""
    factor = float(numbers.get("factor", 1))
    own = [factor * value for value in _own(str(FOLDER / f"{case['scene']}.toml"), numbers)]
    return [ComparedNumber(printed, value) for printed, value in zip(numbers["printed"], own, strict=True)]


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
    total = same = 0
    body: list[str] = []
    differing: list[str] = []
    for case in cases():
        title = f"{case['scene']}: {case['area']}"
        before = total - same
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
                body.append(f"| {each.printed} | {each.rounded_text} | {each.verdict} |\n")
            if "why" in numbers:
                reasons.append(f"Why they differ: {numbers['why']}.\n")
        body += ["\n", *reasons, *(["\n"] if reasons else [])]
        if differ := total - same - before:
            anchor = re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")
            differing.append(f"- [{title}](#{anchor}), {differ}: {case['source']}\n")
    inferred = sum("inferred" in case for case in cases())
    yield f"{total} numbers of {len(cases())} cases: {same} are the same, {total - same} differ.\n"
    yield f"Some data of {inferred} cases are inferred from results, which prove less then; these say so.\n\n"
    yield "Sources with numbers that differ, and how many; what follows the numbers of each says why:\n\n"
    yield "".join(differing) + "\n"
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
