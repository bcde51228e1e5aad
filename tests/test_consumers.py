"""Programs in other languages that use generated C: each row of examples/consumers/README.md, where its tools are."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

import wavesym
from tests.pictures.browser import reported

PLACE = Path(wavesym.__file__).parents[1] / "examples" / "consumers"
PAGE = (PLACE / "README.md").read_text(encoding="utf-8")
ROWS = {
    who: (tools.split(), line) for who, tools, line in re.findall(r"^\| (.*?) \| `(.*?)` \| `(.*)` \|$", PAGE, re.M)
}
MADE, WEB = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.M | re.S)


def run(line: str, folder: Path) -> str:
    home = {"JAVA_HOME": str(Path(java).resolve().parents[1])} if (java := shutil.which("javac")) else {}
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = MappingProxyType(home | dict(os.environ) | {"PATH": path})
    done = subprocess.run(
        ["bash", "-ec", line], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("consumers") / "here"
    shutil.copytree(PLACE, folder)
    run(MADE, folder)
    return folder


def need(tools: list[str]) -> None:
    for tool in tools:
        if not shutil.which(tool) and not importlib.util.find_spec(tool):
            pytest.skip(f"no {tool} here")


def wrong(printed: str) -> list[str]:
    """The lines that are missing, or are not what is exact, to the bound of the program and 12 digits."""
    response = wavesym.evaluator(wavesym.Scene.from_toml("building_m2"))
    grid = response(np.arange(2001) * (12.0 / 2000))
    sizes = np.abs(grid).max(axis=1)
    exact = dict(zip(response.outputs, zip(response([2.5])[:, 0], sizes, strict=True), strict=True))
    exact["largest"] = (grid[0].max(), sizes[0])
    said = dict(re.findall(r"^(\S+) (-?\d\S*)$", printed, re.M))
    return [
        name
        for name, (value, size) in exact.items()
        if not abs(float(said.get(name, "nan")) - value) <= 1e-8 * size + 1e-11  # the scene's tolerance
    ]


@pytest.mark.slow
@pytest.mark.parametrize("who", ROWS)
def test_it_has_the_values(who: str, here: Path) -> None:
    tools, line = ROWS[who]
    need(tools)
    assert wrong(run(line, here)) == []


def test_a_wrong_or_missing_value_is_seen() -> None:
    response = wavesym.evaluator(wavesym.Scene.from_toml("building_m2"))
    said = [f"{name} {value:.12g}" for name, value in zip(response.outputs, response([2.5])[:, 0], strict=True)]
    assert wrong("\n".join(said)) == ["largest"]
    assert response.outputs[1] in wrong("\n".join([said[0], said[1].replace("1", "2")]))


@pytest.mark.slow
def test_the_self_test_of_a_package_can_fail(here: Path, tmp_path: Path) -> None:
    need(["cmake"])
    shutil.copytree(here / "building_m2", tmp_path / "changed")
    source = tmp_path / "changed" / "building_m2.c"
    text = source.read_text()
    number = re.search(r"\d\.\d{9,}(?!e-)", text)
    assert number
    source.write_text(text.replace(number[0], "7" + number[0][1:]))
    run("cmake -S changed -B made && cmake --build made", tmp_path)
    with pytest.raises(AssertionError, match="building_m2_selftest"):
        run("ctest --test-dir made", tmp_path)


@pytest.mark.slow
def test_pkg_config_knows_the_package_where_it_was_installed(here: Path, tmp_path: Path) -> None:
    need(["cmake", "pkg-config", "c++"])
    run(
        f"cmake -S {here / 'building_m2'} -B made && cmake --build made && cmake --install made --prefix gone", tmp_path
    )
    (tmp_path / "gone").rename(tmp_path / "moved")
    line = (
        "export PKG_CONFIG_PATH=$(dirname $(find $PWD/moved -name building_m2.pc)); "
        f"c++ {here / 'values.cpp'} $(pkg-config --cflags --libs building_m2) -o values; ./values"
    )
    assert wrong(run(line, tmp_path)) == []


@pytest.mark.slow
def test_a_slider_draws_another_curve(here: Path) -> None:
    """The page in a browser: its figures are those of a scene that has the kappa of the slider."""
    need(["ziglang"])
    run(WEB, here)
    web = here / "web"
    served = ThreadingHTTPServer(("127.0.0.1", 0), partial(SimpleHTTPRequestHandler, directory=str(web)))
    threading.Thread(target=served.serve_forever, daemon=True).start()
    script = """
      const said = [], look = () => said.push([told.value, curve.getAttribute("points").length]);
      const wait = setInterval(() => {
        if (!told.value) return;
        clearInterval(wait);
        look();
        slider.value = "2.5"; slider.dispatchEvent(new Event("input")); look();
        report(said);
      }, 10);
    """
    try:
        address = f"http://127.0.0.1:{served.server_address[1]}"
        said = reported((web / "page.html").read_text(encoding="utf-8"), script, web, address)
    finally:
        served.shutdown()
    for (told, drawn), kappa in zip(said, ("0.6", "2.5"), strict=True):  # type: ignore[call-overload]
        scene = wavesym.Scene.from_toml("building_m2").with_({"system.kappa": ["1/4", kappa, "1/5"]})
        row = wavesym.evaluator(scene)(np.arange(601) * (12.0 / 600))[0]
        assert told.startswith(f"{kappa}: largest ")
        assert float(told.split()[2].rstrip(",")) == pytest.approx(np.abs(row).max(), rel=1e-7)
        assert drawn > 601 * 4
