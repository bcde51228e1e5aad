"""Notebooks: executed with what they claim, as pages whose pictures say what they show."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.test_documents import LINK, ROOT
from tools.notebooks import NOTEBOOKS, describe_pictures, execute, write_pages


def test_a_picture_is_described_by_its_heading() -> None:
    assert describe_pictures("# A\n![png](a.png)\n## B\n![png](b.png)\n") == "# A\n![A](a.png)\n## B\n![B](b.png)\n"
    assert describe_pictures("<p>a</p><img alt='b'>") == "<div><p>a</p><img alt='b'></div>\n"


@pytest.mark.parametrize("source", sorted(NOTEBOOKS.glob("*.py")), ids=lambda source: source.stem)
def test_links_of_notebooks_lead_somewhere(source: Path) -> None:
    text = source.read_text(encoding="utf-8")
    assert text.startswith("# %% [markdown]\n# # "), "a title first"
    assert "\nassert " in text, "something that others know is compared"
    for file, _ in LINK.findall(text):
        assert (source.parent / file).is_file(), file


@pytest.mark.slow
def test_every_notebook_runs_and_shows_pictures(tmp_path: Path) -> None:
    pytest.importorskip("jupytext")
    write_pages(tmp_path)
    for source in NOTEBOOKS.glob("*.py"):
        page = (tmp_path / source.stem).with_suffix(".md").read_text(encoding="utf-8")
        pictures = [file for file, _ in LINK.findall(page) if file.endswith(".png")]
        assert pictures, source.name
        assert all((tmp_path / picture).is_file() for picture in pictures)
        assert "<Figure" not in page, "a figure is shown, not named"
    assert "192032/390625" in (tmp_path / "hopkinson").with_suffix(".md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_cell_that_fails_stops_the_page(tmp_path: Path) -> None:
    pytest.importorskip("jupytext")
    from nbclient.exceptions import CellExecutionError

    wrong = (NOTEBOOKS / "hopkinson.py").read_text(encoding="utf-8").replace("Fraction(1, 4), 5)", "Fraction(1, 3), 5)")
    source = tmp_path / "wrong.py"
    source.write_text(wrong.replace("../../examples", (ROOT / "examples").as_posix()), encoding="utf-8")
    with pytest.raises(CellExecutionError, match="AssertionError"):
        execute(source)
