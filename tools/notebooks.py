"""Notebooks of docs/notebooks, kept as text: executed, and written as pages with what they print and draw."""

from __future__ import annotations

import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from tools.formulas import typeset

ROOT = Path(__file__).parents[1]
NOTEBOOKS = ROOT / "docs" / "notebooks"
HEADING = re.compile(r"^#+ (.*)$")


def execute(source: Path) -> Any:
    """A notebook, run in its own folder.

    Args:
        source: Python in cells between `# %%`, as jupytext reads it.

    Returns:
        The notebook of nbformat, with outputs.

    Raises:
        nbclient.exceptions.CellExecutionError: where a cell raises.
    """
    import jupytext
    from nbclient import NotebookClient

    notebook = jupytext.read(source)
    where = {"metadata": {"path": str(source.parent)}}
    client = NotebookClient(notebook, kernel_name="python3", resources=where, extra_arguments=["--log-level=ERROR"])
    return client.execute()


def write_page(notebook: Any, page: Path) -> None:
    """Write an executed notebook as Markdown, its pictures beside it."""
    from nbconvert.exporters import MarkdownExporter

    resources = {"output_files_dir": f"{page.stem}_files"}
    text, found = MarkdownExporter().from_notebook_node(notebook, resources=resources)
    page.write_text(typeset(describe_pictures(text)), encoding="utf-8")
    for name, picture in found["outputs"].items():
        path = page.parent / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(picture)


def describe_pictures(text: str) -> str:
    """Markdown in which a picture is described by the heading that it stands under, and HTML stays where it is."""
    lines, heading = [], ""
    for line in text.splitlines():
        if found := HEADING.match(line):
            heading = found[1]
        line = re.sub(r"^!\[png\]", f"![{heading}]", line)
        lines.append(f"<div>{line}</div>" if line.startswith("<p>") else line)
    return "\n".join([*lines, ""])


def write_pages(folder: Path) -> None:
    """Execute every notebook and write its page into a folder."""
    sources = sorted(NOTEBOOKS.glob("*.py"))
    with ThreadPoolExecutor(2) as workers:
        for source, notebook in zip(sources, workers.map(execute, sources), strict=True):
            write_page(notebook, folder / f"{source.stem}.md")
