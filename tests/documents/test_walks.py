"""Walk polynomials written out: what is printed is what they are, and no more than can be read."""

import json
import re
import shutil
import subprocess

import pytest

from wavesym.derivation.symbolic import generic
from wavesym.derivation.table import Function
from wavesym.derivation.walks import departures, function_walks, letters, units, walks_until
from wavesym.documents.walks import walk_polynomials
from wavesym.errors import CostError
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.drive import DRIVE


def test_what_is_written_reads_back():
    symbols = generic(DRIVE, 2)
    chain = symbols.chain
    names = letters(chain)
    (made,) = json.loads(walk_polynomials([symbols], 5, "json"))
    told = 0
    for unit, response in zip(units(chain), made["responses"], strict=True):
        sent = walks_until(chain, unit, departures(chain, 1, 5), names, names.symbols)
        listed = {(e["function"], e["interval"]): e for e in response["polynomials"]}
        for letter in "fg":
            for rod in (1, 2):
                for n in range(1, 6):
                    polynomial = function_walks(chain, sent, Function(letter, rod), n, 1)
                    entry = listed.get((f"{letter}_{rod}", n))
                    assert (entry is None) == (polynomial == 0)
                    if entry:
                        assert parsed(entry["polynomial"], names.symbols) == polynomial
                        degrees = dict(zip(names.names, polynomial.degrees(), strict=True))
                        assert {name: power + 1 for name, power in entry["powers"]} == {
                            name: degree for name, degree in degrees.items() if degree and name[0] == "T"
                        }
                        told += 1
    assert told > 20


def parsed(text, symbols):
    total = 0 * next(iter(symbols.values()))
    for sign, term in re.findall(r"([+-]?)\s*([^+\-\s]+)", text):
        product = -1 if sign == "-" else 1
        for factor in term.split("*"):
            name, _, power = factor.partition("^")
            product = product * (symbols[name] if name in symbols else int(name)) ** int(power or 1)
        total = total + product
    return total


@pytest.mark.skipif(not shutil.which("pdflatex"), reason="no LaTeX here")
def test_latex_compiles(tmp_path):
    (tmp_path / "walks.tex").write_text(
        walk_polynomials([generic(BUILDING_FORCE, 3), generic(BUILDING_GROUND, 3)], 4, "latex")
    )
    command = ["pdflatex", "-halt-on-error", "-interaction=batchmode", "walks.tex"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 0


def test_more_than_anyone_reads_is_refused(monkeypatch):
    monkeypatch.setattr("wavesym.documents.walks.MOST_TERMS", 100)
    with pytest.raises(CostError, match="--intervals"):
        walk_polynomials([generic(DRIVE, 3)], 8, "text")
