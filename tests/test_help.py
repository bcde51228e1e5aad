"""`help()` of everything public: it says what there is, with an example that is run."""

from __future__ import annotations

import doctest
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import wavesym

FUNCTIONS = {name: getattr(wavesym, name) for name in wavesym.__all__ if name != "__version__"}
METHODS = {f"Scene.{name}": getattr(wavesym.Scene, name) for name in ("from_toml", "with_")}
EXPLAINED = {"wavesym": wavesym, **FUNCTIONS, **METHODS}


def own(documented: Any, name: str) -> list[doctest.DocTest]:
    """The example in the documentation of one name; those of a class's methods are theirs."""
    text = inspect.getdoc(documented) or ""
    return [doctest.DocTestParser().get_doctest(text, {}, name, None, 0)]


@pytest.mark.quick(4)
@pytest.mark.parametrize("name", EXPLAINED)
def test_the_example_in_a_help_works(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = own(EXPLAINED[name], name)
    assert example.examples, "no example"
    said: list[str] = []
    failed, _ = doctest.DocTestRunner().run(example, out=said.append)
    assert not failed, "".join(said)


@pytest.mark.parametrize("text", [">>> 1 + 1\n3\n", ">>> nothing\n", "No example."])
def test_an_example_that_does_not_work_is_seen(text: str) -> None:
    def documented() -> None: ...

    documented.__doc__ = text
    (example,) = own(documented, "documented")
    assert not example.examples or doctest.DocTestRunner().run(example, out=lambda _: None).failed


@pytest.mark.parametrize("name", {**FUNCTIONS, **METHODS})
def test_everything_public_is_typed(name: str) -> None:
    documented: Callable[..., Any] = EXPLAINED[name]
    if inspect.isclass(documented):
        documented = documented.__init__
    given = inspect.signature(documented).parameters.keys() - {"self", "cls", "args", "kwargs", "fields"}
    assert given <= inspect.get_annotations(documented).keys()


def test_the_help_of_the_package_names_everything_public() -> None:
    text = inspect.getdoc(wavesym) or ""
    assert [name for name in FUNCTIONS if name not in text] == []
