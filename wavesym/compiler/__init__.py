"""wavesym in one view: each stage takes one frozen value and gives the next.

    stage     call                       takes             gives                             room
    -------   ------------------------   ---------------   -------------------------------   --------------------
    read      Scene.from_toml            TOML              Scene: what the user said         scene/, systems/
    lower     lower                      Scene             Model: exact, nodes and loads     scene/ -> mechanics/
    derive    node_law, recurrence       nodes, a system   laws of coefficients              derivation/   SymPy
    run       full_table, signals, ...   Model, laws       tables, waves, reference values   exact/
    choose    make                       Model             Program: tables and bounds        programs/
    write     files                      Program           C, NumPy, manifest                targets/

A way through is a short function of this room, which calls these in order; tables, programs and reference values ask
for the laws they need themselves. What people read of it is written by documents/, results/ and report/, what is
checked by verification/ and papers/, what is measured by lab/. A way is loaded when one of its functions is first asked
for, and the heavy libraries when it needs them.

    values.py       a scene to histories, extremes and spectra
    sweeps.py       many scenes to a folder of arrays
    texts.py        a scene or a system to tables of coefficients, derivations, walks
    generation.py   a scene to C, NumPy and FMUs
    pictures.py     a scene or a record to pictures and pages
    verdicts.py     programs, the derivation, the paper and simpler models, judged
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wavesym.compiler.generation import check, fmu_told, generate, notes, stream_program
    from wavesym.compiler.pictures import plot, record, report
    from wavesym.compiler.sweeps import run_sweep, sweep, sweep_report, sweep_status, sweep_table
    from wavesym.compiler.texts import derive, inspect, symbolic_tables_text, table, tables, tables_text, walks
    from wavesym.compiler.values import evaluator, model, peaks, run, spectrum, summary, summary_text, warnings
    from wavesym.compiler.verdicts import advise, derived, published, verify

__all__ = [
    "advise",
    "check",
    "derive",
    "derived",
    "evaluator",
    "fmu_told",
    "generate",
    "inspect",
    "model",
    "notes",
    "peaks",
    "plot",
    "published",
    "record",
    "report",
    "run",
    "run_sweep",
    "spectrum",
    "stream_program",
    "summary",
    "summary_text",
    "sweep",
    "sweep_report",
    "sweep_status",
    "sweep_table",
    "symbolic_tables_text",
    "table",
    "tables",
    "tables_text",
    "verify",
    "walks",
    "warnings",
]

_WAYS = {
    "generation": ("check", "fmu_told", "generate", "notes", "stream_program"),
    "pictures": ("plot", "record", "report"),
    "sweeps": ("run_sweep", "sweep", "sweep_report", "sweep_status", "sweep_table"),
    "texts": ("derive", "inspect", "symbolic_tables_text", "table", "tables", "tables_text", "walks"),
    "values": ("evaluator", "model", "peaks", "run", "spectrum", "summary", "summary_text", "warnings"),
    "verdicts": ("advise", "derived", "published", "verify"),
}


def __getattr__(name: str) -> object:
    for way, functions in _WAYS.items():
        if name in functions:
            return getattr(import_module(f"{__name__}.{way}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
