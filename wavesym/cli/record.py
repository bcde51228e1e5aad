"""`wavesym record`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import PATH, refuse_unwritable, require_matplotlib
from wavesym.progress import progress


@click.command()
@click.argument("file", type=PATH)
@click.option("--unit", metavar="U", help="The unit of the samples, such as g or m/s^2, where the file says none.")
@click.option("--column", metavar="NAME", help="Which column of a CSV, where it has more than one besides time.")
@click.option("-o", "out", type=PATH, metavar="FILE", help="A picture of it: .svg, .png or .pdf.")
def record(file: Path, unit: str | None, column: str | None, out: Path | None) -> None:
    """Say what a record of AT2 or CSV holds, and draw it.

    Say what a file of a record holds, AT2 or CSV: samples, spacing, duration, peak and when, unit; and draw it.

    \b
    Example:
      wavesym record ground.csv --column north -o ground.svg
    """
    context = click.get_current_context()
    if out is not None:
        require_matplotlib()
        refuse_unwritable(out)
        if out.exists() and file.exists() and out.samefile(file):
            raise click.UsageError(f"-o: {out} is the record itself; write another file", context)
    from wavesym import api

    with progress(f"record {file}"):
        lines = api.record(file, unit, column, out)
    for line in lines:
        click.echo(line)
