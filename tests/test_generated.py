"""generated/ holds what would be made now; `make generated` mends it."""

from pathlib import Path

import pytest

from wavesym.compiler import published, tables_text
from wavesym.emission.files import files
from wavesym.scene import Scene

KEPT = Path(__file__).parent.parent / "generated"
EXAMPLES = ("building_m2", "collision_m4", "drive_m1")


@pytest.mark.parametrize("name", EXAMPLES)
def test_kept_files_are_what_is_generated(name):
    scene = Scene.from_toml(name)
    made = files(scene, "all") | {"tables.csv": "".join(tables_text(scene, None, "csv"))}
    kept = {path.name: path.read_bytes().decode() for path in (KEPT / name).iterdir()}
    assert kept.keys() == made.keys(), "make generated"
    for file, text in made.items():
        assert kept[file] == text, f"{name}/{file} differs: make generated"


def test_the_errata_are_what_is_found_now():
    assert (KEPT / "errata.md").read_bytes().decode() == published("markdown")[0], "make generated"


def test_nothing_else_is_kept():
    assert sorted(path.name for path in KEPT.iterdir()) == sorted([*EXAMPLES, "errata.md"]), "make generated"
