"""FMUs stepped as a simulator steps them: their C compiled for this machine, and called through FMI 2.0 and 3.0.

What variables are called by is read from the model description, and nothing else of the program is known.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from ctypes import byref, c_bool, c_double, c_int, c_size_t, c_uint32, c_void_p
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.numbers.doubles import fraction
from wavesym.programs.program import Program
from wavesym.running.toolchain import compiler
from wavesym.targets.files import fmu_files

_FLAGS = ("-std=c99", "-O1")
_CO_SIMULATION = 1


class CoSimulation:
    """An instance of an FMU, stepped as a compiled stream is; `status` is the largest that a call has returned.

    That is 0, 1 for a warning (more may be lost than the tolerance), or 3 for what is refused.

    Args:
        library: what its C was compiled to.
        description: the text of its modelDescription.xml.
        seconds: one tau in the simulator's unit of time.
        linear: whether loads go in straight lines to their values at the end of a step; else steps hold them.
    """

    def __init__(self, library: ctypes.CDLL, description: str, seconds: Fraction, *, linear: bool) -> None:
        root = ElementTree.fromstring(description)
        self._library, self._two = library, root.attrib["fmiVersion"] == "2.0"
        self._seconds, self._linear = seconds, linear
        self._tau, self._time, self._begun, self.status = Fraction(0), 0.0, False, 0
        variables = root.findall("ModelVariables/*")
        self._references = {one.attrib["name"]: int(one.attrib["valueReference"]) for one in variables}
        self._inputs, self._outputs = (
            [int(one.attrib["valueReference"]) for one in variables if one.attrib["causality"] == kind]
            for kind in ("input", "output")
        )
        token = root.attrib["guid" if self._two else "instantiationToken"]
        self._instance = c_void_p(self._instantiate(token.encode()))

    def step(self, dtau: float, loads: ArrayLike) -> NDArray[np.float64]:
        """All outputs after dtau, in which loads go straight to `loads`, or jump to them where it is 0.

        In straight lines they jump before the first step alone.
        """
        if dtau and not self._begun:
            self._begin()
        self._numbers("Set", self._inputs, np.array(loads, np.float64))
        self._tau += Fraction(dtau)
        if dtau:
            self._advance(float(self._tau * self._seconds))
        return self._numbers("Get", self._outputs, np.empty(len(self._outputs)))

    @property
    def lost(self) -> float:
        """What it says that polynomials have lost so far, relative to the largest wave."""
        return float(self._numbers("Get", [self._references["lost"]], np.empty(1))[0])

    def free(self) -> None:
        """Give back its memory."""
        self._library[f"fmi{2 if self._two else 3}FreeInstance"](self._instance)

    # calls of FMI

    def _instantiate(self, token: bytes) -> int | None:
        function = self._library["fmi2Instantiate" if self._two else "fmi3InstantiateCoSimulation"]
        function.restype = c_void_p
        if self._two:
            made = function(b"verified", c_int(_CO_SIMULATION), token, None, None, c_int(0), c_int(0))
        else:
            no, none = c_bool(False), c_void_p(None)
            made = function(b"verified", token, none, no, no, no, no, none, c_size_t(0), none, none, none)
        found: int | None = made
        return found

    def _begin(self) -> None:
        """Leave initialization, in which loads have got the values that they jump to at the start."""
        self._begun = True
        boolean = c_int if self._two else c_bool
        reference, linear = c_uint32(self._references["linear"]), boolean(self._linear)
        self._call("SetBoolean", byref(reference), c_size_t(1), byref(linear), *self._count(1))
        no, start = boolean(False), c_double(0)
        if self._two:
            self._call("SetupExperiment", no, start, start, no, start)
            self._call("EnterInitializationMode")
        else:
            self._call("EnterInitializationMode", no, start, start, no, start)
        self._call("ExitInitializationMode")

    def _advance(self, then: float) -> None:
        at, length = c_double(self._time), c_double(then - self._time)
        if self._two:
            self._call("DoStep", at, length, c_int(True))
        else:
            flags, last = [c_bool() for _ in range(3)], c_double()
            self._call("DoStep", at, length, c_bool(True), *map(byref, flags), byref(last))
        self._time = then

    def _numbers(self, verb: str, references: Sequence[int], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Set or get numbers by their references."""
        numbers = np.array(references, np.uint32)
        kind, count = "Real" if self._two else "Float64", len(numbers)
        places = c_void_p(numbers.ctypes.data), c_size_t(count), c_void_p(values.ctypes.data)
        self._call(f"{verb}{kind}", *places, *self._count(count))
        return values

    def _count(self, count: int) -> tuple[c_size_t, ...]:
        """How many values there are, which FMI 3 wants to know beside how many references."""
        return () if self._two else (c_size_t(count),)

    def _call(self, name: str, *given: object) -> None:
        function = self._library[f"fmi{2 if self._two else 3}{name}"]
        self.status = max(self.status, int(function(self._instance, *given)))


@contextmanager
def compile_fmu(program: Program, version: str, *, linear: bool) -> Iterator[CoSimulation]:
    """An instance of the FMU of a stream, compiled in a directory that goes when this is closed.

    Args:
        program: the stream.
        version: "fmu2" or "fmu3".
        linear: whether loads go in straight lines.

    Raises:
        CompilerError: there is no compiler, or it does not accept the sources.
    """
    files, clock = fmu_files(program, version), program.provenance.model.clock
    sources = {Path(place).name: text for place, text in files.items() if place.startswith("sources/")}
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        for name, text in sources.items():
            (folder / name).write_text(text, encoding="utf-8")
        compiled = sorted(name for name in sources if name.endswith(".c"))
        compiler().run([*_FLAGS, "-fPIC", "-shared", *compiled, "-o", "library.so", "-lm"], folder)
        library, seconds = ctypes.CDLL(str(folder / "library.so")), fraction(clock.seconds) if clock else Fraction(1)
        simulation = CoSimulation(library, files["modelDescription.xml"], seconds, linear=linear)
        yield simulation
        simulation.free()
