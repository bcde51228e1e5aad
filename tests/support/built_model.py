"""C with parameters at run time, compiled and loaded."""

import ctypes
import json
import re
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np

from tests.support.builds import LANGUAGES, STRICT
from wavesym import api as ways
from wavesym import evaluator
from wavesym.programs.request import PARTS, POSITIVE
from wavesym.running.native import library, struct_size
from wavesym.scene import Scene


def written(scene, runtime, folder, changes=(), precision="double", parts=PARTS, kappa_max=100):
    """The files of a scene, with `changes` (old, new) in NAME.c; for bodies as light as tests have them."""
    largest = None if POSITIVE.isdisjoint(runtime) else kappa_max
    made = dict(_generated(scene.model_dump_json(), tuple(runtime), precision, tuple(parts), largest))
    for old, new in changes:
        assert old in made[f"{scene.name}.c"], old
        made[f"{scene.name}.c"] = made[f"{scene.name}.c"].replace(old, new)
    for file, text in made.items():
        (folder / file).write_text(text)


@cache
def _generated(scene, runtime, precision, parts, kappa_max):
    asked = {"runtime": runtime, "precision": precision, "parts": parts, "kappa_max": kappa_max}
    with TemporaryDirectory() as folder:
        paths = ways.generate(Scene(**json.loads(scene)), folder, **asked)
        return tuple((path.name, path.read_text()) for path in paths)


class BuiltModel:
    """One model; parameters are given one after the other, in the order of the struct.

    It is not optimised: that would take three times as long as all that tests ask of it.
    """

    def __init__(self, scene, runtime, folder, changes=(), flags=("-O0",), kappa_max=100):
        # batches are compiled where they are tested: half a second each time
        written(scene, runtime, folder, changes, parts=["gradients", "bound"], kappa_max=kappa_max)
        name = scene.name
        texts = tuple((folder / f"{name}.{suffix}").read_text() for suffix in ("h", "c"))
        self.library = library(texts[1], (*LANGUAGES["c99"][1:], *STRICT, *flags), (f"{name}.h", texts[0]))
        self.outputs = len(scene.outputs)
        self.until = float(re.search(r"_TAU_MAX (\S+)", texts[0])[1])
        self.model, self.tangent = (
            np.zeros(struct_size(self.library, kind), np.uint8) for kind in ("model", "tangent")
        )
        self._build = getattr(self.library, f"{name}_build")
        self._build.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        self._estimate = getattr(self.library, f"{name}_error_estimate")
        self._estimate.argtypes, self._estimate.restype = [ctypes.c_void_p], ctypes.c_double
        self._bound = getattr(self.library, f"{name}_error_bound")
        self._bound.argtypes = [ctypes.c_void_p] * 3
        self._eval = getattr(self.library, f"{name}_model_eval")
        self._eval.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
        self._sample = getattr(self.library, f"{name}_model_sample")
        self._sample.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 2, ctypes.c_size_t, ctypes.c_void_p]

        self._build_tangent = getattr(self.library, f"{name}_build_tangent")
        self._build_tangent.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        self._tangents = getattr(self.library, f"{name}_tangent_sample")
        self._tangents.argtypes = self._sample.argtypes
        self._tangent_estimate = getattr(self.library, f"{name}_tangent_estimate")
        self._tangent_estimate.argtypes = [ctypes.c_void_p, ctypes.c_int]
        self._tangent_estimate.restype = ctypes.c_double

    def tangents(self, parameters, tau0, dtau, count):
        """Values and derivatives, of shape (1 + parameters, outputs, count)."""
        given = np.array([float(number) for number in parameters])
        status = self._build_tangent(self.tangent.ctypes.data, given.ctypes.data)
        out = np.empty((1 + len(given), self.outputs, count))
        return status or self._tangents(self.tangent.ctypes.data, tau0, dtau, count, out.ctypes.data), out

    def tangent_estimate(self, lane):
        return self._tangent_estimate(self.tangent.ctypes.data, lane)

    def build(self, *parameters):
        given = np.array([float(number) for number in parameters])
        return self._build(self.model.ctypes.data, given.ctypes.data)

    @property
    def estimate(self):
        return self._estimate(self.model.ctypes.data)

    def bound(self, *parameters):
        """What error_bound returns, and the bounds; the model is built, too."""
        given = np.array([float(number) for number in parameters])
        out = np.empty(self.outputs)
        return self._bound(self.model.ctypes.data, given.ctypes.data, out.ctypes.data), out

    def at(self, tau):
        out = np.empty(self.outputs)
        return self._eval(self.model.ctypes.data, tau, out.ctypes.data), out

    def errors(self, scene, count=301):
        """Of each output the largest error relative to its largest value; below, by no more than what samples miss."""
        step = self.until / (count - 1)
        _, found = self.sample(0.0, step, count)
        true = evaluator(scene)(np.array([k * step for k in range(count)]))
        largest, wrong = np.max(np.abs(true), axis=1), np.max(np.abs(found - true), axis=1)
        assert np.all(wrong[largest == 0] == 0)
        return wrong / np.where(largest > 0, largest, 1)

    def sample(self, tau0, dtau, count):
        out = np.empty((self.outputs, count))
        return self._sample(self.model.ctypes.data, tau0, dtau, count, out.ctypes.data), out
