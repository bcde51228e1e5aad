"""The table of what may vary at run time, in the documents, against what programs take."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import wavesym
from wavesym.api.programs import program
from wavesym.errors import WavesymError
from wavesym.programs.mode_sets.parameters import names_of
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.sweeps import topology

PAGE = Path(wavesym.__file__).parents[1] / "docs" / "reference" / "programs.md"
SAMPLES = {"spacing": 1, "samples": [0, 1, 0]}
OUTPUT = {"until": 3, "tolerance": "1/1000", "velocity": [1]}
PARTS = ["fixed", {"rod": 1}, {"mass": 1, "name": "a"}, {"rod": 1}, {"mass": 1}, {"spring": 1}, {"mass": 1}]
DASHPOT = [*PARTS[:2], {"mass": 1, "name": "a", "dashpot": "1/10"}, *PARTS[3:]]
SYSTEMS: dict[str, list[dict[str, Any]]] = {
    "named": [
        {"system": {"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]}, "load": [{"body": 1, **SAMPLES}]},
        {"system": {"type": "collision", "m": 4, "kappa": [1, 1], "velocity": [1, 0]}},
    ],
    "chain": [{"system": {"type": "chain", "parts": DASHPOT}, "load": [{"at": "a", **SAMPLES}]}],
    "modes": [{"system": {"type": "chain", "parts": PARTS}, "load": [{"at": "a", **SAMPLES}]}],
}
HEAD = "| parameter | what it is | named | chain | modes | stream, FMU | sweep |"


def table() -> dict[str, list[str]]:
    """The marks of each parameter, by the columns from the third on."""
    _, _, rest = PAGE.read_text(encoding="utf-8").partition(HEAD)
    rows = [line.strip("| ").split(" | ") for line in rest.partition("\n\n")[0].splitlines()[2:]]
    return {row[0].strip("` "): [cell.strip(" |") for cell in row[2:]] for row in rows}


TABLE = table()
ALONE = ("stiffness", "rod_mass", "damping")  # of modes, whatever is requested


def accepted(kind: str, name: str, **options: Any) -> bool:
    """Whether a program of one of these scenes takes a parameter."""
    if kind == "modes":
        options["evaluator"] = "modes"
    elif name in ALONE:
        return False  # modes are taken
    for number, fields in enumerate(SYSTEMS[kind]):
        try:
            scene = Scene(name=f"{kind}_{number}", output=OUTPUT, **fields)
            program(scene, Request.from_options(runtime=(name,), **options))
        except WavesymError:
            continue
        return True
    return False


def test_the_table_has_all_there_are() -> None:
    every = {*topology._EVERY, *ALONE}
    assert TABLE.keys() == every
    assert all(len(marks) == 5 for marks in TABLE.values())
    assert {mark for marks in TABLE.values() for mark in marks} == {"x", "-"}


@pytest.mark.parametrize("name", TABLE)
def test_programs_take_what_the_table_says(name: str) -> None:
    *kinds, streamed, _ = TABLE[name]
    own = [accepted(kind, name) for kind in SYSTEMS]
    assert [mark == "x" for mark in kinds] == own
    streams = [accepted(kind, name, stream=True) for kind in SYSTEMS]
    simulated = [accepted(kind, name, target="fmu3") for kind in SYSTEMS]
    assert streams == simulated == [each and streamed == "x" for each in own]


def test_cases_of_a_sweep_share_what_the_table_says() -> None:
    """Of waves those in which cases are compared, of modes all numbers."""
    shared = {name for name, marks in TABLE.items() if marks[-1] == "x"}
    damped = Scene(name="damped", output=OUTPUT, system={"type": "chain", "parts": PARTS, "damping": "1/20"})
    assert shared == {*topology._EVERY, *names_of(lower(damped))}
