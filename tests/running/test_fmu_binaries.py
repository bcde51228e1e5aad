"""Binaries in FMUs run: each by a small program of its machine, by an emulator where that is not this machine."""

import os
import platform
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest

import wavesym
from tests.running.test_fmu_simulated import GEARS
from tests.support.fmus import VERSIONS, made
from wavesym.running import toolchain
from wavesym.running.fmu import MACHINES, Machine

pytestmark = pytest.mark.slow

LINUX, ARM, WINDOWS = MACHINES
MAIN = Path(__file__).parents[1] / "support" / "fmu_main.c"
ARM_ROOT = Path("/usr/aarch64-linux-gnu")  # where Debian's libc6-arm64-cross has a C library
STEPS, LENGTH = 24, 0.25


def wine() -> str | None:
    """Debian keeps it where no PATH looks, when nothing but the 64 bits of it is installed."""
    return shutil.which("wine64") or shutil.which("wine") or shutil.which("wine64", path="/usr/lib/wine")


def runner(machine: Machine) -> list[str]:
    """What runs a program of a machine here; the test is skipped where nothing does."""
    if machine is LINUX:
        if (sys.platform, platform.machine()) != ("linux", "x86_64"):
            pytest.skip("this is no Linux on x86_64")
        return []
    if machine is ARM:
        qemu = shutil.which("qemu-aarch64-static") or shutil.which("qemu-aarch64")
        if not qemu or not ARM_ROOT.exists():
            pytest.skip("no qemu-aarch64 here, or no C library for it (qemu-user-static and libc6-arm64-cross)")
        return [qemu, "-L", str(ARM_ROOT)]
    if not (found := wine()):
        pytest.skip("no wine here (wine64)")
    return [found]


@pytest.fixture(scope="module", params=VERSIONS)
def packed(request, tmp_path_factory):
    """An FMU with binaries for all machines, extracted."""
    if not toolchain.at_hand(()):
        pytest.skip("no zig here")
    folder = tmp_path_factory.mktemp(request.param)
    with ZipFile(made(GEARS, folder, request.param, host=False)) as archive:
        archive.extractall(folder)
    return folder, request.param


@pytest.fixture(scope="module")
def apart(tmp_path_factory):
    """Where wine keeps what it makes, which takes it long: not in anybody's home."""
    return os.environ | {"WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all", "DISPLAY": ""}


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.fmi3)
def test_a_binary_does_what_the_scene_says(packed, machine, apart, tmp_path):
    """With another kappa than the scene's, under a load from the start on."""
    command = runner(machine)
    folder, version = packed
    root = ElementTree.parse(folder / "modelDescription.xml").getroot()
    variables = {one.get("name"): one for one in root.find("ModelVariables")}
    outputs = [int(one.get("valueReference")) for one in variables.values() if one.get("causality") == "output"]
    assert outputs == list(range(outputs[0], outputs[-1] + 1))
    program = tmp_path / f"main{'.exe' if machine is WINDOWS else ''}"
    (zig,) = toolchain.at_hand(())
    flags = ["-std=gnu99", "-O1", f"-DVERSION={version[-1]}", f"-I{folder / 'sources'}", "-target", machine.zig]
    zig.run([*flags, str(MAIN), "-o", str(program), *(() if machine is WINDOWS else ("-ldl",))], tmp_path)
    library = folder / "binaries" / machine.folder(version) / f"gears{machine.suffix}"
    reference = {name: variables[name].get("valueReference") for name in ("kappa_1", "load@M1")}
    token = root.get("guid") or root.get("instantiationToken")
    given = [token, reference["kappa_1"], "3", reference["load@M1"], "1.5", str(outputs[0]), str(len(outputs))]
    done = subprocess.run(
        [*command, program, library, *given, str(STEPS), str(LENGTH)],
        env=apart,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])
    held = [{"body": 1, "times": [0], "steps": ["3/2"]}]
    true = wavesym.evaluator(GEARS.with_({"system.kappa": [3, "1/2"], "load": held}))
    values = true(LENGTH * np.arange(1, STEPS + 1))
    assert np.max(np.max(np.abs(found.T - values), axis=1) / np.max(np.abs(values), axis=1)) < 1e-12
