"""`wavesym derive`."""

from __future__ import annotations

import click

from wavesym.cli.parameters import put


@click.command()
@click.argument("system", type=click.Choice(["collision", "drive", "building"]))
@click.option("--m", type=int, metavar="M", help="Write every line out for M elastic elements.")
@click.option(
    "--format",
    type=click.Choice(["text", "latex", "json"]),
    default="text",
    show_default=True,
    help="How it is written.",
)
def derive(system: str, m: int | None, format: str) -> None:
    """Derive boundary conditions, delay equations and coefficient recurrences.

    \b
    Example:
      wavesym derive building --m 3
    """
    from wavesym.compiler import derive as derivation

    try:
        put(derivation(system, m, format))
    except ValueError as error:  # no such m
        raise click.UsageError(str(error), click.get_current_context()) from None
