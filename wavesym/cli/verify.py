"""`wavesym verify`."""

from __future__ import annotations

from contextlib import ExitStack
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wavesym.cli.parameters import (
    NAMES,
    OUT,
    SceneParameter,
    blame_each,
    deliver,
    fragment_option,
    refuse_unwritable,
    written_format,
)
from wavesym.programs.request import EVALUATORS, PRECISIONS
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

FORMATS = ("text", "json", "markdown", "html", "latex")


class _SceneOrId(SceneParameter):
    """A scene; with --published an id, which the paper's data know."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if ctx is not None and ctx.params.get("published"):
            return value
        return super().convert(value, param, ctx)


@click.command()
@click.argument("asked", type=_SceneOrId(), nargs=-1, metavar="[SCENE|ID]...")
@click.option(
    "--published", is_flag=True, is_eager=True, help="A verdict on every formula of the paper, or on each ID, instead."
)
@click.option("--derived", is_flag=True, help="The derivation proved, and its tables by another route, instead.")
@click.option("--format", type=click.Choice(FORMATS), help="With --published.  [default: text]")
@fragment_option
@click.option("--reproduce", is_flag=True, help="With --published: a scene that shows each counterexample.")
@click.option(
    "--only",
    multiple=True,
    metavar="VERDICT",
    help="With --published: records of this verdict, after counts of all; any number.",
)
@click.option("--evaluator", type=click.Choice(EVALUATORS), help="This program alone.  [default: all programs]")
@click.option("--precision", type=click.Choice(PRECISIONS), help="Programs of this precision alone.")
@click.option(
    "--runtime", type=NAMES, metavar="LIST", help="The program that takes these parameters when it runs, alone."
)
@click.option("--stream", is_flag=True, help="The program that takes loads sample by sample, alone.")
@OUT
def verify(
    asked: tuple[Scene, ...] | tuple[str, ...],
    published: bool,
    derived: bool,
    format: str | None,
    fragment: bool,
    reproduce: bool,
    only: tuple[str, ...],
    evaluator: str | None,
    precision: str | None,
    runtime: tuple[str, ...] | None,
    stream: bool,
    out: Path | None,
) -> int:
    """Check programs, or the paper's formulas.

    Check programs against integration and invariants; exit 1 where one is wrong, or an output is not seen.

    Without SCENE, all built-in scenes; without options every program that serves a scene. With --published, exit 1 only
    where a formula could not be tested. ID is a formula, a table or a section: 4.12, T3, III.14, text.22, "section 2".

    \b
    Example:
      wavesym verify collision_m4 drive_m1 --evaluator march
    """
    if published + derived + (bool(asked) and not published) > 1:
        raise click.UsageError("SCENE, --published and --derived exclude each other; write one of them")
    paper_options = {"--format": format, "--fragment": fragment, "--reproduce": reproduce, "--only": only}
    for option, value in paper_options.items():
        if value and not published:
            raise click.UsageError(f"{option}: of the paper only; write --published too")
    options = {"evaluator": evaluator, "precision": precision, "runtime": runtime, "stream": stream or None}
    for option in (name for name, value in options.items() if value is not None and (published or derived)):
        raise click.UsageError(
            f"--{option}: of scenes only; leave it out, or --{'published' if published else 'derived'}"
        )
    written = written_format(format or "text", fragment)
    if out is not None:
        refuse_unwritable(out)
    with progress("verify") as line:
        from wavesym import api
        from wavesym.scene import Scene, builtin_names

        if published:
            names = [name for name in asked if isinstance(name, str)]
            text, passed = api.verify_published(
                written, names, reproduce, lambda entries: line.each(entries, attrgetter("id")), only
            )
        elif derived:
            text, passed = api.verify_derivation(lambda systems: line.each(systems, attrgetter("name")))
        else:
            scenes = [scene for scene in asked if isinstance(scene, Scene)]
            watched_scenes = line.each(
                scenes or [Scene.from_toml(name) for name in builtin_names()], attrgetter("name")
            )
            with ExitStack() as blame:
                seen = blame_each(watched_scenes, blame) if scenes else watched_scenes
                text, passed = api.verify(seen, evaluator, precision, runtime or (), stream=stream)
    deliver(text, out)
    return 0 if passed else 1
