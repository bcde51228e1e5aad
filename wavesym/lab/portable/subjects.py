"""A program for each template of C: all that is proved, checked and compiled for other machines is one of these."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

from wavesym.programs.making import make
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.programs.stream.making import stream_program
from wavesym.programs.stream.plan import inputs_of
from wavesym.rendering import text_of
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes, sources
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
    """What is asked for of a built-in scene; `driver`, a file of templates/proof/, calls all that it exports.

    `precision` is that of the prover, from 0 to 11. Where the driver asks for samples, `counts` are the numbers of
    them, each in a run of its own.
    """

    template: str
    scene: str
    request: Request
    driver: str
    counts: tuple[int, ...] = ()
    changes: tuple[tuple[str, Any], ...] = ()
    precision: int = 2

    @property
    def name(self) -> str:
        """What the program is called, and its files begin with."""
        return f"{self.template}_{self.request.precision}"

    @property
    def single(self) -> PortableProgram:
        """The same in single precision."""
        return replace(self, request=replace(self.request, precision="single"))

    @property
    def asked(self) -> str:
        """The command that makes it, but for name and tolerance."""
        return f"generate {self.scene}{self.request.options}"

    @property
    def calls_exp(self) -> bool:
        """Whether the program needs <math.h>: closed forms do, no others."""
        return self.template == "closed"

    @property
    def called(self) -> tuple[str, ...]:
        """What the driver calls of it, without the program's name before it."""
        return tuple(dict.fromkeys(re.findall(r"\bname_(\w+)\(", text_of(f"proof/{self.driver}.c"))))

    def files(self) -> dict[str, str]:
        """NAME.h, NAME.c, NAME_selftest.c."""
        return {file: text for file, text in files(self._program()).items() if not file.endswith(".json")}

    def driven(self, count: int) -> str:
        """The driver for this program, as targets/c/kernel.py makes C of a kernel."""
        text = self.spelt(text_of(f"proof/{self.driver}.c").partition("\n\n")[2])
        return f'#include "{self.name}.h"\n#define COUNT {count}\n\n{text}'

    def spelt(self, text: str) -> str:
        """C for a program called `name`, with the name and the numbers of this one."""
        text = re.sub(r"\bname_real\b", "float" if self.request.precision == "single" else "double", text)
        return re.sub(r"\bname_", f"{self.name}_", re.sub(r"\bNAME_", f"{self.name.upper()}_", text))

    def _program(self) -> Program:
        request = self.request
        tolerance = _TOLERANCES[request.precision]
        changes = {"name": self.name, "output.tolerance": tolerance, **dict(self.changes)}
        scene = Scene.from_toml(self.scene).with_(changes)
        model = lower(scene)
        if request.stream:
            endless = replace(model, endless=True)
            return stream_program(endless, request, inputs_of(endless, sources(scene)), tested=True)
        if request.runtime:
            return runtime_program(model, request, amplitudes(scene), tested=True)
        return make(model, request, tested=True)


_CLOSED = PortableProgram("closed", "building_m2", Request("closed"), "values", (7,))
_PIECES = PortableProgram("pieces", "building_m2", Request("pieces"), "values", (7,))
_MARCH = PortableProgram("march", "building_m2", Request("march"), "values", (7,))
_DRIVEN = PortableProgram("march", "building_m2", Request("march"), "march")
_RINGS = PortableProgram("rings", "stepped_shaft", Request("march"), "values", (7,))
_MODES = PortableProgram(
    "modes", "building_m2", Request("modes"), "stream", changes=tuple(_SHAKEN.items()), precision=3
)
_STREAM = PortableProgram("stream", "building_m2", Request(stream=True), "stream")
_RUNTIME = PortableProgram("runtime", "building_m2", Request(runtime=("kappa", "load")), "runtime", (7,))

PROVED = (_CLOSED, _PIECES, _DRIVEN, _RINGS, _MODES, _STREAM)
CHECKED = (_CLOSED, _PIECES, _MARCH, _RINGS, _MODES, _STREAM, _RUNTIME)
COMPILED = (_STREAM, _PIECES.single, _MARCH.single)
