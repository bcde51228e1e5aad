"""A program for each template of C: all that is proved, checked and compiled for other machines is one of these."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wavesym import api
from wavesym.programs.program import Program
from wavesym.programs.request import PARTS, Request
from wavesym.scene import Scene
from wavesym.targets.files import files

_TOLERANCES = {"double": "1e-8", "single": "1/50"}
_SHAKEN: dict[str, Any] = {
    "system.base": "ground",
    "system.damping": "1/20",
    "load": [{"spacing": "1/2", "samples": [0, 1, -1, "1/2", "-1/4", 0]}],
    "output": {"until": 12, "strain": ["1/2"], "velocity": [2], "displacement": [2], "tolerance": "1/1000"},
}


@dataclass(frozen=True)
class PortableProgram:
    """What is asked for of a built-in scene; `driver`, a file of proof/, calls all that it exports.

    `effort` is the prover's, as in prove.py. Where the driver asks for samples, `counts` are the numbers of them, each
    in a run of its own. `highest` takes the place of the highest degree that the program would have.
    """

    template: str
    scene: str
    request: Request
    driver: str
    counts: tuple[int, ...] = ()
    changes: tuple[tuple[str, Any], ...] = ()
    effort: str = "usual"
    highest: int | None = None

    @property
    def name(self) -> str:
        """What the program is called, and its files begin with."""
        return f"{self.template}_{self.request.precision}"

    @property
    def single(self) -> PortableProgram:
        """The same in single precision."""
        return replace(self, request=replace(self.request, precision="single"))

    @property
    def generate_command(self) -> str:
        """The command that makes it, but for name and tolerance."""
        return f"generate {self.scene}{self.request.options()}"

    @property
    def calls_exp(self) -> bool:
        """Whether the program needs <math.h>: closed forms do, no others."""
        return self.template == "closed"

    @property
    def called_functions(self) -> tuple[str, ...]:
        """What the driver calls of it, without the program's name before it."""
        return tuple(dict.fromkeys(re.findall(r"\bname_(\w+)\(", self._driver)))

    @property
    def _driver(self) -> str:
        return Path(__file__).with_name("proof").joinpath(f"{self.driver}.c").read_text(encoding="utf-8")

    def files(self) -> dict[str, str]:
        """NAME.h, NAME.c, NAME_selftest.c."""
        return {file: text for file, text in files(self._program()).items() if not file.endswith(".json")}

    def driver_text(self, count: int) -> str:
        """The driver for this program, as targets/c/kernel.py makes C of a kernel."""
        text = self.instantiate(self._driver.partition("\n\n")[2])
        return f'#include "{self.name}.h"\n#define COUNT {count}\n\n{text}'

    def instantiate(self, text: str) -> str:
        """C for a program called `name`, with the name and the numbers of this one."""
        text = re.sub(r"\bname_real\b", "float" if self.request.precision == "single" else "double", text)
        return re.sub(r"\bname_", f"{self.name}_", re.sub(r"\bNAME_", f"{self.name.upper()}_", text))

    def _program(self) -> Program:
        request = self.request
        changes = {"name": self.name, **dict(self.changes)}
        if "tolerance" not in changes.get("output", {}):
            changes["output.tolerance"] = _TOLERANCES[request.precision]
        scene = Scene.from_toml(self.scene).with_(changes)
        program = api.program(scene, request, tested=True)
        if request.runtime and not request.stream and self.highest:
            return replace(program, constants=program.constants | {"degree": self.highest})
        return program


_BUILDING = "building_m2"
_COUNTS = (0, 1, 7)
_CLOSED = PortableProgram("closed", _BUILDING, Request("closed"), "values", _COUNTS)
_PIECES = PortableProgram("pieces", _BUILDING, Request("pieces"), "values", (*_COUNTS, 5))  # blocks of 4, read plainly
_MARCH = PortableProgram("march", _BUILDING, Request("march"), "values", (1,), effort="followed")
_BLOCKS_MARCH = PortableProgram(
    "blocks", "damped_building", Request("march"), "values", _COUNTS, (("output.until", 6),), effort="more"
)
_MODES = PortableProgram("modes", _BUILDING, Request("modes"), "steps", changes=tuple(_SHAKEN.items()), effort="more")
_MODES_SINGLE = replace(
    _MODES.single, changes=tuple({**_SHAKEN, "output": {**_SHAKEN["output"], "tolerance": "1/50"}}.items())
)
_STREAM = PortableProgram("stream", _BUILDING, Request(stream=True), "stream", effort="made")
_TUNED = PortableProgram(
    "tuned", "drive_equal", Request(stream=True, runtime=("kappa", "inertia")), "tuned", effort="made"
)
_RUNTIME = PortableProgram(
    "runtime", _BUILDING, Request(runtime=("kappa", "load"), parts=PARTS), "runtime", (7,), effort="bounds"
)
_JOINTS = PortableProgram(
    "joints",
    "stepped_shaft",
    Request(runtime=("mass", "impedance", "load"), parts=PARTS),
    "runtime",
    (7,),
    effort="bounds",
)

# short, of low degree: each way through the same C can be followed to its end
_SHORT: tuple[tuple[str, Any], ...] = (
    ("output", {"until": 2, "strain": ["1/2"], "velocity": [2], "displacement": ["3/2"]}),
    ("load", [{"times": [0, "3/2"], "a": [1, 0], "b": [0, -1]}]),
)
_BLOCKS = (0, 1, 7, 17)  # blocks of 16
_BRIEF_MARCH = PortableProgram("march_brief", _BUILDING, Request("march"), "values", (0, 1, 7), _SHORT, "followed")
_BRIEF = PortableProgram(
    "runtime_brief",
    _BUILDING,
    Request(runtime=("load",), parts=PARTS),
    "runtime",
    _BLOCKS,
    (*_SHORT, ("system.kappa", [3, 2, 3])),
    "unrolled",
)
# two masses on a spring at the end of a rod; degrees of chains go to 24 and more, which is too many to follow
_SPRUNG: tuple[tuple[str, Any], ...] = (
    (
        "system.parts",
        [
            {"mass": 1, "name": "disc"},
            {"spring": "1/2", "dashpot": "1/8"},
            {"mass": 1, "name": "hub"},
            {"rod": 1},
            {"joint": True, "dashpot": "1/8", "name": "brake"},
        ],
    ),
    ("output", {"until": "3/2", "velocity": ["disc"], "displacement": ["hub"]}),
    ("load", [{"at": "disc", "times": [0, "1/2"], "steps": [1, 0], "ramps": [0, -1]}]),
)
_BRIEF_JOINTS = PortableProgram(
    "joints_brief",
    "stepped_shaft",
    Request(runtime=("load",), parts=PARTS),
    "runtime",
    (17,),
    _SPRUNG,
    "equal",
    highest=10,
)
# of one degree alone, where two are too many
_LEVEL_JOINTS = replace(_BRIEF_JOINTS, template="joints_level", effort="unrolled", highest=8)

PROVED = (
    _CLOSED,
    _CLOSED.single,
    _PIECES,
    _PIECES.single,
    _MARCH,
    _BRIEF_MARCH,
    _BRIEF_MARCH.single,
    _BLOCKS_MARCH,
    _BLOCKS_MARCH.single,
    _MODES,
    _MODES_SINGLE,
    _STREAM,
    _STREAM.single,
    _TUNED,
    _TUNED.single,
    _RUNTIME,
    _RUNTIME.single,
    _BRIEF,
    _BRIEF.single,
    *(
        replace(_BRIEF, driver=driver, counts=counts)
        for driver, counts in (("tangent", (7,)), ("bound", ()), ("batch", ()), ("misfit", (2,)))
    ),
    _JOINTS,
    _JOINTS.single,
    _BRIEF_JOINTS,
    _BRIEF_JOINTS.single,
    *(replace(_BRIEF_JOINTS, driver=driver, counts=()) for driver in ("bound", "batch")),
    *(replace(_LEVEL_JOINTS, driver=driver, counts=counts) for driver, counts in (("tangent", (7,)), ("misfit", (2,)))),
)
CHECKED = (_CLOSED, _PIECES, _MARCH, _BLOCKS_MARCH, _MODES, _STREAM, _TUNED, _RUNTIME, _JOINTS)
COMPILED = tuple(
    program for double in CHECKED for program in (double, _MODES_SINGLE if double is _MODES else double.single)
)
