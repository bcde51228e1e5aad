"""Headless Chromium, where there is one: a page after its script and one more have run."""

from __future__ import annotations

import html
import importlib.util
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_SECONDS = 300  # a large page on a busy machine
_REPORTED = re.compile(r'<pre id="reported">(.*?)</pre>', re.DOTALL)


def reported(page: str, script: str, folder: Path, address: str = "") -> object:
    """What a script says of a page: it is run at the end, and calls `report(value)` once.

    The page is a file in `folder`, or what a server of that folder gives at `address`.
    """
    browser = next(filter(None, map(shutil.which, _NAMES)), None)
    if browser is None:
        pytest.skip("no Chromium (Debian: apt install chromium)")
    tell = (
        "function report(value) { const told = document.createElement('pre'); told.id = 'reported';"
        "told.textContent = JSON.stringify(value); document.body.appendChild(told); }"
    )
    file = folder / "page.html"
    file.write_text(page.replace("</body>", f"<script>{tell}\n{script}</script></body>"), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}"]
    shown = subprocess.run(
        [
            browser,
            *options,
            "--virtual-time-budget=20000",
            "--dump-dom",
            f"{address}/{file.name}" if address else file.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=_SECONDS,
        check=True,
    )
    found = _REPORTED.search(shown.stdout)
    assert found, shown.stderr
    return json.loads(html.unescape(found[1]))


def axe() -> str:
    """The source of axe-core, from the package that has it."""
    found = importlib.util.find_spec("axe_core_python")
    if found is None or not found.submodule_search_locations:
        pytest.skip("no axe-core (pip install axe-core-python)")
    return Path(found.submodule_search_locations[0], "axe.min.js").read_text(encoding="utf-8")
