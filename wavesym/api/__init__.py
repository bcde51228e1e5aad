"""One function for each thing that people do with a scene: the command line, Python and sweeps enter here.

    stage     call                       takes             gives                             room
    -------   ------------------------   ---------------   -------------------------------   --------------------
    read      Scene.from_toml            TOML              Scene: what the user wrote        scene/, systems/
    lower     lower                      Scene             Model: exact, nodes and loads     scene/ -> mechanics/
    derive    node_law, recurrence       nodes, a system   laws of coefficients              derivation/   SymPy
    solve     network_table, signals ... Model, laws       tables, waves, reference values   exact/
    choose    program                    Model, Request    Program: tables and bounds        programs/
    write     generate                   Program           C, NumPy, FMU, manifest           targets/

    values      run, summary, peaks, spectrum, evaluator: what outputs are
    vibration   modes, frf: how the chain vibrates
    programs    program, generate, check, model: what computes outputs elsewhere
    formulas    derive, tables, formula: the mathematics behind these
    pictures    plot, report: what people look at
    sweeps      sweep: many scenes
    verdicts    inspect, verify, advise: what is known, and how well

Each function calls the stages that it needs once, in this order; what people read of the result is written by
documents/, results/ and pictures/, judged by verification/ and papers/, measured by lab/. What a function needs is
imported when it is called, so that no command waits for a library that another one needs.
"""

from wavesym.api.formulas import Derivation, derive, formula, symbolic_tables, table, tables, walks
from wavesym.api.pictures import (
    plot,
    plot_frf,
    plot_modes,
    plot_spectra,
    plot_with_notes,
    record,
    report,
    scene_html,
)
from wavesym.api.programs import check, fmu_notes, generate, model, program, write
from wavesym.api.sweeps import run_sweep, sweep, sweep_report, sweep_status, sweep_table
from wavesym.api.values import evaluator, peaks, run, run_csv, scene_notes, spectrum, spectrum_notes, summary
from wavesym.api.verdicts import advise, inspect, inspect_lines, verify, verify_derivation, verify_published
from wavesym.api.vibration import frf, modes

__all__ = [
    "Derivation",
    "advise",
    "check",
    "derive",
    "evaluator",
    "fmu_notes",
    "formula",
    "frf",
    "generate",
    "inspect",
    "inspect_lines",
    "model",
    "modes",
    "peaks",
    "plot",
    "plot_frf",
    "plot_modes",
    "plot_spectra",
    "plot_with_notes",
    "program",
    "record",
    "report",
    "run",
    "run_csv",
    "run_sweep",
    "scene_html",
    "scene_notes",
    "spectrum",
    "spectrum_notes",
    "summary",
    "sweep",
    "sweep_report",
    "sweep_status",
    "sweep_table",
    "symbolic_tables",
    "table",
    "tables",
    "verify",
    "verify_derivation",
    "verify_published",
    "walks",
    "write",
]
