"""The derivation written out: the same laws in every notation, and well-formed."""

import json
import shutil
import subprocess

import pytest

from wavesym.emission.derivation import derivation
from wavesym.errors import WavesymError

SYSTEMS = ("collision", "drive", "building")


@pytest.mark.parametrize("system", SYSTEMS)
def test_text_has_the_papers_lines(system):
    text = derivation(system, None, "text")
    line = {
        "collision": "g_(m-1)'(z) = -f_(m-1)'(z-2) + f_m'(z-2) + f_m'(z-4)",  # (4.6), as printed
        "drive": "g_i'(z) = -f_i'(z-2) + f_(i+1)'(z-1) + g_(i+1)'(z-1),  i = 1, ..., m - 1",  # (4.7)
        "building": "g_m''(z) + kappa_m g_m'(z) = -f_m''(z-2) + kappa_m f_m'(z-2)",  # (4.8)
    }[system]
    assert f"  {line}\n" in text


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("m", [None, 4])
def test_latex_and_text_say_as_much(system, m):
    latex, statements = derivation(system, m, "latex"), json.loads(derivation(system, m, "json"))
    formulas = [
        f
        for s in statements
        for part in ("conditions", "equations", "recurrences")
        for e in s[part]
        for f in e["formulas"]
    ]
    assert latex.count(r"\[") == latex.count(r"\]") == len(formulas)
    assert latex.count("{") == latex.count("}")
    text = derivation(system, m, "text")
    assert all(formula in text for formula in formulas)


def test_written_out_no_index_is_left():
    for formula in json.loads(derivation("collision", 6, "json"))[0]["equations"]:
        assert "_i" not in formula["formulas"][0]
        assert "m" not in formula["formulas"][0]


@pytest.mark.skipif(not shutil.which("pdflatex"), reason="no LaTeX here")
@pytest.mark.parametrize("system", SYSTEMS)
def test_latex_compiles(system, tmp_path):
    (tmp_path / "derivation.tex").write_text(derivation(system, None, "latex"))
    command = ["pdflatex", "-halt-on-error", "-interaction=batchmode", "derivation.tex"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize(
    ("system", "m"), [("collision", 5), ("collision", 2), ("drive", 0), ("building", 1), ("drive", 101)]
)
def test_an_m_that_there_is_not_is_refused(system, m):
    with pytest.raises(WavesymError, match="--m: "):
        derivation(system, m, "text")
