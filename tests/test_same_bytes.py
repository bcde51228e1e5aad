"""The same request gives the same bytes whatever the environment, and no trace of it."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCENE = """name = "mine"
system = {type = "building", m = 3, kappa = ["1/4", "3/5", 1, "2/7"], base = "ground"}
load = [{times = [0, "5/2"], a = [1, 0], b = [0, "-1/3"]}, {spacing = "1/4", samples = [0, 0.1, -0.2]}]
output = {until = 2, tolerance = 1e-5, strain = [0.5, "1+"], velocity = [1.5], displacement = [3]}
"""
REQUESTS = [
    ["generate", "SCENE", "-o", "out", "--language", "all"],
    ["generate", "SCENE", "-o", "single", "--precision", "single"],
    ["tables", "SCENE", "--intervals", "3", "-o", "table.csv"],
    ["tables", "SCENE", "--intervals", "2", "--symbolic", "--format", "json"],
    ["derive", "SCENE", "--format", "latex"],
    ["derive", "building", "--m", "2"],
    ["derive", "drive", "--format", "json"],
]
CODE = f"""
import sys
from wavesym.cli import main
for request in {REQUESTS!r}:
    assert main([sys.argv[1] if word == "SCENE" else word for word in request]) == 0
"""

PLAIN = {"PYTHONHASHSEED": "1", "LC_ALL": "C", "TZ": "UTC", "COLUMNS": "40"}
OTHERS = [
    {"PYTHONHASHSEED": "2", "LC_ALL": "de_DE.UTF-8", "TZ": "Asia/Kathmandu", "COLUMNS": "200", "HOSTNAME": "elsewhere"},
    {
        "PYTHONHASHSEED": "3",
        "LANG": "C.UTF-8",
        "TZ": "America/St_Johns",
        "PYTHONIOENCODING": "latin-1",
        "USER": "nobody",
    },
    {"PYTHONHASHSEED": "0", "LANG": "C", "COLUMNS": "1", "LINES": "1", "SOURCE_DATE_EPOCH": "0", "PYTHONUTF8": "0"},
]


def given(folder: Path, changes: dict[str, str]) -> dict[str, bytes]:
    """All that REQUESTS print and write in a folder, under a changed environment."""
    folder.mkdir(parents=True)
    scene = folder / "scene" / "mine.toml"
    scene.parent.mkdir()
    scene.write_text(SCENE)
    kept = {
        key: value for key, value in os.environ.items() if key not in ("LANG", "LC_ALL", "LANGUAGE", "COLUMNS", "TZ")
    }
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(scene)], cwd=folder, env=kept | changes, capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
    shutil.rmtree(scene.parent)
    files = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return files | {"<stdout>": done.stdout, "<stderr>": done.stderr}


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return given(tmp_path_factory.mktemp("plain") / "here", PLAIN)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "changes",
    OTHERS,
    ids=lambda changes: changes["PYTHONHASHSEED"],
)
def test_the_environment_leaves_no_trace(plain: dict[str, bytes], tmp_path: Path, changes: dict[str, str]) -> None:
    other = given(tmp_path / "another folder" / "\u00e9", changes)
    assert other.keys() == plain.keys()
    assert [name for name in plain if plain[name] != other[name]] == []
    assert len(plain) == 12


# each locale with each of every other choice, and these among themselves
MIXTURES = [
    ("C", "1", "Asia/Kathmandu", "200"),
    ("C", "2", "UTC", "40"),
    ("C.UTF-8", "1", "UTC", "200"),
    ("C.UTF-8", "2", "Asia/Kathmandu", "40"),
    ("de_DE.UTF-8", "1", "Asia/Kathmandu", "40"),
    ("de_DE.UTF-8", "2", "UTC", "200"),
]


@pytest.mark.slow
@pytest.mark.parametrize("mixture", MIXTURES, ids="-".join)
def test_mixtures_of_environments(plain: dict[str, bytes], tmp_path: Path, mixture: tuple[str, ...]) -> None:
    changes = dict(zip(("LC_ALL", "PYTHONHASHSEED", "TZ", "COLUMNS"), mixture, strict=True))
    assert given(tmp_path / "here", changes) == plain


def test_no_date_host_or_path_in_any_output(plain: dict[str, bytes], tmp_path: Path) -> None:
    names = {os.uname().nodename if hasattr(os, "uname") else "", str(Path.home()), str(tmp_path.parent), sys.prefix}
    for name, content in plain.items():
        text = content.decode("ascii")  # nothing that depends on how a terminal encodes
        assert not re.search(r"\b20[2-9]\d-\d\d|\b\d\d:\d\d\b|/(?:home|tmp|usr|root)/", text), name
        assert not [word for word in names if len(word) > 4 and word in text], name


def test_a_difference_would_be_seen(plain: dict[str, bytes], tmp_path: Path) -> None:
    """Sets of strings come in the order of their hashes: the seeds above do differ in it."""
    code = "import sys; sys.stdout.write(' '.join({str(k) for k in range(100)}))"
    orders = {
        hashlib.sha256(
            subprocess.run(
                [sys.executable, "-c", code], env=os.environ | changes, capture_output=True, check=True
            ).stdout
        ).hexdigest()
        for changes in [PLAIN, *OTHERS]
    }
    assert len(orders) == len(OTHERS) + 1
