"""Tables of coefficients as LaTeX: the same rows as the CSV, in numbers and in letters."""

from __future__ import annotations

import csv
import re

import pytest
import sympy

from tests.support.tex import read_tex
from wavesym.cli import main


def output(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["tables", *arguments]) == 0
    return capsys.readouterr().out


def value(latex: str) -> sympy.Expr:
    """What a cell says."""
    text = re.sub(r"\\t?frac\{([^{}]*(?:\{[^{}]*\}[^{}]*)*)\}\{([^{}]*(?:\{[^{}]*\}[^{}]*)*)\}", r"((\1)/(\2))", latex)
    text = re.sub(r"_\{(\w+)\}", r"_\1", text).replace(r"\,", "*").replace("\\kappa", "kappa").replace("^", "**")
    return sympy.sympify(text, {name: sympy.Symbol(name) for name in re.findall(r"[a-z]+_\d+", text)})


@pytest.mark.quick(3)
@pytest.mark.parametrize("symbolic", [[], ["--symbolic"]])
@pytest.mark.parametrize("scene", ["drive_m1", "building_m2", "collision_m4"])
def test_rows_are_those_of_the_csv(scene: str, symbolic: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    rows = list(csv.DictReader(output(capsys, scene, "--intervals", "3", *symbolic).splitlines()))
    text = output(capsys, scene, "--intervals", "3", *symbolic, "--format", "latex")
    cells = [
        line.removesuffix(r" \\").replace("$", "").split(" & ")
        for line in text.splitlines()
        if line[:2] in ("$f", "$g")
    ]
    assert len(cells) == len(rows)
    for row, (function, rod, source, interval, rate, power, coefficient) in zip(rows, cells, strict=True):
        assert [function, rod, source, interval, power] == [
            row[k] for k in ("function", "rod", "source", "interval", "power")
        ]
        for latex, plain in ((rate, row["rate"]), (coefficient, row["value"])):
            assert sympy.simplify(value(latex) - sympy.sympify(plain)) == 0


def test_a_fragment_has_no_preamble(capsys: pytest.CaptureFixture[str]) -> None:
    whole = output(capsys, "drive_m1", "--intervals", "2", "--format", "latex")
    part = output(capsys, "drive_m1", "--intervals", "2", "--format", "latex", "--fragment")
    assert r"\begin{document}" in whole
    assert r"\begin{document}" not in part
    assert r"\label{tab:drive_m1}" in part
    read_tex(part)
    body = re.sub(r"\A(%.*\n)+", "", part).strip()
    assert body in whole
    assert main(["tables", "drive_m1", "--fragment"]) == 2
    assert "--fragment: csv has no fragments; write --format latex" in capsys.readouterr().err
