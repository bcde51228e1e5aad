"""Frequencies and frequency responses of three structures: whole commands, the time of processors and peak memory.

A frame of ten storeys on shaken ground, damped; a column of 400 layers of soil on rock that takes waves up; a drill
string of 50 pipes and collars, each with its tool joint as a mass.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from tools.bench.commands import ran
from tools.bench.streaming import frame

HEAD = ("what", "s of processor", "peak MB")
LAYERS, PIPES, POINTS = 400, 50, 400


def soil(layers: int) -> str:
    """Layers of 0.5 m, stiffer as they lie deeper, on rock that waves leave into."""
    parts = ['"free"']
    for k in range(layers):
        speed, density = 150 + 600 * k // layers + 7 * (k % 5), 1800 + 10 * (k % 30)
        parts.append(f'{{ rod = "0.5 m", A = "1 m^2", speed = "{speed} m/s", rho = "{density} kg/m^3" }}')
    parts += [
        '{ joint = true, name = "rock" }',
        '{ rod = "10 m", A = "1 m^2", speed = "900 m/s", rho = "2300 kg/m^3" }',
    ]
    return _chain("soil", "shear", [*parts, '"absorbing"'], '"rock"', "N", 'velocity = ["0 m"]')


def drill_string(pipes: int) -> str:
    """Pipes above, the last tenth of them collars; a bit that is pushed, and a hook that is a spring with a dashpot."""
    parts = ['{ mass = "9 t", spring = "4 MN/m", dashpot = "20 kN*s/m", name = "hook" }']
    bit = ', name = "bit"'
    for k in range(pipes):
        area = "34 cm^2" if k < pipes - pipes // 10 else "260 cm^2"
        parts.append(f'{{ rod = "{9 + k % 3}.1 m", A = "{area}", E = "206 GPa", rho = "7850 kg/m^3" }}')
        parts.append(f'{{ mass = "{60 + k % 7} kg"{bit if k == pipes - 1 else ""} }}')
    return _chain("drill_string", "longitudinal", parts, '"bit"', "kN", 'velocity = ["hook", "bit"]')


def _chain(name: str, kind: str, parts: Sequence[str], at: str, unit: str, output: str) -> str:
    return f"""
name = "{name}"
[units]
kind = "{kind}"
[system]
type = "chain"
parts = [{", ".join(parts)}]
[[load]]
at = {at}
times = ["0 s"]
steps = ["1 {unit}"]
[output]
until = "1 s"
{output}
"""


def rows(records: Path) -> Iterator[Sequence[str]]:
    """What, for how long processors were busy, and its peak memory."""
    record = records / "elcentro_1940_ns_peknold.at2"
    structures = (
        ("frame of 10 storeys", frame(record, 10), ("--to", "30")),
        (f"soil of {LAYERS} layers", soil(LAYERS), ("--to", "25")),
        (f"drill string of {PIPES} parts", drill_string(PIPES), ("--to", "50")),
    )
    for what, text, band in structures:
        with TemporaryDirectory() as directory:
            path = Path(directory, "scene.toml")
            path.write_text(text, encoding="utf-8")
            for command, options in (("modes", ()), ("frf", (*band, "--points", str(POINTS)))):
                done = ran([sys.executable, "-m", "wavesym", command, str(path), *options])
                figures = (f"{done.busy:.2f}", f"{done.megabytes:.0f}")
                yield f"`wavesym {command}`, {what}", *(figures if done.well else ("refused", ""))
