"""`wavesym sweep`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import PATH, format_option, put, refuse_unwritable
from wavesym.errors import printable
from wavesym.progress import progress


@click.command()
@click.argument("source", metavar="SWEEP", type=PATH)
@click.option("-o", "out", type=PATH, metavar="DIR", help="Folder of the results; where they are begun it goes on.")
@click.option("--workers", type=click.IntRange(min=1), help="At most so many processes of this machine compute.")
@click.option("--scheduler", metavar="ADDRESS", help="The workers of this Dask scheduler compute (tcp://HOST:PORT).")
@click.option("--retry-failed", is_flag=True, help="Cases that failed are tried again.")
@click.option("--status", "tell", is_flag=True, help="Say what is done in the folder SWEEP, and what failed.")
@format_option("text", "json", help="Of --status.")
@click.option("--table", type=PATH, metavar="FILE", help="Write the results in the folder SWEEP as .csv or .parquet.")
def sweep(
    source: Path,
    out: Path | None,
    workers: int | None,
    scheduler: str | None,
    retry_failed: bool,
    tell: bool,
    format: str,
    table: Path | None,
) -> int:
    """Compute many scenes that differ in some fields.

    Compute many scenes that differ in a few fields or in their record.

    SWEEP is a file that says which, or with --status and --table the folder of its results. What is done stays done:
    the same command goes on where it was, whatever ended it.

    \b
    Example:
      wavesym sweep stiffness.toml -o stiffness
    """
    from wavesym import api

    if tell or table:
        if out or workers or scheduler or retry_failed:
            raise click.UsageError("--status and --table read a folder alone; leave out what is for computing")
        if table:
            refuse_unwritable(table)
            api.sweep_table(source, table)
        found = api.sweep_status(source)
        if table and found.done < found.cases:
            click.echo(f"{table}: rows without results: {found.cases - found.done} ({found.line})", err=True)
        if tell:
            put(found.json() if format == "json" else found.text())
        return 0
    if out is None:
        raise click.UsageError("-o DIR is missing: a folder for the results")
    if workers and scheduler:
        raise click.UsageError("--workers and --scheduler exclude each other; write one of them")
    refuse_unwritable(out, folder=True)
    told: list[str] = []
    with progress(f"sweep {source}") as line:
        failed = api.run_sweep(source, out, workers, scheduler, retry_failed, line.count, told.append)
    for note in told:
        click.echo(f"{out}: {note}", err=True)
    found = api.sweep_status(out)
    click.echo(f"{out}: {found.line}", err=True)
    if found.reasons:
        first, more = found.reasons[0], "; --status has all" * (len(found.reasons) > 1)
        click.echo(printable(f"{out}: case {first['case']} failed: {first['reason']}{more}"), err=True)
    return 1 if failed else 0
