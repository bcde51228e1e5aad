"""The derivation written out: the same formulas in every notation, and well-formed."""

import json
import re
import shutil
import subprocess

import pytest

from tests.support.scenes import NAMED
from tests.support.tex import read_tex
from wavesym.cli import main
from wavesym.derivation.symbolic import symbolic
from wavesym.documents.derivation.document import derivation, scene_derivation
from wavesym.errors import WavesymError
from wavesym.scene import Scene

SYSTEMS = ("collision", "drive", "building")
PARTS = ("legend", "conditions", "rods", "nodes", "equations", "recurrences", "displacements", "stretches")


def of_scene(name, format):
    scene = Scene.from_toml(name)
    return scene_derivation(scene.name, symbolic(scene.system.chain), format)


def formulas(statement):
    """Every formula of a statement in JSON."""
    entries = [entry for part in PARTS for entry in statement[part]]
    for pattern in statement["families"]:
        entries += pattern["laws"]
        yield from (*pattern["symbols"], *pattern["given"], *pattern["rates"])
    for family in statement["powers"]:
        entries += family["rows"]
        yield from family["leading"]
    yield from statement["quantities"]
    for entry in entries:
        yield from entry["formulas"]


@pytest.mark.parametrize("system", SYSTEMS)
def test_text_has_the_papers_lines(system):
    text = derivation(system, None, "text")
    lines = {
        "collision": [
            "g_(m-1)'(z) = -f_(m-1)'(z-2) + f_m'(z-2) + f_m'(z-4)",  # (4.6), as printed
            "tau_0i = 0,  x_0i = i,  v = v_(i-1)",  # Table 1, as it can be read
            "kappa_i = F l rho/M_i",
        ],
        "drive": [
            "g_i'(z) = -f_i'(z-2) + f_(i+1)'(z-1) + g_(i+1)'(z-1),  i = 1, ..., m - 1",  # (4.7)
            "f_i^n[2 kappa_1,0] = -g_i^n[0,0] - g_i^n[kappa_1,0] - g_i^n[2 kappa_1,0] - f_i^n[0,0] - f_i^n[kappa_1,0]",
            "kappa_i = l rho I_i/J_i",
        ],
        "building": [
            "g_m''(z) + kappa_m g_m'(z) = -f_m''(z-2) + kappa_m f_m'(z-2)",  # (4.8)
            "tau_0i = i - 1,  x_0i = i - 1,  v = 0",
            "0 = g_1'(tau) - f_1'(tau) - 1/kappa_0 a - 1/kappa_0 b tau",
            "F_i^n[0,0] = -sum_(g != 0) F_i^n[g,0]",
            # III.16 of the paper, with 1/k for both terms
            "g_m^n[kappa_m,k] = (2 kappa_m f_m^(n-1)[kappa_m,k-1] - k f_m^(n-1)[kappa_m,k])/k,  k = 1, 2, ...",
            "kappa_i = A l n rho/M_i",
        ],
    }[system]
    for line in lines:
        assert re.search(rf"^ +{re.escape(line)}$", text, re.MULTILINE), line


def test_equal_rates_have_fewer_families():
    for statement in json.loads(derivation("building", None, "json")):
        assert {pattern["name"]: pattern["rates"] for pattern in statement["families"]} == {
            "equal floors": ["0", "2 kappa_1", "kappa_m"],
            "equal floors, a roof of half a floor's mass": ["0", "kappa_m"],
            "all rates different": ["0", "2 kappa_(i-1),  i = 2, ..., m", "kappa_m"],
        }


@pytest.mark.parametrize(("system", "m"), [("building", 2), ("drive", 1), ("collision", 4)])
def test_the_smallest_written_out(system, m):
    statement = json.loads(derivation(system, m, "json"))[0]
    assert {pattern["size"] for pattern in statement["families"]} == {f"m = {m}"}
    for pattern in statement["families"]:
        assert {entry["of"] for entry in pattern["laws"]} == {f"{f}_{i}" for f in "fg" for i in range(1, m + 1)}
    if system == "building":  # one floor is equal to itself
        assert len(statement["families"]) == 2


@pytest.mark.quick(1)
@pytest.mark.parametrize("source", [*SYSTEMS, *NAMED])
@pytest.mark.parametrize("m", [None, 4])
def test_latex_and_text_say_as_much(source, m):
    if source in SYSTEMS:
        latex, made, text = (derivation(source, m, format) for format in ("latex", "json", "text"))
    elif m is None:
        latex, made, text = (of_scene(source, format) for format in ("latex", "json", "text"))
    else:
        return
    expected = [formula for statement in json.loads(made) for formula in formulas(statement)]
    assert latex.count(r"\law{") == len(expected)
    assert latex.count("{") == latex.count("}")
    assert all(formula in text for formula in expected)
    assert not re.search(r"\$|\*\*| \+ -", text)


def test_json_keeps_the_keys_it_had():
    (statement,) = json.loads(derivation("drive", None, "json"))
    assert {"name", "size", "start", "conditions", "equations", "recurrences"} <= statement.keys()
    assert statement["recurrences"][0].keys() == {"of", "formulas"}


@pytest.mark.quick(1)
@pytest.mark.parametrize("system", ["collision", "drive"])
def test_written_out_no_index_is_left(system):
    (statement,) = json.loads(derivation(system, 6, "json"))
    for part in ("conditions", "rods", "nodes", "equations", "recurrences", "stretches"):
        for entry in statement[part]:
            for formula in entry["formulas"]:
                assert not re.search(r"_\(?[im]\b|\b[im] [-+]", formula), formula


def test_a_scene_has_its_own_families():
    (statement,) = json.loads(of_scene("building_half_roof", "json"))
    (own,) = statement["families"]
    assert statement["size"] == "m >= 2"
    assert (own["name"], own["size"], own["rates"]) == ("building_half_roof", "m = 3", ["0", "2 kappa_0"])
    assert own["symbols"] == ["kappa_0 = 1/2"]
    assert own["given"] == ["kappa_1 = kappa_0", "kappa_2 = kappa_0", "kappa_3 = 2 kappa_0"]
    # floors 1 and 2 follow one law
    assert [entry["of"] for entry in own["laws"]] == ["f_1", "g_i,  i = 1, 2", "f_i,  i = 2, 3", "g_3"]
    (statement,) = json.loads(of_scene("collision_m4", "json"))
    assert "u_2 = v_1 - v_3 = 3/2" in statement["families"][0]["symbols"]


def test_many_rates_of_a_scene_are_told_by_one_law():
    kappa = [f"{i}/7" for i in range(1, 10)]
    scene = Scene(
        name="tower",
        system={"type": "building", "m": 8, "kappa": kappa, "base": "force"},
        load=[{"times": [0], "a": [1], "b": [0]}],
        output={"until": 4, "strain": ["1/2"]},
    )
    (statement,) = json.loads(scene_derivation(scene.name, symbolic(scene.system.chain), "json"))
    (own,) = statement["families"]
    assert len(own["rates"]) == 9
    assert "q = 2 kappa_7" in next(entry["formulas"] for entry in own["laws"] if entry["of"] == "f_8")


@pytest.mark.skipif(not shutil.which("pdflatex"), reason="no LaTeX here")
@pytest.mark.parametrize("source", [*SYSTEMS, "building_half_roof"])
def test_latex_compiles(source, tmp_path):
    made = derivation(source, None, "latex") if source in SYSTEMS else of_scene(source, "latex")
    (tmp_path / "derivation.tex").write_text(made)
    command = ["pdflatex", "-halt-on-error", "-interaction=batchmode", "derivation.tex"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 0
    assert "Overfull" not in (tmp_path / "derivation.log").read_text(errors="replace")


@pytest.mark.parametrize("arguments", [["drive", "--m", "1"], ["stepped_shaft"], ["drive", "--m", "1", "--walks"]])
def test_a_fragment_is_the_document_without_a_preamble(arguments, capsys):
    def written(*options):
        assert main(["derive", *arguments, "--format", "latex", *options]) == 0
        return capsys.readouterr().out

    whole, part = written(), written("--fragment")
    needs, _, body = part.partition("\n")
    assert needs == r"% made by wavesym; needs \usepackage{amsmath}"
    assert whole.partition("\\begin{document}\n")[2] == f"{body.rstrip()}\n\\end{{document}}\n"
    read_tex(part)
    assert main(["derive", *arguments, "--fragment"]) == 2
    assert "--fragment: text has no fragments; write --format latex" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("system", "m"), [("collision", 5), ("collision", 2), ("drive", 0), ("building", 1), ("drive", 101)]
)
def test_an_m_that_there_is_not_is_refused(system, m):
    with pytest.raises(WavesymError, match="--m: "):
        derivation(system, m, "text")
