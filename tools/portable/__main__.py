"""python -m tools.portable prove|misra|targets|fuzz PAGE: run the tool and put its table into the page.

`fuzz PAGE SECONDS` takes so many seconds for each program. `prove PAGE NAME ...` looks at the programs of these names
alone; other rows stay as they are.

Exit status 1 where something is not as it has to be; 0 with a word where the tool is not on this machine.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from tools.portable import fuzz, misra, prove, targets
from tools.portable.answers import FOLDER as KEPT
from tools.portable.external import absent, version
from tools.portable.page import marked_text, put, table
from tools.portable.subjects import CHECKED, COMPILED, PROVED
from wavesym.writing import write_whole


def main(what: str, page: Path, *more: str) -> int:
    """Run one of them; what failed is told line by line."""
    clang = fuzz.fuzzer() if what == "fuzz" else None
    missing = {
        "prove": absent(prove.TOOL),
        "misra": absent(misra.TOOL),
        "targets": absent("size", "nm"),
        "fuzz": [] if clang else ["clang with libFuzzer"],
    }[what]
    if what == "targets" and not find_spec("ziglang"):
        missing.append("ziglang")
    if missing:
        print(f"{what}: skipped, no {', '.join(missing)} on this machine")
        return 0
    failed: list[str] = []
    with TemporaryDirectory() as name:
        folder = Path(name)
        match what:
            case "prove":
                asked = [subject for subject in PROVED if not more or subject.name in more]
                proved = {row[:3]: row for row in _report_rows(prove.rows(asked, folder, KEPT, failed))}
                known = {tuple(row[:3]): row for row in _rows_on(page, what)} | proved
                keys = [prove.key(subject) for subject in PROVED]
                made = table(prove.HEAD, [known.get(key, (*key, "", "", "not run")) for key in keys])
                description = f"Frama-C {version(prove.TOOL)}, data as of {', '.join(prove.MACHINES)}."
            case "misra":
                seen = misra.all_findings(CHECKED, folder, KEPT)
                made = table(misra.HEAD, _report_rows(misra.rows(seen, failed)))
                write_whole({page.with_name(misra.LIST): misra.by_function(seen)})
                description = f"{version(misra.TOOL)}, in {', '.join(subject.name for subject in CHECKED)}."
            case "fuzz":
                assert clang
                learning = Path("build", "fuzz").resolve()  # the next run goes on with what this one has learnt
                made = table(
                    fuzz.HEAD, _report_rows(fuzz.rows(fuzz.FUZZED, clang, learning, fuzz.CORPUS, int(*more), failed))
                )
                description = f"{fuzz.tool(clang)}."
            case _:
                found = list(_report_rows(targets.rows(COMPILED, targets.TARGETS, folder, KEPT, failed)))
                lines = targets.status(found, targets.TARGETS, proved_programs(page))
                made = f"{table(targets.STATUS_HEAD, lines)}\n{table(targets.HEAD, found)}"
                description = f"{targets.compiler()}, `-Os`."
    put(page, what, f"{description}\n\n{made}")
    print(*failed, sep="\n", end="\n" if failed else "")
    return 1 if failed else 0


def proved_programs(page: Path) -> set[str]:
    """The programs in the table of `make prove`, none of whose rows has an alarm."""
    rows = _rows_on(page, "prove")
    return {row[0] for row in rows} - {row[0] for row in rows if row[-1] != "0"}


def _rows_on(page: Path, what: str) -> list[list[str]]:
    """The rows of a table on the page."""
    lines = marked_text(page.read_text(encoding="utf-8"), what).splitlines()[4:]
    return [line[2:-2].split(" | ") for line in lines]


def _report_rows(rows: Iterator[tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """The rows, each on standard error when it is there."""
    for row in rows:
        print(*row, sep="  ", file=sys.stderr, flush=True)
        yield row


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1], Path(sys.argv[2]), *sys.argv[3:]))
