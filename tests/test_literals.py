"""Every number in a generated file reads back to the bits of its correctly rounded exact value.

All of generated/ is parsed again. The polynomials in it come from power series on windows; here they are computed anew
from the exact tables, at Chebyshev points. The self-tests' values come from the exact tables; here from windows.
"""

from __future__ import annotations

import json
import math
import re
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import pytest
from flint import arb, ctx

from tests.support.generated import files
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import Balls, segments, values
from wavesym.exact.tables.signal import signals
from wavesym.numbers.doubles import fraction, rational
from wavesym.scene import Scene, lower

KEPT = Path(__file__).parent.parent / "generated"
EXAMPLES = ("building_m2", "collision_m4", "drive_m1")
NUMBER = re.compile(r"(?<![\w.@/+-])-?(?:\d+\.\d+(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])")
TABLE = re.compile(r"static const (?:real|double) (\w+)\[\] = \{([^}]*)\};")
NODES = 32  # the pieces are 1/4 long: what 32 points do not see is below 2**-190
COUNTED: dict[str, int] = {}


def numbers(text: str) -> list[str]:
    """All floating-point literals of a file."""
    return NUMBER.findall(text)


def tables(text: str) -> dict[str, list[str]]:
    """The tables of a C file, each number as it is written."""
    return {name: [item.strip() for item in body.split(",")] for name, body in TABLE.findall(text)}


def read(name: str, suffix: str) -> str:
    return (KEPT / name / f"{name}{suffix}").read_text(encoding="utf-8")


def wrong(literals: list[str], exact: list[Fraction]) -> list[tuple[str, Fraction]]:
    """The literals that are not the nearest double of their value; Python rounds fractions correctly."""
    pairs = zip(literals, exact, strict=True)
    return [(text, value) for text, value in pairs if float(text).hex() != (float(value) + 0.0).hex()]


def middle(ball: arb) -> Fraction:
    mantissa, exponent = ball.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


@pytest.mark.parametrize("path", sorted(KEPT.glob("*/*_*")), ids=lambda path: path.name)
def test_every_literal_is_the_shortest_that_reads_back(path: Path, record_property) -> None:
    literals = numbers(path.read_text(encoding="utf-8"))
    record_property("literals", len(literals))
    assert len(literals) > 5
    assert not [text for text in literals if len(repr(float(text))) > len(text)]
    long = [text for text in literals if repr(float(text)) != text]
    # bounds are written in a few digits for the reader, the end of a contact in twenty
    assert all(len(text) < 8 or len(text.lstrip("-0.").replace(".", "")) == 20 for text in long)


def test_a_wrong_digit_is_seen() -> None:
    assert not wrong(["0.1", "0.3333333333333333"], [Fraction(1, 10), Fraction(1, 3)])
    assert wrong(["0.33333333333333337"], [Fraction(1, 3)])
    assert wrong(["-0.0"], [Fraction(0)])
    assert numbers("strain@0.5 = -1.5e-07, 2.0f 3 x1.5 (0.1, 4e-05)") == ["-1.5e-07", "0.1", "4e-05"]


class Pieces:
    """The tables of a kept C file, polynomial by polynomial."""

    def __init__(self, name: str) -> None:
        self.scene = Scene.from_toml(name)
        text = read(name, ".c")
        self.real = tables(text)
        self.integer = {
            key: [int(item) for item in body.split(",")]
            for key, body in re.findall(r"static const int (\w+)\[\] = \{([^}]*)\};", text)
        }
        self.until = Fraction(self.scene.output.until)
        self.last = Fraction(math.nextafter(float(self.until), math.inf))

    def grids(self):
        """Of each grid: its outputs, starts, centres, and a list of literals for every piece and output.

        Where an output needs fewer powers than others on the same piece, those left over are 0 and not in its list.
        """
        first, powers = self.integer["first_power"], self.real["coefficient"]
        for g, (low, high) in enumerate(pairwise(self.integer["first_piece"])):
            members = self.integer["member"][slice(*self.integer["first_member"][g : g + 2])]
            rows = []
            for a, b in pairwise(first[low : high + 1]):
                of_all = [powers[a:b][m :: len(members)] for m in range(len(members))]  # written for Horner's rule
                rows.append([row[next((k for k, c in enumerate(row) if float(c)), -1) :][::-1] for row in of_all])
            yield members, self.real["start"][low + g : high + g + 1], self.real["centre"][low:high], rows
        assert high == len(first) - 1

    def cuts(self, x: Fraction) -> list[Fraction]:
        """Where pieces end, exact: the loads come at integers, so waves reach x at integers and x more or less."""
        parts = {x % 1, -x % 1}
        breaks = sorted({Fraction(0), *(n + part for part in parts for n in range(int(self.until) + 1))})
        cuts = []
        for low, high in pairwise([*(b for b in breaks if b <= self.until), self.last]):
            count = max(1, math.ceil((high - low) * 4))
            inner = [Fraction(float(low + (high - low) * j / count)) for j in range(1, count)]
            cuts += [low, *inner]
        return [*cuts, self.last]


@cache
def kept(name: str) -> Pieces:
    return Pieces(name)


def chebyshev(value, centre: Fraction, half: Fraction, terms: int) -> list[arb]:
    """The powers of w of the first `terms` of the Chebyshev series at `NODES` points of |w| <= half."""
    angles = [arb.pi() * (2 * j + 1) / (2 * NODES) for j in range(NODES)]
    heights = [value(arb(rational(centre)) + arb(rational(half)) * angle.cos()) for angle in angles]
    series = []
    for k in range(terms):
        total = sum((y * (k * angle).cos() for y, angle in zip(heights, angles, strict=True)), arb(0))
        series.append(total * (1 if k == 0 else 2) / NODES)
    powers = [arb(0)] * terms
    before, last = [], [1]  # T_0, and none before it
    for k in range(terms):
        for power, factor in enumerate(last):
            powers[power] += factor * series[k]
        doubled = [0, *(factor * (1 if k == 0 else 2) for factor in last)]
        before, last = last, [c - (before[i] if i < len(before) else 0) for i, c in enumerate(doubled)]
    return [c / arb(rational(half)) ** k for k, c in enumerate(powers)]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", EXAMPLES)
def test_polynomials_are_those_of_the_exact_tables(name: str, record_property) -> None:
    pieces = kept(name)
    checked = 0
    with ctx.workprec(400):
        outputs = [segments(signal, ctx.prec) for signal in signals(lower(pieces.scene))]
        for members, starts, centres, rows in pieces.grids():
            cuts = pieces.cuts(pieces.scene.outputs[members[0]].x)
            assert not wrong(starts, cuts)
            middles = [(low + high) / 2 for low, high in pairwise(cuts)]
            assert not wrong(centres, middles)
            for start, low, high, centre, row in zip(cuts, cuts, cuts[1:], map(float, centres), rows, strict=False):
                place = Fraction(centre)
                half = max(high - place, place - low)
                for member, literals in zip(members, row, strict=True):
                    balls = Balls(outputs[member])
                    begun = [s for s in balls.segments if s.start <= rational(start)]
                    if not begun or balls.zero:
                        assert [float(text) for text in literals] == [0.0] * len(literals)
                        continue
                    exact = chebyshev(
                        lambda tau, s=begun[-1]: s.evaluate(tau - arb(s.start)), place, half, len(literals)
                    )
                    assert not wrong(literals, [middle(c) for c in exact]), f"output {member} from {float(start)}"
                    checked += len(literals)
        for scale in map(float, pieces.real["scale"]):
            counts = {float(Fraction(len(c) * 2**j) / pieces.last) for _, _, c, _ in pieces.grids() for j in range(4)}
            assert scale in counts
    record_property("coefficients", checked)
    assert checked > 500


@pytest.mark.parametrize("name", EXAMPLES)
def test_numpy_and_manifest_have_the_same_numbers_as_c(name: str) -> None:
    pieces, module, manifest = kept(name), {}, json.loads(read(name, ".json"))
    exec(read(name, ".py"), module)
    given = {**pieces.integer, **{key: [float(text) for text in table] for key, table in pieces.real.items()}}
    assert {"start", "centre", "coefficient", "member"} < module["_TABLES"].keys() <= given.keys()
    assert module["_TABLES"] == {key: given[key] for key in module["_TABLES"]}
    header = dict(re.findall(rf"#define {name.upper()}_(\w+) (\S+)", read(name, ".h")))
    assert module["TAU_MAX"] == manifest["tau_max"] == float(header["TAU_MAX"]) == float(pieces.until)
    assert module["ERROR_BOUND"] == manifest["error_bound"] == float(header["ERROR_BOUND"])
    assert manifest["error_bound"] == max(output["error_bound"] for output in manifest["outputs"])
    for x, digits in manifest["contact_end"].items():
        assert float(digits) == float(header[f"CONTACT_END_{x}"]) == module["CONTACT_END"][x]


def test_the_end_of_a_contact_is_right_in_all_its_digits() -> None:
    """The strain in the contact changes its sign between the neighbours of the last digit."""
    (digits,) = json.loads(read("collision_m4", ".json"))["contact_end"].values()
    scene = Scene.from_toml("collision_m4")
    (strain,) = (signal for signal in signals(lower(scene)) if signal.name == "strain@2")
    with ctx.workprec(300):
        balls = Balls(segments(strain, ctx.prec))
        end, last = Fraction(digits), Fraction(1, 2 * 10 ** len(digits.partition(".")[2]))
        assert balls.evaluate(rational(end - last)) < 0 < balls.evaluate(rational(end + last))


@pytest.mark.parametrize("name", EXAMPLES)
def test_reference_values_are_those_of_the_windows(name: str, record_property) -> None:
    scene, given = Scene.from_toml(name), tables(read(name, "_selftest.c"))
    taus, expected = [float(text) for text in given["taus"]], given["expected"]
    motion = Motion(lower(scene), rational(scene.output.until))
    rows = [values(partial(motion.segments, place), taus) for place in motion.probes]
    record_property("values", len(expected))
    assert [float(text).hex() for text in expected] == [value.hex() for row in rows for value in row]


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_closed_form_has_the_exact_table_rounded_once(name: str) -> None:
    scene = Scene.from_toml(name)
    given = tables(files(lower(scene), "c", "closed")[f"{name}.c"])
    arrivals = [arrival for signal in signals(lower(scene)) for arrival in signal.arrivals]
    families = [(rate, arrival.increment[rate]) for arrival in arrivals for rate in sorted(arrival.increment)]
    times = [fraction(arrival.time) for arrival in arrivals]
    assert not wrong(given["start"], times)  # all of them are doubles here
    assert not wrong(given["excess"], [Fraction(0)] * len(times))
    assert not wrong(given["rate"], [fraction(rate) for rate, _ in families])
    assert not wrong(given["coefficient"], [fraction(c) for _, powers in families for c in powers])


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_march_has_its_operators_rounded_once(name: str) -> None:
    """Their recurrences in fractions, without balls."""
    scene = Scene.from_toml(name)
    made = files(lower(scene), "c", "march")
    given, degree = tables(made[f"{name}.c"]), int(re.search(r"\bDEGREE = (\d+)", made[f"{name}.c"])[1])
    law, answer = (
        [int(text) for text in re.search(rf"const int {table}\[\] = {{([^}}]*)}}", made[f"{name}.c"])[1].split(",")]
        for table in ("law", "answer")
    )
    size, matrix = degree + 1, given["matrix"]
    places = [at for k, at in enumerate(answer) if law[k % len(law)] == 1]
    assert places
    for at in sorted(set(places)):
        ratios, firsts, lasts = (matrix[at + k : at + 3 * size : 3] for k in range(3))
        # the rate is one of few small fractions: the one whose last ratio this is
        step = Fraction(float(ratios[degree]) * 4 * degree).limit_denominator(1000)
        x = [Fraction(0)] + [step / (4 * k) for k in range(1, degree + 2)]
        ratio, first, last = ([Fraction(0)] * (degree + 2) for _ in range(3))
        for k in range(degree, 0, -1):
            ratio[k] = x[k] / (1 + x[k] * ratio[k + 1])
            first[k] = (-1) ** k - ratio[k + 1] * first[k + 1]
            last[k] = 1 - ratio[k + 1] * last[k + 1]
        slack = -2 * ratio[1] * first[1] / (1 - 2 * ratio[1] * first[1])
        assert not wrong(ratios, [slack, *ratio[1:-1]])
        assert not wrong(firsts, [2 * ratio[1] * last[1], *first[1:-1]])
        assert not wrong(lasts, [Fraction(0), *last[1:-1]])
