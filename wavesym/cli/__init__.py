"""The command line: one thin file per command, each loaded only when it is called or its help is asked for.

What the commands need is imported inside them, so that no `--help` waits for SymPy.
"""

from __future__ import annotations

import atexit
import gc
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper

import click

from wavesym import __version__
from wavesym.errors import WavesymError, did_you_mean, printable, shorten_name, shorten_words

GROUPS = {
    "Start": ("init", "scenes", "record", "schema", "completion"),
    "Compute": ("run", "summary", "modes", "frf", "spectrum", "sweep"),
    "Show": ("plot", "report"),
    "Generate": ("generate",),
    "Understand": ("inspect", "advise", "derive", "tables", "formula", "verify"),
    "Measure": ("chart", "stability"),
}
"""The commands as people meet them."""
COMMANDS = tuple(command for commands in GROUPS.values() for command in commands)

# matrices are small here: threads that share one wait for each other, and a command takes twice as long; and what a
# chart compares has one thread each. NumPy reads this when it is first imported
for _threads in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")

# no other package that is installed has a word in what a scene is, and to look for one takes a while. pydantic reads
# this when its first model is used
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

DONE, FAILED, WRONG_REQUEST, INTERRUPTED = 0, 1, 2, 130

# what modules are made of stays, and only some hundred objects of a command are in cycles: to look for these while the
# 175 000 objects of a short command are made takes a tenth of it
_SELDOM = (250_000, 20, 100)
# nor for what the end of the process frees: a quarter of one
atexit.register(gc.freeze)


class _Commands(click.Group):
    """The commands in the order in which one meets them; NAME is the function NAME in `wavesym.cli.NAME`."""

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        width = max(map(len, COMMANDS))
        for group, names in GROUPS.items():
            commands = [(name, self.get_command(ctx, name)) for name in names]
            with formatter.section(group):
                rows = [(name.ljust(width), command.get_short_help_str(80)) for name, command in commands if command]
                formatter.write_dl(rows)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f"wavesym.cli.{cmd_name}"), cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            name, command, left = super().resolve_command(ctx, args)
        except click.UsageError as error:
            meant = did_you_mean(args[0], COMMANDS)
            raise click.UsageError(f"{error.message} {meant}".rstrip(), ctx) from None
        if command is not None and not ctx.resilient_parsing:
            _refuse_repeated(click.Context(command, ctx, name), left)
        return name, command, left


def _refuse_repeated(ctx: click.Context, args: Sequence[str]) -> None:
    """UsageError for an option of one value that is written twice: click takes the last one in silence."""
    *_, written = ctx.command.make_parser(ctx).parse_args(list(args))
    seen: set[str | None] = set()
    for option in written:
        if not isinstance(option, click.Option) or option.is_flag or option.multiple:
            continue
        if option.name in seen:
            how = "one list with commas" if option.type.name == "list" else "one of them"
            raise click.UsageError(f"{'/'.join(option.opts)}: written twice, and takes one value; write {how}", ctx)
        seen.add(option.name)


@click.command(cls=_Commands, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="wavesym", message="%(prog)s %(version)s")
@click.pass_context
def cli(context: click.Context) -> None:
    """Waves in chains of rods and rigid bodies: from a scene to exact tables, NumPy and C.

    SCENE is a path, - for standard input, or the name of a built-in scene.

    \b
    Example:
      wavesym generate building_m2 -o building --language all

    \b
    Completion in bash; in zsh and fish with their names:
      eval "$(_WAVESYM_COMPLETE=bash_source wavesym)"
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and give its exit status; what goes wrong for a user is one line on standard error."""
    if sys.stdout is None:
        return _print_refusal("wavesym: standard output is closed; open it, or write a file with -o", WRONG_REQUEST)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="surrogateescape")  # the name of a file may be no UTF-8
    gc.set_threshold(*_SELDOM)
    try:
        status = cli.main(arguments, prog_name="wavesym", standalone_mode=False)
        sys.stdout.flush()  # here, where a reader that has gone can still be met in silence
        return status if isinstance(status, int) else DONE
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "wavesym"
        return _print_refusal(f"{command}: {error.format_message()} (see {command} --help)", WRONG_REQUEST)
    except click.ClickException as error:
        return _print_refusal(f"wavesym: {error.format_message()}", WRONG_REQUEST)
    except WavesymError as error:
        for line in error.lines:
            _print_refusal(line, error.status)
        return error.status
    except BrokenPipeError:
        return _unread()
    except OSError as error:
        return _print_refusal(
            f"{shorten_name(str(error.filename or 'wavesym'))}: {error.strerror or error}", WRONG_REQUEST
        )
    except (click.Abort, KeyboardInterrupt):
        return INTERRUPTED


def _print_refusal(line: str, status: int) -> int:
    click.echo(
        printable(shorten_words(" ".join(line.split()))), err=True
    )  # names of files may be commands to a terminal
    return status


def _unread() -> int:
    """`wavesym ... | head`: nobody reads on, and Python's own flush at exit must not complain."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return FAILED
