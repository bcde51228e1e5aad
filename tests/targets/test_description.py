"""What generated files say of themselves: rows by name, the command that makes them again, loads in a few lines."""

import json
import re
import shlex
import subprocess

import pytest

from tests.support.generated import files
from wavesym.cli import main
from wavesym.running.compilation import FLAGS, import_text
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower
from wavesym.targets.description import constants


def building(load, **output):
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}
    return Scene(name="made", system=system, load=load, output={"until": 3, "tolerance": "1e-6", **output})


PUSH = [{"times": [0], "a": [1], "b": [0]}]


def test_constants_are_identifiers_and_differ():
    names = ["strain@0.5", "strain@1+", "strain@1-", "velocity@1/2", "velocity@1.2", "velocity@1e-9", "displacement@-0"]
    found = constants(names)
    assert found[:4] == ["STRAIN_0_5", "STRAIN_1_PLUS", "STRAIN_1_MINUS", "VELOCITY_1_2"]
    assert len(set(found)) == len(names)
    assert all(re.fullmatch(r"[A-Z][A-Z0-9_]*", name) for name in found)


def test_a_row_is_that_of_its_name_in_c_and_in_numpy(tmp_path):
    """The scene lists them in another order than they come in."""
    scene = building(PUSH, displacement=[2], strain=["1+", "0.5"], velocity=[1])
    made = files(lower(scene), "all")
    rows = {"DISPLACEMENT_2": "displacement@2", "STRAIN_1_PLUS": "strain@1+", "STRAIN_0_5": "strain@0.5"}
    module = import_text(made["made.py"], "made")
    program = "".join(f"    puts(made_output_name[MADE_{row}]);\n" for row in rows)
    main_c = f'#include "made.h"\n#include <stdio.h>\nint main(void)\n{{\n{program}    return 0;\n}}\n'
    for file, text in {**made, "main.c": main_c}.items():
        (tmp_path / file).write_text(text)
    compiler().run([*FLAGS, "main.c", "made.c", "-o", "main", "-lm"], tmp_path)
    told = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout.split()
    assert told == list(rows.values())
    assert [module.OUTPUTS[getattr(module, row)] for row in rows] == list(rows.values())


@pytest.mark.parametrize("options", [[], ["--evaluator", "march"], ["--precision", "single", "--evaluator", "pieces"]])
def test_the_command_in_a_file_makes_it_again(options, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "made.toml").write_text(
        """name = "made"
[system]
type = "drive"
m = 1
kappa = [1]
inertia = [1, 2]
[[load]]
body = 1
times = [0]
steps = [1]
[output]
until = 3
tolerance = 1e-4
strain = [0.5]
"""
    )
    assert main(["generate", "made.toml", "--language", "all", *options]) == 0
    first = {path.name: path.read_bytes() for path in (tmp_path / "made").iterdir()}
    (told,) = re.findall(rb"made by wavesym, command: (.*)", first["made.h"])
    assert (told,) == tuple(re.findall(rb"made by wavesym, command: (.*)", first["made.py"]))
    assert json.loads(first["made.json"])["command"] == told.decode()
    word, *arguments = shlex.split(told.decode())
    assert word == "wavesym"
    assert main([*arguments, "--language", "all", "-o", "again"]) == 0
    assert {path.name: path.read_bytes() for path in (tmp_path / "again").iterdir()} == first
    capsys.readouterr()


@pytest.mark.slow
def test_long_loads_take_a_line():
    record = [{"spacing": "1/100", "samples": [0, *(k % 7 - 3 for k in range(250))]}]
    header = files(lower(building(record, strain=["0.5"])), evaluator="pieces")["made.h"]
    assert "acceleration of the base: 251 samples at 1/100, to tau = 5/2" in header
    assert len(header.splitlines()) < 70
    assert "acceleration of the base: 1 a at 0\n" in files(lower(building(PUSH, strain=["0.5"])))["made.h"]
    many = [{"times": [f"{k}/100" for k in range(1, 200)], "a": [1] * 199, "b": [0] * 199}]
    assert (
        "acceleration of the base: 199 changes from tau = 1/100 to 199/100"
        in files(lower(building(many, strain=["0.5"])))["made.h"]
    )
