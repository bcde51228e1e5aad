"""python -m tools.front_page: draw the pictures of README.md, and write the numbers that bench/ measured into it.

The first picture is of two joined bars under a pulse: where its waves are, and the force at one place, beside what a
common integrator gives (linear finite elements, stepped by Newmark's method with the mean acceleration). The second one
is what the page's own scene looks like. The third one is of bench/b.csv: error against time a value, of wavesym and of
four other methods.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import wavesym
from wavesym.numbers.arrays import Array
from wavesym.pictures.saving import save
from wavesym.pictures.style import colours, draw_grid, new_figure, set_title, with_style

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs" / "waves.svg"
FRAME = ROOT / "docs" / "frame.svg"
CHART = ROOT / "docs" / "speed.svg"
PAGE = ROOT / "README.md"
_NEW_SET = "| building, m = 2, to 20 | wavesym, C"  # as fast as it gets: the first row
BEGIN, END = "<!-- measured by make bench -->", "<!-- end -->"

_IMPEDANCE, _PULSE, _UNTIL = 3, 0.35, 4.0  # of the second bar; how long the load acts
_ELEMENTS = 100  # of each bar
_PLACE = 0.5
_COLUMNS, _ROWS = 160, 401
_GREY, _BLUE = "0.62", "#1b5e9e"
_METHODS = {  # of the chart: language, label, colour, marker, and where its label stands beside its best point
    "pieces": ("C", "wavesym, generated C", _BLUE, "o", (10, -6)),
    "characteristics, order 4": ("C", "characteristics, C", "#8c5a00", "s", (10, 2)),
    "central differences": ("NumPy", "central differences", "#3f6f3a", "^", (-22, -20)),
    "finite elements, Newmark": ("SciPy", "finite elements", "#7a3b8f", "D", (-88, 10)),
    "Laplace inversion": ("SciPy", "Laplace inversion", "#8a2f2f", "v", (-62, -22)),
}


def scene(places: list[float]) -> wavesym.Scene:
    """The bars: the second is stiffer and heavier, its far end is free."""
    parts: list[Any] = [{"joint": True, "name": "head"}, {"rod": 1}, {"rod": 1, "impedance": _IMPEDANCE}, "free"]
    fields: dict[str, Any] = {
        "system": {"type": "chain", "parts": parts},
        "load": [{"at": "head", "times": [0, _PULSE], "steps": [1, -1]}],
        "output": {"until": _UNTIL, "force": places, "tolerance": 1e-12},
    }
    return wavesym.Scene(name="bars", **fields)


def finite_elements(times: Array) -> Array:
    """The force at the place, by linear elements of equal length and Newmark's method, a step for each time."""
    count, h, step = 2 * _ELEMENTS, 1 / _ELEMENTS, float(times[1])
    impedances = np.repeat([1.0, _IMPEDANCE], _ELEMENTS)
    stiffness, mass = np.zeros((count + 1, count + 1)), np.zeros((count + 1, count + 1))
    for e, z in enumerate(impedances):
        pair = slice(e, e + 2)
        stiffness[pair, pair] += z / h * np.array([[1, -1], [-1, 1]])
        mass[pair, pair] += z * h / 6 * np.array([[2, 1], [1, 2]])
    inverse = np.linalg.inv(mass + step * step / 4 * stiffness)
    moved, moving, forces = np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1)
    forces[0] = 1
    speeding = np.linalg.solve(mass, forces)
    element, found = int(_PLACE / h), []
    for time in times:
        found.append(float(impedances[element] * (moved[element + 1] - moved[element]) / h))
        forces[0] = float(time + step < _PULSE)
        ahead = moved + step * moving + step * step / 4 * speeding
        after = inverse @ (forces - stiffness @ ahead)
        moved, moving = ahead + step * step / 4 * after, moving + step / 2 * (speeding + after)
        speeding = after
    return np.array(found)


@with_style
def picture() -> Figure:
    """Place by time on the left, the force at one place on the right."""
    places = [round((k + 0.5) / (_COLUMNS / 2), 6) for k in range(_COLUMNS)]
    times = np.linspace(0, _UNTIL, _ROWS)
    field = wavesym.run(scene(places), times).values
    fine = np.linspace(0, _UNTIL, 8 * _ELEMENTS + 1)
    exact = wavesym.run(scene([_PLACE]), fine).values[0]
    figure = new_figure(3.6)
    waves, history = figure.subplots(1, 2, width_ratios=[1, 1.6])
    largest = float(np.abs(field).max())
    extent = (0.0, 2.0, 0.0, _UNTIL)
    waves.imshow(
        field.T, origin="lower", aspect="auto", extent=extent, cmap=colours(signed=True), vmin=-largest, vmax=largest
    )
    waves.axvline(1, color="0.3", linewidth=0.8)
    waves.axvline(_PLACE, color="0.3", linewidth=0.8, linestyle=":")
    waves.set_xlabel("place")
    waves.set_ylabel("time")
    waves.set_xticks([0, 1, 2])
    waves.set_yticks(range(5))
    waves.set_title("A pulse in two bars", loc="left")
    label = f"{2 * _ELEMENTS} finite elements, Newmark"
    history.plot(fine, finite_elements(fine), color=_GREY, linewidth=1.0, label=label)
    history.plot(fine, exact, color=_BLUE, linewidth=1.6, label="wavesym")
    history.set_xlabel("time")
    history.set_xlim(0, _UNTIL)
    history.set_xticks(range(5))
    history.set_title("Force at the dotted line", loc="left")
    draw_grid(history)
    history.set_ylim(top=float(exact.max()) + 1.1)
    history.legend(frameon=False, loc="upper left", borderaxespad=0.2)
    return figure


@with_style
def chart() -> Figure:
    """Error against time a value, in one panel."""
    figure = new_figure(4.4)
    axes = figure.subplots()
    for name, (language, label, colour, marker, beside) in _METHODS.items():
        rows = [row for row in bench_rows() if row["name"] == name and row["language"] == language]
        points = sorted(
            (float(row["error_away"]), float(row["ns_per_value"])) for row in rows if row["precision"] == "double"
        )
        errors, times = zip(*points, strict=True)
        axes.loglog(times, errors, color=colour, marker=marker, markersize=5, linewidth=1.4)
        axes.annotate(label, (times[0], errors[0]), beside, textcoords="offset points", color=colour)
    draw_grid(axes, zero=False)
    axes.set_xlabel("time a value [ns], left is faster")
    axes.set_ylabel("largest error, low is better")
    axes.set_xlim(0.05, 1e5)
    set_title(figure, "More digits in less time: a building, one core")
    return figure


def bench_rows() -> list[Mapping[str, str]]:
    """What `make bench` measured of the building B."""
    with (ROOT / "bench" / "b.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def measurements() -> str:
    """How right and how fast: what `make bench` measured of the building B, and of a new set of its numbers."""
    rows = bench_rows()
    page = (ROOT / "bench" / "README.md").read_text(encoding="utf-8")
    built = _new_set(page)["us to coefficients"]
    own = [row for row in rows if row["name"] == "pieces" and row["language"] == "C" and row["precision"] == "double"]
    row = next(row for row in own if row["resolution"] == "tolerance 1e-12")
    others = [
        other
        for other in rows
        if other["kind"] not in ("wavesym", "floor", "set-up") and other["error_at_fronts"] and other["ns_per_value"]
    ]
    near = [other for other in others if float(other["error_at_fronts"]) <= 1e-9]
    best = min(near, key=lambda other: float(other["ns_per_value"]))
    ratio = float(best["ns_per_value"]) / float(row["ns_per_value"])
    lines = [
        f"- **{float(row['error_at_fronts']):.1e}** error, proved below {float(row['proved_bound']):.1e}",
        f"- **{float(row['ns_per_value']):.2g} ns** a value; best other method: {ratio:.2g} times that",
        f"- **{built} µs** for new parameters",
    ]
    how = f"Measured on a building, in C, on one core; the other method is {best['name']}, to 1e-9."
    return "\n".join([BEGIN, "", *lines, "", how, "", END])


def _new_set(page: str) -> dict[str, str]:
    """What the building takes for a new set of its numbers, by the heads of the table."""
    lines = page.splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith(_NEW_SET))
    head = max(k for k in range(first) if lines[k].startswith("| scene |"))
    names, cells = ([cell.strip() for cell in lines[k].strip("|").split("|")] for k in (head, first))
    return dict(zip(names, cells, strict=True))


def frame() -> wavesym.Scene:
    """The scene that the page shows."""
    shown = re.search(r"^```toml frame\.toml\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert shown
    return wavesym.Scene.from_toml(shown[1])


def main() -> None:
    """Draw all, and write the numbers."""
    save(picture(), PICTURE)
    frame().plot(FRAME)
    save(chart(), CHART)
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    PAGE.write_text(before + measurements() + after, encoding="utf-8")


if __name__ == "__main__":
    main()
