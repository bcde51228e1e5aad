"""Parameters that commands share, and how they put out text."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from wavesym.scene import Scene


class SceneParameter(click.ParamType[Any]):
    """A path, `-` for standard input, or the name of a built-in scene."""

    name = "scene"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Scene:
        """The scene; SceneError, which says more than click would, where it is none."""
        from wavesym.scene import Scene

        return value if isinstance(value, Scene) else Scene.from_toml(value)


SCENE = SceneParameter()
PATH = click.Path(path_type=Path)


def put(text: str | Iterable[str]) -> None:
    """Text to standard output: chunks as they come, or a whole, whose last line ends if it does not yet."""
    if isinstance(text, str):
        click.echo(text, nl=not text.endswith("\n"))
    else:
        sys.stdout.writelines(text)
