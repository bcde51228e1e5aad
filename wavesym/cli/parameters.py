"""Parameters that commands share, and how they put out text."""

from __future__ import annotations

import math
import os
import re
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from fractions import Fraction
from glob import escape, glob
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import click
from click.shell_completion import CompletionItem

from wavesym.errors import SceneError, WavesymError, install_command
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

    ParameterType = click.ParamType[Any]
else:
    ParameterType = click.ParamType  # click before 8.4 takes no types there

Command = TypeVar("Command", bound=Callable[..., Any])


_ARGUMENT = "wavesym.scene"
_FILES = "wavesym.scenes"


class SceneParameter(ParameterType):
    """A path, `-` for standard input, or the name of a built-in scene."""

    name = "scene"

    def __init__(self, *, needs_output: bool = True) -> None:
        self.needs_output = needs_output

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Scene:
        """The scene; SceneError, which says more than click would, where it is none.

        What a command with one scene finds wrong with it later names its file too.
        """
        from wavesym.scene import Scene

        if isinstance(value, Scene):
            return value
        file = "<stdin>" if value == "-" else value
        with progress(f"read {file}") if value != "-" else nullcontext():  # which may wait for whoever types
            scene = Scene.from_toml(value)
        if self.needs_output:
            scene.refuse_without_output(file)
        if ctx is not None and param is not None and param.nargs == 1:
            ctx.meta[_ARGUMENT] = value
            ctx.with_resource(_blame_scene(scene, file))
        elif ctx is not None:
            ctx.meta.setdefault(_FILES, []).append(file)
        return scene

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Built-in scenes and files of TOML, and folders where there are none of these."""
        from wavesym.scene import builtin_names

        names = [
            CompletionItem(name, help=what) for name, what in builtin_names().items() if name.startswith(incomplete)
        ]
        files = [CompletionItem(file) for file in sorted(glob(f"{escape(incomplete)}*.toml"))]
        return [CompletionItem(incomplete, type="dir"), *names, *files]


@contextmanager
def _blame_scene(scene: Scene, file: str) -> Iterator[None]:
    """What is wrong with a scene names its file, and says in the scene's own unit, too, when that is."""
    try:
        yield
    except SceneError:  # has its file
        raise
    except WavesymError as error:
        what = scene.scale.clock.append_times(str(error)) if scene.scale else str(error)
        # keeps its class, and so its exit status
        raise type(error)(str(SceneError(what, file=file))) from None


def scene_argument() -> str:
    """How the scene of the present command was given."""
    return str(click.get_current_context().meta[_ARGUMENT])


def refuse_scene(out: Path) -> None:
    """UsageError where what is to be written would take the place of the scene that it is made from."""
    scene = Path(scene_argument())
    with suppress(OSError):  # a scene that is no file
        if out.samefile(scene):
            raise click.UsageError(f"-o: {out} is the scene itself; write another file", click.get_current_context())


def refuse_unwritable(out: Path, *, folder: bool = False) -> None:
    """OSError where a file, or one in a folder, cannot be written: before the work that takes long.

    UsageError where it would take the place of what may be a scene.
    """
    place = out / "_" if folder else out
    if not folder and out.is_dir():
        raise IsADirectoryError(21, "Is a directory; write the path of a file", str(out))
    if not folder and out.suffix.lower() == ".toml" and out.exists():
        what = f"-o: {out} is there already, and may be a scene of yours; write another file, or delete it"
        raise click.UsageError(what, click.get_current_context())
    there = next(each for each in (place, *place.absolute().parents) if each.exists())
    if there != place and not there.is_dir():
        raise NotADirectoryError(20, "Not a directory", str(out))
    if not os.access(there, os.W_OK):
        raise PermissionError(13, "Permission denied", str(out))


def blame_each(scenes: Iterable[Scene], stack: ExitStack) -> Iterator[Scene]:
    """The scenes that a command was given; what is found wrong in `stack` with the one just taken names its file."""
    for scene, file in zip(scenes, click.get_current_context().meta[_FILES], strict=True):
        stack.pop_all()
        stack.enter_context(_blame_scene(scene, file))
        yield scene


def is_drawn(out: Path | None, texts: Sequence[str]) -> bool:
    """Whether a file is a picture by its suffix, or else one of some texts. UsageError for another suffix."""
    suffix = "" if out is None else out.suffix.lower()
    context = click.get_current_context()
    if suffix not in (*PICTURES, *texts, ""):
        known = ", ".join((*PICTURES, *texts))
        raise click.UsageError(
            f"-o: {out} is not a picture nor a table; write a name that ends in {known}, or in no suffix", context
        )
    if suffix in PICTURES:
        require_matplotlib()
    return suffix in PICTURES


def require_matplotlib() -> None:
    """UsageError where what draws is not installed: before the work that a picture takes."""
    if not find_spec("matplotlib"):
        context = click.get_current_context()
        raise click.UsageError(f"matplotlib is not installed: {install_command('plot')}", context)


class RatioParameter(ParameterType):
    """A ratio from 0 to below 1, as a number or in percent: 0.05 or "5 %"."""

    name = "ratio"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The ratio as a double."""
        if isinstance(value, float):
            return value
        text, percent = value.removesuffix("%").rstrip(), value.endswith("%")
        try:
            ratio = float(text) / (100 if percent else 1)
        except ValueError:
            ratio = float("nan")
        if not 0 <= ratio < 1:
            self.fail(f'{value!r} is no ratio from 0 to below 1; write 0.05 or "5 %"', param, ctx)
        return ratio


class Seconds(NamedTuple):
    """A time that was written with a unit."""

    number: Fraction


class TimeParameter(ParameterType):
    """A positive time, exact: a decimal or a ratio, or with a unit, which `in_unit` takes to that of a scene."""

    name = "time"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Fraction | Seconds:
        """The time as it was written."""
        from wavesym.fields.numbers import exact
        from wavesym.fields.quantity import si_value

        if isinstance(value, Fraction | Seconds):
            return value
        found: Fraction | Seconds = Fraction(0)
        for read in (exact, lambda text: Seconds(si_value(text, "time"))):
            with suppress(ValueError):
                found = read(value)
                break
        if (found.number if isinstance(found, Seconds) else found) <= 0:
            form = 'a positive time; write a number such as 0.1 or 1/8, or with [units] one such as "0.25 ms"'
            self.fail(f"{value} is not {form}", param, ctx)
        return found


def in_unit(time: Fraction | Seconds | None, scene: Scene, name: str, *, tau: bool) -> Fraction | None:
    """A time that an option took, in tau or else in the unit of results. click.UsageError for seconds without units."""
    if not isinstance(time, Seconds):
        return time
    if scene.scale is None:
        raise click.UsageError(f"{name}: a time with a unit, and the scene has no [units]; write a number of tau")
    return time.number / (scene.scale.seconds if tau else scene.scale.results.sizes["time"])


class NamesParameter(ParameterType):
    """Names with commas between."""

    name = "list"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        """The names."""
        return tuple(name.strip() for name in value.split(",")) if isinstance(value, str) else tuple(value)


SCENE = SceneParameter()
NAMES = NamesParameter()
RATIO = RatioParameter()
PATH = click.Path(path_type=Path)

OUT = click.option("-o", "out", type=PATH, metavar="FILE", help="Where it goes.  [default: standard output]")
"""The option of commands whose result is one text."""


def format_option(*names: str, help: str = "How it is written.") -> Callable[[Command], Command]:
    """The option `--format` of a command that writes so many formats, the first one unless told otherwise."""
    return click.option("--format", type=click.Choice(names), default=names[0], show_default=True, help=help)


def fragment_option(command: Command) -> Command:
    """The option `--fragment` of a command that writes LaTeX."""
    help = "LaTeX without a preamble, for a document that there is."
    return click.option("--fragment", is_flag=True, help=help)(command)


def written_format(format: str, fragment: bool) -> str:
    """The format that is written: of LaTeX a "fragment", where that is meant. click.UsageError for other fragments."""
    if fragment and format != "latex":
        raise click.UsageError(f"--fragment: {format} has no fragments; write --format latex")
    return "fragment" if fragment else format


PICTURES = (".svg", ".png", ".pdf")

_DECIMAL = re.compile(r"[+-]?[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?")


def refuse_out(out: Path | None) -> None:
    """Refuse a file that cannot be written, or would take the place of the scene: before the work that takes long."""
    if out is None:
        return
    if _ARGUMENT in click.get_current_context().meta:
        refuse_scene(out)
    refuse_unwritable(out)


def deliver(text: str, out: Path | None) -> None:
    """A result, whole, to a file where there is one, else to standard output."""
    from wavesym.writing import write_whole

    if out is None:
        put(text)
    else:
        write_whole({out: text if text.endswith("\n") else text + "\n"})


def put_notes(scene: Scene, notes: Iterable[str]) -> None:
    """What is to be known of a result, on standard error, a line for each with the name of the scene."""
    for note in notes:
        click.echo(f"{scene.name}: {note}", err=True)


def put(text: str | Iterable[str]) -> None:
    """Text to standard output: chunks as they come, or a whole, whose last line ends if it does not yet."""
    if isinstance(text, str):
        click.echo(text, nl=not text.endswith("\n"))
    else:
        sys.stdout.writelines(text)


def is_standard_output_a_file() -> bool:
    """Whether a line on a terminal is beside what is put out, not in it: no terminal and no pager gets that."""
    with suppress(OSError, ValueError):  # of a stream that is none of the system's
        return stat.S_ISREG(os.fstat(sys.stdout.fileno()).st_mode)
    return False


def decimals(path: Path) -> list[float]:
    """The numbers in a file, each as a double; SceneError names the first line that holds something else."""
    from wavesym.fields.table import show
    from wavesym.reading import read_text

    file, text = read_text(path, "a file with one decimal a line")
    numbers: list[float] = []
    for count, line in enumerate(text.split("\n"), 1):
        if written := line.partition("#")[0].strip():
            if not _DECIMAL.fullmatch(written) or not math.isfinite(float(written)):
                raise SceneError(f"{show(written)} is not a number; write one such as 0.25", f"line {count}", file)
            numbers.append(float(written))
    return numbers
