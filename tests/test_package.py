"""`import wavesym` is light, and gives what `interface.md` promises."""

from __future__ import annotations

import subprocess
import sys

import pytest

import wavesym

HEAVY = {"sympy", "numpy", "scipy", "flint", "pydantic", "jinja2"}


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
    assert commands == {"wavesym.cli.scenes"}


@pytest.mark.parametrize("first", ["wavesym.evaluator", "__import__('wavesym.coefficients.table')", "wavesym.tables"])
def test_tables_is_the_function_whatever_was_imported_before(first: str) -> None:
    assert run_python(f"import wavesym\n{first}\nprint(callable(wavesym.tables))") == "True\n"


def test_public_names() -> None:
    for name in wavesym.__all__:
        assert getattr(wavesym, name)
        assert name in dir(wavesym)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = wavesym.nothing  # type: ignore[attr-defined]
