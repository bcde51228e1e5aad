"""FMUs driven call by call, the same way for both versions, by fmpy, which shares no code with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import wavesym
from wavesym.running import fmu

VERSIONS = ("fmu2", "fmu3")
needs_fmpy = pytest.mark.skipif(not find_spec("fmpy"), reason="no fmpy here (make check-all installs it)")


def made(scene: wavesym.Scene, folder: Path, version: str, *, host: bool = True, **options: Any) -> Path:
    """The FMU of a scene; for this machine alone, by its own compiler, which takes less time."""
    with pytest.MonkeyPatch.context() as patch:
        if host:
            patch.setattr(fmu, "at_hand", lambda names: [])
        (path,) = wavesym.generate(scene, folder, target=version, **options)
    return path


class Instance:
    """An FMU that is running. Values go by name."""

    def __init__(self, path: Path, folder: Path) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        if not folder.exists():
            extract(path, folder)
        self.description = read_model_description(path)
        self.references = {one.name: one.valueReference for one in self.description.modelVariables}
        self.two = self.description.fmiVersion == "2.0"
        slave = FMU2Slave if self.two else FMU3Slave
        self.slave = slave(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.said: list[str] = []
        self.slave.instantiate(loggingOn=False, **self._logger())  # what is refused is told all the same

    def _logger(self) -> dict[str, Any]:
        if not self.two:
            return {"logMessage": lambda _, status, category, message: self.said.append(message.decode())}
        from fmpy.fmi2 import (
            calloc,
            fmi2CallbackAllocateMemoryTYPE,
            fmi2CallbackFreeMemoryTYPE,
            fmi2CallbackFunctions,
            fmi2CallbackLoggerTYPE,
            free,
        )

        # the text is an argument of a format that ctypes does not show: it is known that something was said
        def log(_, name, status, category, message):
            self.said.append(category.decode())

        self._calls = fmi2CallbackFunctions()
        self._calls.logger = fmi2CallbackLoggerTYPE(log)
        self._calls.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self._calls.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        return {"callbacks": self._calls}

    def begin(self, inputs: Mapping[str, float] = {}, start: float = 0.0, stop: float | None = None, **linear: bool):
        """Through initialization."""
        if self.two:
            self.slave.setupExperiment(startTime=start, stopTime=stop)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=start, stopTime=stop)
        for name, value in linear.items():
            self.slave.setBoolean([self.references[name]], [value])
        self.put(inputs)
        self.slave.exitInitializationMode()
        return self

    def put(self, values: Mapping[str, float]) -> None:
        """Set numbers."""
        setter = self.slave.setReal if self.two else self.slave.setFloat64
        setter([self.references[name] for name in values], list(values.values()))

    def get(self, names: Sequence[str]) -> list[float]:
        """Numbers."""
        getter = self.slave.getReal if self.two else self.slave.getFloat64
        return getter([self.references[name] for name in names])

    def step(self, at: float, length: float) -> None:
        """On by a step."""
        self.slave.doStep(at, length)

    def keep(self) -> Any:
        """Its state."""
        return self.slave.getFMUstate() if self.two else self.slave.getFMUState()

    def back(self, state: Any) -> None:
        """To a state that was kept."""
        (self.slave.setFMUstate if self.two else self.slave.setFMUState)(state)

    def bytes_of(self, state: Any) -> bytes:
        """A state as bytes."""
        return (self.slave.serializeFMUstate if self.two else self.slave.serializeFMUState)(state)

    def of_bytes(self, kept: bytes) -> Any:
        """And back."""
        return (self.slave.deSerializeFMUstate if self.two else self.slave.deserializeFMUState)(kept)

    def end(self) -> None:
        """Free it; the library stays."""
        free = self.slave.fmi2FreeInstance if self.two else self.slave.fmi3FreeInstance
        free(self.slave.component)


def broken(path: Path, folder: Path, right: str, wrong: str) -> Path:
    """An FMU built anew from its sources, with a fault in them; extracted in `folder`."""
    from fmpy import extract

    from wavesym.running.toolchain import compiler

    extract(path, folder)
    sources = folder / "sources"
    (main,) = sources.glob("fmi?.c")
    text = (sources / "simulation.h").read_text()
    assert text.count(right) == 1
    (sources / "simulation.h").write_text(text.replace(right, wrong))
    (library,) = (folder / "binaries").rglob("*.so")
    library.unlink()
    names = [main.name, f"{library.stem}.c"]
    compiler().run(["-std=c99", "-O1", "-shared", "-fPIC", "-w", *names, "-o", str(library), "-lm"], sources)
    return path
