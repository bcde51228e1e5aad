"""A language is a module with `files` and HAS_SELFTEST: files.py asks for no more, and other rooms ask files.py."""

import ast
import inspect
import re
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.support.builds import SOURCES, scene
from tests.support.generated import files
from wavesym.programs.schemes import PARTS, SCHEMES
from wavesym.programs.schemes.scheme import Scheme
from wavesym.scene import lower
from wavesym.targets import TARGETS
from wavesym.targets import files as written

ROOT = Path(__file__).parents[2]


def basic_files(description, program):
    """A language that says no more than its program's kind."""
    return {f"{description.name}.bas": f"10 PRINT {program.kernel}, {program.reference}\n"}


def test_another_language_is_a_name_and_a_module(monkeypatch):
    monkeypatch.setitem(sys.modules, "wavesym.targets.basic", SimpleNamespace(files=basic_files, HAS_SELFTEST=False))
    monkeypatch.setattr(written, "TARGETS", (*written.TARGETS, "basic"))
    made = files(lower(scene("made", "1e-2")), "basic", "pieces")
    assert made["made.bas"] == "10 PRINT pieces, None\n"  # no self-test, so that no reference values are computed
    assert made.keys() == {"made.bas", "made.json"}
    every = files(lower(scene("made", "1e-2")), "all", "pieces")
    assert {"made.bas", "made.c", "made.py"} < every.keys()


def test_no_room_but_files_imports_a_language():
    inside = re.compile(rf"wavesym\.targets\.({'|'.join(TARGETS)})\b")
    for path in (ROOT / "wavesym").rglob("*.py"):
        if not path.is_relative_to(ROOT / "wavesym" / "targets"):
            assert not inside.search(path.read_text(encoding="utf-8")), path


def imports(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        if isinstance(node, ast.ImportFrom):
            yield node.module


@pytest.mark.quick(2)
@pytest.mark.parametrize(("evaluator", "precision"), SOURCES)
def test_generated_python_imports_nothing_but_numpy(evaluator, precision):
    made = files(lower(scene("made", "1e-2")), "numpy", evaluator, precision)["made.py"]
    assert set(imports(made)) == {"numpy", "numpy.typing"}


@pytest.mark.parametrize("kind", SCHEMES)
def test_nor_does_the_arithmetic_that_is_written_into_it(kind):
    """But for other files of it, and names of types, which are above what is written."""
    parts = (Scheme, *PARTS.get(kind, ()), SCHEMES[kind])
    for part in parts:
        scheme = Path(inspect.getfile(part)).read_text(encoding="utf-8")
        others = {other.__module__ for other in parts}
        types = {"collections.abc", "typing", "numpy.typing", "wavesym.numbers.arrays"}
        assert set(imports(scheme)) - others - types == {"numpy"}
