"""python -m tools.site: lay out the pages of the site in build/pages, as mkdocs.yml expects them.

Folders stay as they are in the project, so that a link works there and on the site. Two pages are written here: the
gallery, from the pictures of examples/, and the public names, which mkdocstrings fills from their docstrings. Notebooks
are executed, and are pages with what they print and draw; the errata show first what changes results.
"""

from __future__ import annotations

import re
import shutil
import tomllib
from pathlib import Path

import wavesym
from tools.errata import errata_page
from tools.notebooks import write_pages

ROOT = Path(__file__).parents[1]
PAGES = ROOT / "build" / "pages"
FOLDERS = ("docs", "examples", "bench", "generated")
FILES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "CITATION.cff", "LICENSE")
NAMED = re.compile(r"^```(\w+) (\S+)$", re.MULTILINE)  # a block with the file that it is saved as
NOTEBOOK = re.compile(r"(\]\([^)]*notebooks/\w+)\.py\)")  # a link, which leads to its page here
TITLE = re.compile(r"^# (.*)$", re.MULTILINE)


def gallery(examples: Path) -> str:
    """A page with every picture of the examples, each beside a link to the page that draws it.

    Args:
        examples: the folder examples/; its pictures lie beside the README.md of each example.

    Returns:
        Markdown, with links from the folder above.
    """
    lines, others = ["# Gallery", "", "Each picture leads to the page with its scene and its commands."], []
    for page in sorted(examples.glob("*/README.md")):
        pictures = sorted(page.parent.glob("*.png"))
        title = TITLE.search(page.read_text(encoding="utf-8"))
        assert title, page
        link = f"{examples.name}/{page.parent.name}"
        if pictures:
            lines += ["", f"## [{title[1]}]({link}/README.md)", ""]
        else:
            others.append(f"[{title[1]}]({link}/README.md)")
        for picture in pictures:
            scene = picture.with_suffix(".toml")
            fields = tomllib.loads(scene.read_text(encoding="utf-8")) if scene.is_file() else {}
            called = str(fields.get("name", picture.stem)).replace("_", " ")
            name = called[0].upper() + called[1:]
            shown = f"![]({link}/{picture.name}){{ loading=lazy }}"
            lines += [f"[{shown}{name}]({link}/README.md){{ .thumbnail }}", ""]
    return "\n".join([*lines, "", f"Without pictures: {', '.join(others)}.", ""])


def public_names() -> str:
    """A page on which mkdocstrings puts the docstring of each public name."""
    names = [name for name in wavesym.__all__ if name != "__version__"]
    return "\n".join(
        ["# Python, from docstrings", "", *(f"::: {home(name)}\n" for name in sorted(names, key=str.lower))]
    )


def home(name: str) -> str:
    """Where a public name is defined, as `module.name`."""
    found = getattr(wavesym, name)
    return f"{found.__module__}.{found.__qualname__}"


def lay_out(pages: Path) -> None:
    """Write all pages anew into a folder."""
    shutil.rmtree(pages, ignore_errors=True)
    pages.mkdir(parents=True)
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, pages / folder)
    for file in FILES:
        shutil.copy(ROOT / file, pages)
    for page in pages.rglob("*.md"):
        text = NAMED.sub(r'```\1 title="\2"', page.read_text(encoding="utf-8"))
        page.write_text(NOTEBOOK.sub(r"\1.md)", text), encoding="utf-8")
    errata = pages / "generated" / "errata.md"
    errata.write_text(errata_page(errata.read_text(encoding="utf-8")), encoding="utf-8")
    (pages / "gallery.md").write_text(gallery(pages / "examples"), encoding="utf-8")
    (pages / "docs" / "api.md").write_text(public_names(), encoding="utf-8")


if __name__ == "__main__":
    lay_out(PAGES)
    write_pages(PAGES / "docs" / "notebooks")
