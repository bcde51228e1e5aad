"""`import wavesym` is light, gives what docs/reference.md promises, and does the same wherever it is installed."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

import wavesym
from wavesym.scene.first_scene import KINDS

ROOT = Path(wavesym.__file__).parents[1]
SCENES = ("building_half_roof", "building_m2", "collision_m4", "drive_equal", "drive_m1")
CHAINS = ("damped_building", "geared_drive", "stepped_shaft")
HEAVY = {"sympy", "numpy", "scipy", "flint", "pydantic", "jinja2", "pint"}


def run_python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize(
    "start",
    [
        "import wavesym",
        "import wavesym; dir(wavesym)",
        "from wavesym.cli import main; main(['--help'])",
        "from wavesym.cli import main; main(['--version'])",
        "from wavesym.cli import main; main(['generate', '--help'])",
    ],
)
def test_nothing_heavy_is_imported_before_it_is_needed(start: str) -> None:
    loaded = run_python(f"{start}\nimport sys; print('LOADED', *{{name.partition('.')[0] for name in sys.modules}})")
    assert not HEAVY & set(loaded.rpartition("LOADED")[2].split())


def test_only_the_command_that_is_called_is_imported() -> None:
    loaded = run_python("from wavesym.cli import main; main(['scenes'])\nimport sys; print('LOADED', *sys.modules)")
    commands = {name for name in loaded.rpartition("LOADED")[2].split() if name.startswith("wavesym.cli.")}
    assert commands == {"wavesym.cli.scenes", "wavesym.cli.parameters"}


@pytest.mark.slow
def test_what_runs_a_record_waits_for_nothing_that_it_does_not_need() -> None:
    loaded = run_python("import wavesym.api, wavesym.programs.modes.evaluator\nimport sys; print(*sys.modules)")
    assert not {"sympy", "scipy", "matplotlib", "xarray", "pint"} & set(loaded.split())


def test_who_writes_c_of_pieces_waits_for_nothing_else(tmp_path: Path) -> None:
    loaded = run_python(
        f"from wavesym.cli import main; main(['generate', 'drive_m1', '-o', {str(tmp_path)!r}])\n"
        "import sys; print('LOADED', *sys.modules)"
    )
    seen = set(loaded.rpartition("LOADED")[2].split())
    others = {f"wavesym.programs.{kind}.evaluator" for kind in ("march", "modes", "hats")}
    assert {"sympy", "wavesym.programs.pieces"} <= seen  # it did its work
    assert not seen & {*others, "numpy", "scipy", "pint", "wavesym.exact.contacts.schedule", "wavesym.results.response"}


@pytest.mark.parametrize(("told", "threads"), [(None, "1"), ("3", "3")])
def test_commands_keep_numpy_to_one_thread(monkeypatch: pytest.MonkeyPatch, told: str | None, threads: str) -> None:
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    if told:
        monkeypatch.setenv("OMP_NUM_THREADS", told)
    seen = run_python("import wavesym.cli, os, sys; print(os.environ['OMP_NUM_THREADS'], 'numpy' in sys.modules)")
    assert seen == f"{threads} False\n"


@pytest.mark.quick(1)
@pytest.mark.parametrize("first", ["__import__('wavesym.derivation.table')", "wavesym.evaluator", "wavesym.tables"])
def test_tables_is_the_function_whatever_was_imported_before(first: str) -> None:
    assert run_python(f"import wavesym\n{first}\nprint(callable(wavesym.tables))") == "True\n"


def test_public_names() -> None:
    for name in wavesym.__all__:
        assert getattr(wavesym, name)
        assert name in dir(wavesym)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = wavesym.nothing  # type: ignore[attr-defined]


def python(*arguments: str, cwd: Path, program: str = sys.executable, path: tuple[Path, ...] = (ROOT,)) -> str:
    """What a Python prints in a directory, with `path` before everything else that it finds modules in."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, path))}
    done = subprocess.run([program, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def told(commands: Sequence[Sequence[str]], **how: Any) -> str:
    """What `wavesym` prints for some commands; each succeeds."""
    calls = "".join(f"assert main({list(command)}) == 0, {command}\n" for command in commands)
    return python("-c", f"from wavesym.cli import main\n{calls}", **how)


def generated(where: Path, **how: Any) -> dict[str, str]:
    """The files of all built-in scenes, generated from an empty directory."""
    where.mkdir()
    told([("generate", scene, "--language", "all") for scene in SCENES], cwd=where, **how)
    return {str(path.relative_to(where)): path.read_text() for path in sorted(where.rglob("*.*"))}


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What the wavesym that is tested generates."""
    return generated(tmp_path_factory.mktemp("here") / "out")


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project as it comes, and nothing that was left in it."""
    copy = tmp_path_factory.mktemp("checkout")
    for name in ("wavesym", "templates"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    return copy


@pytest.mark.slow
def test_a_checkout_finds_its_templates_and_scenes(checkout: Path, here: dict[str, str], tmp_path: Path) -> None:
    found = python("-c", "import wavesym; print(wavesym.__file__)", cwd=tmp_path, path=(checkout,))
    assert Path(found.strip()).is_relative_to(checkout)
    listed = python("-m", "wavesym", "scenes", cwd=tmp_path, path=(checkout,)).splitlines()
    assert [line.split()[0] for line in listed] == sorted([*SCENES, *CHAINS])
    assert len(here) == len(SCENES) * 5
    assert generated(tmp_path / "out", path=(checkout,)) == here


def wheel(project: Path, folder: Path) -> Path:
    """The wheel that a project makes."""
    options = ("--quiet", "--disable-pip-version-check", "--no-deps", "-w", str(folder))
    python("-m", "pip", "wheel", *options, str(project), cwd=folder)
    (made,) = folder.glob("*.whl")
    return made


def contents(project: Path) -> set[str]:
    """What belongs into the wheel: modules, the C of one of them, scenes, templates, the marker for types."""
    modules = {path.relative_to(project).as_posix() for path in project.glob("wavesym/**/*.py")}
    templates = {path.relative_to(project).as_posix() for path in project.glob("templates/**/*.*")}
    info = f"wavesym-{wavesym.__version__}.dist-info"
    return {
        *modules,
        *(f"wavesym/{template}" for template in templates),
        *(f"wavesym/scene/builtin/{scene}.toml" for scene in (*SCENES, *CHAINS)),
        "wavesym/papers/latex.lark",
        *(f"{path.relative_to(ROOT).as_posix()}" for path in (ROOT / "wavesym/papers").rglob("*.toml")),
        *(f"wavesym/scene/first/{kind}.toml" for kind in KINDS),
        "wavesym/methods/characteristics.c",
        "wavesym/py.typed",
        *(f"{info}/{name}" for name in ("METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE")),
    }


@pytest.mark.slow
def test_the_wheel_has_what_belongs_into_it_and_works(checkout: Path, here: dict[str, str], tmp_path: Path) -> None:
    made = wheel(checkout, tmp_path)
    with ZipFile(made) as archive:
        assert set(archive.namelist()) == contents(checkout)
        (metadata,) = (name for name in archive.namelist() if name.endswith("METADATA"))
        described = archive.read(metadata).decode().partition("\n\n")[2]
    assert "## A frame, from SI units to a page" in described
    assert not re.search(r"\]\((?!https?:)", described), "a picture or a link that leads nowhere from there"
    venv.create(tmp_path / "fresh", with_pip=True)
    fresh = str(tmp_path / "fresh" / "bin" / "python")
    install = ("-m", "pip", "install", "--quiet", "--disable-pip-version-check")
    python(*install, "-c", str(ROOT / "constraints.txt"), str(made), cwd=tmp_path, program=fresh)
    found = python("-c", "import wavesym; print(wavesym.__file__)", cwd=tmp_path, program=fresh, path=())
    assert Path(found.strip()).is_relative_to(tmp_path / "fresh")
    assert generated(tmp_path / "out", program=fresh, path=()) == here


@pytest.mark.slow
def test_what_does_not_belong_into_the_wheel_is_seen(checkout: Path, tmp_path: Path) -> None:
    project = shutil.copytree(checkout, tmp_path / "project")
    (project / "wavesym" / "notes.txt").write_text("left behind")
    (project / "templates" / "c" / "table.j2").unlink()
    with ZipFile(wheel(project, tmp_path)) as archive:
        assert set(archive.namelist()) ^ contents(checkout) == {"wavesym/notes.txt", "wavesym/templates/c/table.j2"}


def oldest(name: str) -> str:
    """The oldest release of a dependency that pyproject.toml allows."""
    needed = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    (found,) = (line for line in needed if line.startswith(name))
    version = re.fullmatch(rf"{name}>=([0-9.]+)", found)
    assert version
    return version[1]


@pytest.mark.slow
def test_the_oldest_sympy_allowed_gives_the_same(here: dict[str, str], tmp_path: Path) -> None:
    version = oldest("sympy")
    old = tmp_path / "old"
    options = ("--quiet", "--disable-pip-version-check", "--no-deps", "--target", str(old))
    python("-m", "pip", "install", *options, f"sympy=={version}", cwd=tmp_path)
    found = python("-c", "import sympy; print(sympy.__version__)", cwd=tmp_path, path=(old, ROOT)).strip()
    assert found.removesuffix(".0") == version.removesuffix(".0")
    commands = [
        *(
            ("derive", system, "--format", format, *more)
            for system in ("drive", "collision", "building")
            for format in ("text", "json", "latex")
            for more in ((), ("--m", "4"))
        ),
        *(("tables", scene, *more) for scene in SCENES for more in ((), ("--symbolic", "--intervals", "2"))),
    ]
    text = told(commands, cwd=tmp_path)
    assert len(text) > 100_000
    assert told(commands, cwd=tmp_path, path=(old, ROOT)) == text
    assert generated(tmp_path / "out", path=(old, ROOT)) == here


def test_the_version_is_the_same_wherever_it_stands() -> None:
    first = re.findall(
        r"^## \[(\d.*?)\]", (ROOT / "CHANGELOG").with_suffix(".md").read_text(encoding="utf-8"), re.MULTILINE
    )[0]
    cited = re.findall(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert [first, *cited] == [wavesym.__version__] * 2


def interpreter(version: str) -> str:
    """A Python of this version on this machine: on the path, or one that pyenv or uv installed. Skipped without."""
    homes = (Path.home() / ".pyenv/versions", Path.home() / ".local/share/uv/python")
    installed = [path for home in homes for path in sorted(home.glob(f"*{version}*/bin/python{version}"))]
    for found in (shutil.which(f"python{version}"), *map(str, installed)):
        works = "import sys, venv; sys.exit(sys.version_info < (3, 11))"
        if found and subprocess.run([found, "-c", works], capture_output=True, check=False).returncode == 0:
            return found
    pytest.skip(f"no Python {version} here")


@pytest.mark.slow
@pytest.mark.parametrize("version", ["3.11", "3.12", "3.13"])
def test_the_wheel_works_in_a_bare_python(version: str, checkout: Path, here: dict[str, str], tmp_path: Path) -> None:
    program = interpreter(version)
    bare: Any = {"cwd": tmp_path, "program": str(tmp_path / "bare" / "bin" / "python"), "path": ()}
    python("-m", "venv", "bare", cwd=tmp_path, program=program, path=())
    python("-m", "pip", "install", "--quiet", str(wheel(checkout, tmp_path)), **bare)
    found = python("-c", "import sys, wavesym; print(sys.version, wavesym.__file__)", **bare)
    assert found.startswith(f"{version}.")
    assert str(tmp_path / "bare") in found
    assert generated(tmp_path / "out", program=bare["program"], path=()) == here
    (tmp_path / "frame.toml").write_text(python("-m", "wavesym", "init", "frame", **bare))
    assert "largest drift" in python("-m", "wavesym", "summary", "frame.toml", **bare)


def test_the_oldest_versions_are_the_floors() -> None:
    """constraints-oldest.txt has what pyproject.toml allows at least, and no other version."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = (line for name in ("plot", "test", "sweep", "papers") for line in project["optional-dependencies"][name])
    floors = dict(line.split(">=") for line in (*project["dependencies"], *extras) if ">=" in line)
    pinned = dict(line.split("==") for line in (ROOT / "constraints-oldest.txt").read_text().splitlines()[1:])
    assert set(pinned) == set(floors)
    for name, floor in floors.items():
        assert re.fullmatch(rf"{re.escape(floor)}(\.0)*", pinned[name]), name
