"""`wavesym completion`."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print what makes a shell complete commands.

    Commands, options, built-in scenes and files are completed where the shell reads what this prints.

    \b
    Example:
      wavesym completion zsh > _wavesym
    """
    from wavesym.cli import cli

    kind = get_completion_class(shell)
    assert kind is not None  # click has these three
    click.echo(kind(cli, {}, "wavesym", "_WAVESYM_COMPLETE").source())
