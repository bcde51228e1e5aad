"""What is in an FMU: texts that are the same everywhere, C without a warning, and honest words on what is fixed."""

import shutil
import sys
import xml.etree.ElementTree as ElementTree
from functools import cache
from pathlib import Path
from zipfile import ZipFile

import pytest

import wavesym
from tests.support.builds import LANGUAGES, STRICT, needs_zig
from tests.support.fmus import VERSIONS, made, needs_fmpy
from tests.test_documents import ROOT
from wavesym import api
from wavesym.cli import main
from wavesym.errors import WavesymError
from wavesym.programs.request import Request
from wavesym.running import fmu, toolchain
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.scene import Scene
from wavesym.targets.files import fmu_files

GEARED = Scene(
    name="geared",
    system={"type": "drive", "m": 1, "kappa": ["3/4"], "inertia": [1, 2]},
    load=[{"body": 2, "times": [0], "steps": [1]}],
    output={"until": 4, "tolerance": "1e-9", "strain": ["1/2"], "acceleration": [1]},
)


@cache
def program():
    return api.program(GEARED, Request(stream=True, target="fmu3"))


@cache
def texts(version):
    return fmu_files(program(), version)


def variables(version):
    root = ElementTree.fromstring(texts(version)["modelDescription.xml"])
    return root, {one.get("name"): one for one in root.find("ModelVariables")}


@pytest.mark.parametrize("version", VERSIONS)
def test_the_description_says_what_there_is(version):
    root, found = variables(version)
    assert list(found) == [
        *("time", "load@M2", "strain@1/2", "acceleration@1", "lost", "panel"),
        *("kappa_1", "inertia_1", "inertia_2", "linear"),
    ]
    assert [one.get("valueReference") for one in found.values()] == [str(k) for k in range(10)]
    assert {name for name, one in found.items() if one.get("variability") == "constant"} == {"panel"}
    settable = {name for name, one in found.items() if one.get("causality") == "parameter"}
    assert settable == {"kappa_1", "inertia_1", "inertia_2", "linear"}
    assert {one.get("variability") for name, one in found.items() if name in settable} == {"fixed"}
    starts = [(one if version == "fmu3" else one[0]).get("start") for name, one in found.items() if name in settable]
    assert starts == ["0.75", "1.0", "2.0", "false"]
    sha = program().provenance.model.labels.sha256
    assert root.get("guid" if version == "fmu2" else "instantiationToken") == sha
    assert f'SCENE_SHA256 "{sha}"' in texts(version)["sources/geared.h"]
    assert "command: wavesym generate geared.toml --target fmu3\n" in texts(version)["sources/geared.h"]
    experiment = root.find("DefaultExperiment")
    assert (experiment.get("stopTime"), experiment.get("stepSize")) == ("4", "0.125")
    assert "dimensionless" in root.get("description")


@pytest.mark.parametrize("version", VERSIONS)
def test_what_loads_act_on_at_once_is_a_dependency(version):
    root, _ = variables(version)
    structure = root.find("ModelStructure")
    if version == "fmu2":
        outputs = [(int(one.get("index")) - 1, one.get("dependencies")) for one in structure.find("Outputs")]
        assert outputs == [(2, ""), (3, "2")]
    else:
        outputs = [(int(one.get("valueReference")), one.get("dependencies")) for one in structure.findall("Output")]
        assert outputs == [(2, ""), (3, "1")]


def strict(version, folder, language="c99"):
    """Compile the wrapper, all warnings on."""
    for place, text in texts(version).items():
        if place.startswith("sources/"):
            (folder / Path(place).name).write_text(text)
    compiler().run([*LANGUAGES[language], *STRICT, "-O2", "-c", f"fmi{version[-1]}.c", "-o", "made.o"], folder)


@pytest.mark.parametrize(
    "language", ["c99", *(pytest.param(name, marks=pytest.mark.slow) for name in LANGUAGES if name != "c99")]
)
@pytest.mark.parametrize("version", VERSIONS)
def test_the_wrapper_compiles_without_a_warning(version, language, tmp_path):
    strict(version, tmp_path, language)
    assert (tmp_path / "made.o").stat().st_size > 0


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_several_models_go_into_one_program(version, tmp_path):
    """By a prefix to all names, as the standard has it for sources."""
    strict(version, tmp_path)
    number = version[-1]
    prefix = f"-DFMI{number}_FUNCTION_PREFIX=geared_"
    compiler().run([*LANGUAGES["c99"], *STRICT, prefix, "-c", f"fmi{number}.c", "-o", "named.o"], tmp_path)
    named = (tmp_path / "named.o").read_bytes()
    assert f"\0geared_fmi{number}DoStep\0".encode() in named
    assert f"\0fmi{number}DoStep\0".encode() not in named


@needs_fmpy
@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_our_headers_agree_with_those_of_the_standard(version, tmp_path):
    """The wrapper compiled with the headers that fmpy has: every function is one that they declare, and as they do."""
    import fmpy

    number = version[-1]
    strict(version, tmp_path)
    theirs = Path(fmpy.__file__).parent / "c-code"
    shim = f'#include "fmi{number}Functions.h"\n#define FMI{number}(name) name\n'
    shim += f"#define FMI{number}_FUNCTION(type, name, parameters) type name parameters\n"
    if number == "3":
        typed = "(fmi3Instance it, const fmi3ValueReference reference[], size_t references, "
        shim += f"#define FMI3_GET(type) fmi3Status fmi3Get##type{typed}fmi3##type value[], size_t count)\n"
        shim += f"#define FMI3_SET(type) fmi3Status fmi3Set##type{typed}const fmi3##type value[], size_t count)\n"
    (tmp_path / f"fmi{number}.h").write_text(shim)
    command = [*LANGUAGES["c11"], "-Werror", f"-I{theirs}", "-c", f"fmi{number}.c", "-o", "theirs.o"]
    compiler().run(command, tmp_path)
    source = tmp_path / f"fmi{number}.c"
    source.write_text(source.read_text().replace("size_t *size)", "int *size)"))
    with pytest.raises(CompilerError, match="conflicting types"):
        compiler().run(command, tmp_path)


@pytest.mark.parametrize("name", ["fmi2.c", "fmi2.h", "fmi3.c", "fmi3.h", "simulation.h"])
def test_what_no_scene_changes_is_shipped_as_it_stands(name):
    assert texts(f"fmu{name[3]}" if name != "simulation.h" else "fmu2")[f"sources/{name}"] == (
        ROOT / "templates" / "fmu" / name
    ).read_text(encoding="utf-8")


REFUSED = {
    "language": ({"language": "numpy"}, "language: numpy does not go with --target; write c"),
    "precision": ({"precision": "single"}, "precision: single does not go with --target; write double"),
    "runtime": ({"runtime": ["load"]}, "--runtime: load, but the inputs of a stream are its loads"),
    "modes": (
        {"runtime": ["kappa"], "evaluator": "modes"},
        "runtime: kappa is unknown; write stiffness",
    ),
    "package": ({"package": True}, "--package: True does not go with --target; leave it out"),
    "evaluator": ({"evaluator": "march"}, "--evaluator: march does not go with --stream; write auto"),
    "target": ({"target": "fmu1"}, "target: fmu1 is unknown; write fmu2 or fmu3"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_served_is_refused_in_one_line(case, tmp_path):
    options, said = REFUSED[case]
    with pytest.raises(WavesymError, match=said) as refused:
        wavesym.generate(GEARED, tmp_path / "made", **{"target": "fmu2"} | options)
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "made").exists()


def test_check_has_nothing_to_compare(capsys):
    assert main(["generate", "drive_m1", "--target", "fmu2", "--check"]) == 2
    assert "--check: binaries of --target fmu2 differ by compiler" in capsys.readouterr().err


def test_without_any_compiler_it_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr(toolchain, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(CompilerError, match="no C compiler"):
        wavesym.generate(GEARED, tmp_path / "made", target="fmu2")


@pytest.mark.slow
def test_the_hosts_own_compiler_is_said_in_one_line(tmp_path):
    """Times in the file are fixed; a file of somebody else is not replaced."""
    path = made(GEARED, tmp_path, "fmu3")
    (binaries, reason) = fmu.describe_fmu(path)
    own = fmu._host().fmi3
    assert binaries == f"binaries for {own}; pip install ziglang helps to have linux64, aarch64 and win64"
    assert reason.startswith("march as a stream")
    with ZipFile(path) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert archive.infolist()[0].filename == "modelDescription.xml"
        assert f"binaries/{own}/geared{fmu._host().suffix}" in archive.namelist()
    made(GEARED, tmp_path, "fmu3")  # our own is replaced
    path.write_bytes(b"PK of somebody else")
    with pytest.raises(WavesymError, match="was not written by wavesym"):
        made(GEARED, tmp_path, "fmu3")


@needs_zig
@pytest.mark.slow
def test_zig_builds_for_three_machines(tmp_path):
    """By what their headers say they are for, by the functions they show, and by the glibc they need."""
    path = made(GEARED, tmp_path, "fmu2", host=False)
    with ZipFile(path) as archive:
        archive.extractall(tmp_path)
    folder = tmp_path / "binaries"
    linux, arm = ((folder / name / "geared.so").read_bytes() for name in ("linux64", "aarch64-linux"))
    windows = (folder / "win64" / "geared.dll").read_bytes()
    assert (linux[:5], linux[18:20]) == (b"\x7fELF\x02", b"\x3e\x00")
    assert (arm[:5], arm[18:20]) == (b"\x7fELF\x02", b"\xb7\x00")
    assert windows[:2] == b"MZ"
    place = int.from_bytes(windows[60:64], "little")
    assert windows[place : place + 6] == b"PE\x00\x00\x64\x86"
    for library in (linux, arm, windows):
        assert b"fmi2DoStep" in library
        assert b"stream_step" not in library
        assert str(tmp_path).encode() not in library
    needed = {
        int(word.split(b"\0")[0].split(b".")[1]) for word in linux.split(b"GLIBC_2.")[1:] for word in [b"2." + word]
    }
    assert needed
    assert max(needed) <= 17


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("nm") or sys.platform != "linux", reason="no nm here")
@pytest.mark.parametrize("version", VERSIONS)
def test_nothing_but_functions_of_fmi_is_shown(version, tmp_path):
    import subprocess

    with ZipFile(made(GEARED, tmp_path, version)) as archive:
        archive.extractall(tmp_path)
    (library,) = (tmp_path / "binaries").rglob("*.so")
    listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    names = [line.split()[-1] for line in listed.splitlines()]
    assert names
    assert all(name.startswith(f"fmi{version[-1]}") for name in names)
