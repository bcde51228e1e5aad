"""`wavesym record`: what a file holds, in the file's digits; and a picture of it."""

from pathlib import Path

import pytest

from tests.records.test_files import AT2, CSV, EL_CENTRO, made
from wavesym.cli import main


def told(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, str]:
    """The rows that are printed, by name; the first line as `""`."""
    assert main(["record", *map(str, arguments)]) == 0
    first, *rows = capsys.readouterr().out.splitlines()
    return {"": first} | {row[2:].split("  ", 1)[0]: row[2:].split("  ", 1)[1].strip() for row in rows}


def test_el_centro_as_it_was_published(capsys):
    path = EL_CENTRO.with_suffix(".csv")
    assert told(capsys, path) == {
        "": f"{path}: CSV, accel_g",
        "samples": "1560",
        "spacing": "0.02 s",
        "first": "at 0 s",
        "duration": "31.18 s",
        "peak": "0.31882 g at 2.04 s, negative",
        "unit": "g",
        "after it": "0: in a straight line within one step, and for good",
    }


def test_at2_does_not_say_when_it_begins(capsys):
    rows = told(capsys, EL_CENTRO.with_suffix(".at2"))
    assert rows["first"] == "at 0 s (the file does not say when; `start` in a scene does)"
    assert (rows["samples"], rows["duration"], rows["peak"]) == ("1559", "31.16 s", "0.31882 g at 2.02 s, negative")


def test_what_the_file_does_not_say(tmp_path, capsys):
    path = made(tmp_path, "note,torque\na,-1.50\nb,2.70E1\n")
    rows = told(capsys, path, "--column", "torque")
    assert rows["spacing"] == "the file does not say; `spacing` in a scene does"
    assert rows["unit"] == "the file does not say; `unit` in a scene, or --unit, does"
    assert rows["peak"] == "2.70E1 at sample 2"
    assert told(capsys, path, "--column", "torque", "--unit", "kN*m")["peak"] == "2.70E1 kN*m at sample 2"
    path = made(tmp_path, "t,a\n0,.5\n0.005,-.5\n")
    assert told(capsys, path)["peak"] == ".5 at 0"
    assert told(capsys, path, "--unit", "m/s^2")["peak"] == ".5 m/s^2 at 0 s"


def test_a_gallon_is_hinted_at(tmp_path, capsys):
    path = made(tmp_path, "time [s],acc [gal]\n0,0\n0.1,1\n0.2,0\n")
    assert told(capsys, path)["unit"] == "gal, which a scene refuses: did you mean Gal?"
    assert told(capsys, made(tmp_path, "time [s],acc [Gal]\n0,0\n0.1,1\n0.2,0\n"))["unit"] == "Gal"
    assert main(["init", "frame", "--record", str(path)]) == 0
    path = made(tmp_path, "time [s],acc [gal]\n0,0\n0.1,1\n0.2,0\n")
    capsys.readouterr()
    assert main(["init", "frame", "--record", str(path)]) == 2
    assert capsys.readouterr().err.endswith("the load of a frame is an acceleration. Did you mean Gal?\n")
    assert told(capsys, made(tmp_path, "time [s],acc [G]\n0,0\n0.1,1\n"))["unit"].endswith("did you mean g?")
    path = made(tmp_path, "time [s],acc [%g]\n0,0\n0.1,1\n0.2,0\n")
    assert told(capsys, path)["unit"].startswith("%g, which a scene does not know; write another")
    assert main(["init", "frame", "--record", str(path)]) == 2
    assert '"%g" is not a known unit' in capsys.readouterr().err


@pytest.mark.quick(1)
@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_it_is_drawn_with_its_peak(tmp_path, capsys, suffix):
    out = tmp_path / f"quake.{suffix}"
    told(capsys, made(tmp_path, CSV), "-o", out)
    first = out.read_bytes()
    assert first.startswith(b"\x89PNG" if suffix == "png" else b"<?xml")
    assert suffix == "png" or b"3 g at 0.04 s" in first
    told(capsys, made(tmp_path, CSV), "-o", out)
    assert out.read_bytes() == first


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["a.txt", "--unit", "m/s^2"], "a.txt: --unit m/s^2 is not that of the file; write g, or none"),
        (["a.txt", "--column", "x"], "a.txt: an AT2 file has one column"),
        (["none.at2"], "none.at2: No such file or directory; write a file of AT2 or CSV"),
        (["bad.csv"], "bad.csv: line 4: column 2 (accel_g) is no decimal"),
        (["a.txt", "-o", "a.doc"], "a.doc: not a picture; write a name that ends in .svg, .png, .pdf"),
        (["a.txt", "-o", "a.txt"], "wavesym record: -o: a.txt is the record itself; write another file"),
        (["uneven.csv"], "uneven.csv: line 5: the time 0.05 should be 0.04"),
        (["a.txt", "--unit", "\x1b[2J"], "--unit: "),
    ],
)
def test_what_is_wrong_is_one_line_and_nothing_is_written(tmp_path, monkeypatch, capsys, arguments, said):
    monkeypatch.chdir(tmp_path)
    made(tmp_path, AT2)
    made(tmp_path, CSV.replace("-0.5", "NaN"), "bad.csv")
    made(tmp_path, CSV.replace("0.04", "0.05"), "uneven.csv")
    before = {path.name: path.read_bytes() for path in Path().iterdir()}
    assert main(["record", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(said)
    assert err.count("\n") == 1
    assert {path.name: path.read_bytes() for path in Path().iterdir()} == before
