"""`wavesym verify`."""

from __future__ import annotations

from contextlib import ExitStack
from operator import attrgetter
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import SCENE, each_blamed, put
from wavesym.cli.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scenes", type=SCENE, nargs=-1, metavar="[SCENE]...")
@click.option("--published", is_flag=True, help="A verdict on every formula of the paper instead.")
@click.option("--derived", is_flag=True, help="The derivation proved, and its tables by other routes, instead.")
@click.option("--format", type=click.Choice(["text", "json", "markdown"]), help="With --published.  [default: text]")
def verify(scenes: tuple[Scene, ...], published: bool, derived: bool, format: str | None) -> int:
    """Check evaluators against integration and invariants; exit 1 where one is out of tolerance.

    Without SCENE, all built-in scenes. With --published, exit 1 only where a formula could not be tested.

    \b
    Example:
      wavesym verify collision_m4 drive_m1
    """
    if published + derived + bool(scenes) > 1:
        raise click.UsageError("more than one of SCENE, --published and --derived given, at most one expected")
    if format and not published:
        raise click.UsageError("--format given without --published; it is for --published only")
    with progress("verify") as line:
        from wavesym import compiler
        from wavesym.scene import Scene, builtin_names

        if published:
            text, passed = compiler.published(format or "text", lambda claims: line.each(claims, attrgetter("id")))
        elif derived:
            text, passed = compiler.derived(lambda systems: line.each(systems, attrgetter("name")))
        else:
            chosen = scenes or [Scene.from_toml(name) for name in builtin_names()]
            told = line.each(chosen, attrgetter("name"))
            with ExitStack() as blame:
                text, passed = compiler.verify(each_blamed(told, blame) if scenes else told)
    put(text)
    return 0 if passed else 1
