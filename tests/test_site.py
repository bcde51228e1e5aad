"""The site of `make docs`: all pictures, all public names, and no link that leads nowhere."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

import wavesym
from tests.pictures.browser import axe, reported
from tests.pictures.test_page import LOOK
from tools.notebooks import NOTEBOOKS
from tools.site import NAMED, PAGES, ROOT, gallery, lay_out, public_names

FOREIGN = re.compile(r'<(?:script|img|iframe)[^>]* src="?(?:https?:)?//|<link[^>]* href="?(?:https?:)?//')


def test_the_gallery_has_every_picture_of_the_examples() -> None:
    page = gallery(ROOT / "examples")
    shown = set(re.findall(r"\]\((\S+\.png)\)", page))
    assert shown == {path.relative_to(ROOT).as_posix() for path in (ROOT / "examples").glob("*/*.png")}
    assert all((ROOT / link).is_file() for link in re.findall(r"\]\(([^)]*)\)", page))
    pages = [path.parent for path in (ROOT / "examples").glob("*/README.md")]
    assert all(f"(examples/{folder.name}/README.md)" in page for folder in pages)
    assert [folder.name for folder in pages if [*folder.glob("*.toml")] and not [*folder.glob("*.png")]] == []


def test_every_public_name_has_its_docstring_on_the_site() -> None:
    assert public_names().count("\n::: ") == len(wavesym.__all__) - 1


def test_blocks_that_are_saved_are_titled() -> None:
    assert (
        NAMED.sub(r'```\1 title="\2"', "```toml a.toml\nx\n```\n```sh\n") == '```toml title="a.toml"\nx\n```\n```sh\n'
    )


def test_every_page_of_the_menu_is_laid_out(tmp_path: Path) -> None:
    lay_out(tmp_path / "pages")
    menu = re.findall(r"^ *-.*?(\S+\.md)$", (ROOT / "mkdocs.yml").read_text().partition("\nnav:")[2], re.MULTILINE)
    notebooks = {f"docs/notebooks/{path.stem}.md" for path in NOTEBOOKS.glob("*.py")}
    assert notebooks <= set(menu)
    assert [name for name in menu if not (tmp_path / "pages" / name).is_file() and name not in notebooks] == []


def build(project: Path) -> subprocess.CompletedProcess[str]:
    """Build the site of a folder that holds mkdocs.yml and build/pages."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
    return subprocess.run(command, cwd=project, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_site_builds_and_a_broken_link_is_seen(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    pages = tmp_path / PAGES.relative_to(ROOT)
    lay_out(pages)
    for source in NOTEBOOKS.glob("*.py"):  # those of executed ones are seen in tests/tools
        (pages / "docs" / "notebooks" / source.stem).with_suffix(".md").write_text(f"# {source.stem}\n")
    done = build(tmp_path)
    assert done.returncode == 0, done.stderr
    site = tmp_path / "build" / "site"
    assert (site / "index.html").is_file()
    assert [page.name for page in site.rglob("*.html") if FOREIGN.search(page.read_text(encoding="utf-8"))] == []
    with (pages / "README.md").open("a") as page:
        page.write("\n[nothing](docs/nothing.svg)\n")
    done = build(tmp_path)
    assert done.returncode == 1
    assert "docs/nothing.svg" in done.stderr


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and says nothing of it."""

    def log_message(self, format: str, *values: object) -> None:
        """Nothing."""


@pytest.mark.slow
def test_axe_finds_nothing_on_pages_of_the_site(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    lay_out(tmp_path / PAGES.relative_to(ROOT))
    for source in NOTEBOOKS.glob("*.py"):
        page = tmp_path / PAGES.relative_to(ROOT) / "docs" / "notebooks" / source.stem
        page.with_suffix(".md").write_text(f"# {source.stem}\n")
    assert build(tmp_path).returncode == 0
    site = tmp_path / "build" / "site"
    handler = partial(Quiet, directory=site)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:  # large pages are slow from a disk
        Thread(target=server.serve_forever, daemon=True).start()
        for name in ("index.html", "gallery.html", "docs/tutorials/structures.html", "generated/errata.html"):
            page = site / name
            address = f"http://127.0.0.1:{server.server_address[1]}/{Path(name).parent.as_posix()}"
            text = page.read_text(encoding="utf-8")
            assert reported(text, axe() + LOOK, page.parent, address) == [], name
        server.shutdown()


def test_examples_in_docstrings_are_code() -> None:
    pytest.importorskip("griffe")
    from tools.docstrings import fence_examples

    assert fence_examples("A.\n\n>>> 1 + 1\n2\n\nB.\n") == "A.\n\n```pycon\n>>> 1 + 1\n2\n```\n\nB.\n"
