"""Scenes made in Python share work as the cases of a sweep do, and give what each gives by itself."""

from __future__ import annotations

import pytest

import wavesym
from wavesym.errors import SceneError, WavesymError
from wavesym.sweeps import scenes as scenes_module

KAPPA = [f"{k}/4" for k in range(2, 12)]


def variations() -> list[wavesym.Scene]:
    scene = wavesym.Scene.from_toml("drive_m1").with_({"output.tolerance": 1e-8})
    return [scene.with_({"system.kappa[0]": kappa}) for kappa in KAPPA]


def test_scenes_that_differ_in_a_number_of_a_program_share_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def alone(*_: object, **__: object) -> None:
        raise AssertionError("computed by itself")

    monkeypatch.setattr(scenes_module, "single", alone)
    found = wavesym.peaks(variations())
    assert found.cases[1] == "system.kappa[0] = 3/4"
    assert (found.bound <= 1e-8).all()
    monkeypatch.undo()
    for k in (0, 4, 9):
        true = wavesym.summary(variations()[k])
        for row, output in enumerate(true.outputs):
            allowed = (found.bound[k] + true.bound) * abs(output.largest.value)
            assert abs(found["max"][k, row] - output.max.value) <= allowed, (k, output.name)
            assert abs(found["min"][k, row] - output.min.value) <= allowed, (k, output.name)
    monkeypatch.setattr(scenes_module, "single", alone)
    with pytest.raises(AssertionError, match="by itself"):
        wavesym.peaks(variations(), keep=["max", "rms"])


def test_what_is_wrong_with_one_of_them_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    every = variations()[:2]

    def second_fails(plan: object, scene: wavesym.Scene, *, at_samples: bool) -> object:
        if scene is every[1]:
            raise WavesymError("too hard")
        return single(plan, scene, at_samples=at_samples)

    single = scenes_module.single
    monkeypatch.setattr(scenes_module, "single", second_fails)
    with pytest.raises(WavesymError, match="too hard") as caught:
        wavesym.peaks(every)
    assert caught.value.__notes__ == ["scene 1: system.kappa[0] = 3/4"]


@pytest.mark.parametrize("keep", [["most"], ["max", "max"]])
def test_a_statistic_that_is_none_is_refused(keep: list[str]) -> None:
    with pytest.raises(WavesymError, match=r"keep\[\d\]: "):
        wavesym.peaks(variations()[0], keep=keep)


def test_a_sweep_names_the_keys_of_what_is_kept(tmp_path) -> None:
    request = {"scene": "drive_m1", "vary": {"output.until": [4, 5]}, "keep": ["peak"]}
    with pytest.raises(SceneError, match=r"summary = \["):
        wavesym.sweep(request, tmp_path / "made")


def test_the_command_that_brings_an_extra_works_from_any_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib import metadata

    from wavesym.errors import install_command

    class Installed:
        def __init__(self, text: str | None) -> None:
            self.text = text

        def read_text(self, _: str) -> str | None:
            return self.text

    source = '{"dir_info": {"editable": true}, "url": "file:///my%20work/wavesym"}'
    for text, command in (
        (source, "pip install -e '/my work/wavesym[sweep]'"),
        (None, "pip install 'wavesym[sweep]'"),
        ('{"archive_info": {}, "url": "file:///dist/wavesym.whl"}', "pip install 'wavesym[sweep]'"),
    ):
        monkeypatch.setattr(metadata, "distribution", lambda _, text=text: Installed(text))
        assert install_command("sweep") == command
