"""The exact range of every frequency of a scene over a box of parameters.

Undamped frequencies fall where a mass or a density grows, and rise where a stiffness or a modulus does (Rayleigh: the
n-th is a minimum over subspaces of the greatest ratio of elastic to kinetic energy in them). So two corners of the box
are the range, whatever the other parameters are.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import pi

from flint import arb

from wavesym.errors import UnservedError, WavesymError
from wavesym.exact.modes.frequencies import frequencies
from wavesym.numbers.doubles import upper_double
from wavesym.results.presentation import csv_line
from wavesym.scene import Scene, lower
from wavesym.scene.paths import leaves

RISING = ("spring", "stiffness", "E", "G", "I", "speed")
FALLING = ("mass", "floor_mass", "foundation_mass", "column_mass", "rho", "inertia")
_ONE_WAY = f"with {', '.join(RISING)} they rise, with {', '.join(FALLING)} they fall"
_LAST_KEY = re.compile(r"([A-Za-z_]+)(?:\[\d+\])?$")


@dataclass(frozen=True)
class FrequencyRange:
    """What the n-th angular frequency is at least and at most, in rad per s, or per tau without [units]."""

    number: int
    low: float
    high: float


@dataclass(frozen=True)
class ModeRanges:
    """The ranges of the first frequencies over a box; `wavesym.modes(..., ranges=...)` makes it."""

    name: str
    modes: tuple[FrequencyRange, ...]
    box: Mapping[str, tuple[str, str]]
    time_unit: str | None
    notes: tuple[str, ...] = ()
    why: str = "each is exact: of the box's corners no frequency is missed, and between them frequencies are monotone"

    def __len__(self) -> int:
        return len(self.modes)

    def __getitem__(self, place: int) -> FrequencyRange:
        return self.modes[place]

    def rows(self) -> list[dict[str, object]]:
        """Of each mode `omega`, `hz` and `period` with `low` and `high`."""
        return [
            {
                "number": each.number,
                "omega": {"low": each.low, "high": each.high},
                "hz": {"low": each.low / (2 * pi), "high": each.high / (2 * pi)},
                "period": {
                    "low": 2 * pi / each.high if each.high else None,
                    "high": 2 * pi / each.low if each.low else None,
                },
            }
            for each in self.modes
        ]

    def json(self) -> str:
        """As JSON: `modes`, `box`, `complete`, `why`, `time_unit`."""
        about = {"box": {path: list(ends) for path, ends in self.box.items()}, "complete": True, "why": self.why}
        return (
            json.dumps({"name": self.name, "modes": self.rows(), **about, "time_unit": self.time_unit}, indent=2) + "\n"
        )

    def csv(self) -> str:
        """A line for each mode."""
        lines = ["number,omega.low,omega.high,hz.low,hz.high\n"]
        for each in self.modes:
            ends = each.low, each.high, each.low / (2 * pi), each.high / (2 * pi)
            lines.append(csv_line([each.number, *ends]))
        return "".join(lines)

    def text(self) -> str:
        """As a table for people."""
        per, hz = ("rad/s", "Hz") if self.time_unit else ("rad/tau", "1/tau")
        lines = [f"mode  {f'omega [{per}]':>33}  {f'frequency [{hz}]':>33}"]
        for each in self.modes:
            omega = f"{each.low:.9g} to {each.high:.9g}"
            lines.append(
                f"{each.number:>4}  {omega:>33}  {f'{each.low / (2 * pi):.9g} to {each.high / (2 * pi):.9g}':>33}"
            )
        box = ", ".join(f"{path} from {low} to {high}" for path, (low, high) in self.box.items())
        return "\n".join([*lines, "", f"over {box}; {self.why}"]) + "\n"


def direction(scene: Scene, path: str) -> int:
    """1 where frequencies rise with what is at a path, -1 where they fall. UnservedError where they may do either."""
    found = _LAST_KEY.search(path)
    key = found[1] if found else path
    if not path.startswith("system.") or found is None:
        raise WavesymError(f"--range {path}: no number of the system; a mass, spring, modulus or density is one")
    if key == "rho" and f"{path[: found.start()]}speed" in leaves(scene.model_dump()):
        raise UnservedError(f"--range {path}: beside a speed it changes mass and stiffness together; {_ONE_WAY}")
    if key in RISING:
        return 1
    if key == "kappa" and scene.system.type in ("building", "collision") and scene.scale is None:
        return 1  # a body of mass 1/kappa
    if key in FALLING and not (key == "inertia" and scene.scale is None):
        return -1
    raise UnservedError(
        f"--range {path}: frequencies may rise or fall with it, as where mass and stiffness change together; {_ONE_WAY}"
    )


def mode_ranges(scene: Scene, count: int, box: Mapping[str, tuple[str, str]]) -> ModeRanges:
    """The ranges of the first frequencies.

    Args:
        scene: an undamped chain without contacts.
        count: how many.
        box: of each path, as in `scene.with_`, the least and the greatest value, as a scene has them.

    Raises:
        SceneError: for a value that the scene does not take.
        UnservedError: for a parameter that frequencies do not follow one way, and for dashpots.
        WavesymError: for ends of a range that make the frequencies fall.
    """
    slow, fast = {}, {}
    for path, (low, high) in box.items():
        way = direction(scene, path)
        slow[path], fast[path] = (low, high) if way > 0 else (high, low)
    least, greatest = (_angular(scene.with_(corner), count) for corner in (slow, fast))
    rows = []
    for number, (first, last) in enumerate(zip(least, greatest, strict=True), 1):
        if first > last:
            raise WavesymError(
                f"--range: the first end is above the second ({', '.join(box)}); write the lesser one first"
            )
        rows.append(FrequencyRange(number, _lower_double(first), upper_double(last)))
    notes = lower(scene, in_time=False).labels.structure_notes
    return ModeRanges(scene.name, tuple(rows), dict(box), "s" if scene.scale else None, notes)


def _lower_double(value: arb) -> float:
    return -upper_double(-value) if value > 0 else 0.0


def _angular(scene: Scene, count: int) -> list[arb]:
    model = lower(scene, in_time=False)
    model.network.refuse_loss()
    if model.network.loses:
        raise UnservedError("--range: dashpots make frequencies complex, and these follow no parameter one way")
    per_tau = arb(model.clock.seconds) if model.clock else arb(1)
    return [w / per_tau for w in frequencies(model.network, count)]


def read_box(texts: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Texts PATH=A..B as both ends of each path. WavesymError."""
    box: dict[str, tuple[str, str]] = {}
    for text in texts:
        path, equals, ends = (part.strip() for part in text.partition("="))
        low, dots, high = (part.strip() for part in ends.partition(".."))
        if not (path and equals and dots and low and high):
            raise WavesymError(f"--range {text}: not a range; write PATH=A..B, as system.kappa[0]=1/10..1/5")
        if path in box:
            raise WavesymError(f"--range {text}: {path} has a range already; write one of both")
        box[path] = low, high
    return box
