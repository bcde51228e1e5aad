"""`wavesym derive`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from wavesym.cli.parameters import (
    OUT,
    SCENE,
    ParameterType,
    deliver,
    format_option,
    fragment_option,
    refuse_out,
    written_format,
)
from wavesym.errors import SceneError
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

WALKED = 4  # intervals, unless more are asked for


class _Source(ParameterType):
    """The name of a system, or a scene."""

    name = "source"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str | Scene:
        """A system's name, or the scene; click.BadParameter where it is neither, SceneError for a wrong scene."""
        if value in system_names():
            return str(value)
        try:
            return SCENE.convert(value, param, ctx)
        except SceneError as error:
            if error.path or value == "-" or Path(value).exists():
                raise
            names = f"'{{{'|'.join(system_names())}}}' or SCENE"
            raise click.BadParameter(f"{value!r} is neither a system nor a scene.", ctx, param, names) from None

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Systems, and what completes a scene."""
        systems = [CompletionItem(name) for name in system_names() if name.startswith(incomplete)]
        return SCENE.shell_complete(ctx, param, incomplete) + systems


def system_names() -> tuple[str, ...]:
    """The systems that there are."""
    from wavesym.systems import presets

    return tuple(presets())


@click.command()
@click.argument("source", type=_Source(), metavar="SYSTEM|SCENE")
@click.option("--m", type=int, metavar="M", help="Write every line out for M elastic elements; a scene has its own.")
@format_option("text", "latex", "json")
@fragment_option
@click.option("--walks", is_flag=True, help="Walk polynomials instead, which say why powers are as high as they are.")
@click.option("--intervals", type=click.IntRange(1), help="With --walks: how many of every function.  [default: 4]")
@OUT
def derive(
    source: str | Scene,
    m: int | None,
    format: str,
    fragment: bool,
    walks: bool,
    intervals: int | None,
    out: Path | None,
) -> None:
    """Derive the equations and their coefficients.

    Derive boundary conditions, delay equations and coefficient recurrences.

    Of a SYSTEM (collision, drive or building) for any number m of elastic elements, with the coefficients for common
    patterns of equal parameters; of a SCENE with those for its own.

    \b
    Example:
      wavesym derive building --m 3
    """
    from wavesym import api

    if m is not None and not isinstance(source, str):
        raise click.UsageError("--m: a scene has its own m; leave --m out, or write the name of a system")
    if walks and isinstance(source, str) and m is None:
        raise click.UsageError("--walks: walks are those of one chain; with the name of a system write --m M too")
    if intervals is not None and not walks:
        raise click.UsageError("--intervals: of walks only; write --walks too")
    written = written_format(format, fragment)
    refuse_out(out)
    try:
        with progress(f"derive {source if isinstance(source, str) else source.name}"):
            text = api.walks(source, m, intervals or WALKED, written) if walks else api.derive(source, m, written)
    except ValueError as error:
        if not isinstance(source, str):
            raise
        # no such m
        raise click.UsageError(str(error), click.get_current_context()) from None
    deliver(text, out)
