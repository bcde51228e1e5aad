"""How much stack C needs, as gcc counts it: frames of each function, and which calls which. Known from gcc 10 on."""

import re
import shutil
import subprocess
from functools import cache

import pytest

_ADDRESS = 8  # to return to
_GRAPH = "-fcallgraph-info=su"


def _graphs():
    gcc = shutil.which("gcc")
    said = subprocess.run([gcc, "--version"], capture_output=True, text=True, check=True).stdout if gcc else ""
    found = re.search(r"gcc .*?\) (\d+)\.", said)
    return found is not None and int(found[1]) >= 10


needs_graphs = pytest.mark.skipif(not _graphs(), reason="no gcc 10 or newer here")


def deepest(folder, name, *flags):
    """Of each function of NAME.c that is seen from outside how much it and all that it calls have at once, at most."""
    subprocess.run(["gcc", "-std=c99", *flags, _GRAPH, "-c", f"{name}.c", "-o", "graph.o"], cwd=folder, check=True)
    text = (folder / "graph.ci").read_text()
    own = {
        title: int(size[1]) if (size := re.search(r"(\d+) bytes \((?:static|dynamic,bounded)\)", label)) else None
        for title, label in re.findall(r'node: \{ title: "([^"]+)" label: "([^"]*)"', text)
    }
    calls = {}
    for caller, called in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text):
        calls.setdefault(caller, set()).add(called)

    @cache
    def depth(function):
        below = max((depth(called) for called in calls.get(function, ())), default=0)
        return (own[function] or 0) + _ADDRESS + below

    seen = [function for function in own if function.startswith(f"{name}_")]
    assert all(own[function] is not None for function in seen)
    return {function.removeprefix(f"{name}_"): depth(function) for function in seen}
