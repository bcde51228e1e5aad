"""C with parameters at run time, compiled and loaded."""

import ctypes
import re

import numpy as np

from tests.support.builds import LANGUAGES, STRICT
from wavesym import compiler as ways
from wavesym.running.toolchain import compiler


def written(scene, runtime, folder, changes=()):
    """The files of a scene, with `changes` (old, new) in NAME.c."""
    ways.generate(scene, folder, runtime=runtime)
    path = folder / f"{scene.name}.c"
    text = path.read_text()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path.write_text(text)
    return text


class BuiltModel:
    """One model; parameters are given one after the other, in the order of the struct."""

    def __init__(self, scene, runtime, folder, changes=(), flags=("-O2",)):
        written(scene, runtime, folder, changes)
        name = scene.name
        size = f'#include "{name}.h"\nextern const size_t size;\nconst size_t size = sizeof({name}_model);\n'
        (folder / "size.c").write_text(size)
        command = [*LANGUAGES["c99"], *STRICT, *flags, "-fPIC", "-shared", f"{name}.c", "size.c", "-o", "made.so"]
        compiler().run(command, folder)
        self.library = ctypes.CDLL(str(folder / "made.so"))
        self.outputs = len(scene.outputs)
        self.until = float(re.search(r"_TAU_MAX (\S+)", (folder / f"{name}.h").read_text())[1])
        self.model = np.zeros(ctypes.c_size_t.in_dll(self.library, "size").value, np.uint8)
        self._build = getattr(self.library, f"{name}_build")
        self._build.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        self._estimate = getattr(self.library, f"{name}_error_estimate")
        self._estimate.argtypes, self._estimate.restype = [ctypes.c_void_p], ctypes.c_double
        self._eval = getattr(self.library, f"{name}_model_eval")
        self._eval.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
        self._sample = getattr(self.library, f"{name}_model_sample")
        self._sample.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 2, ctypes.c_size_t, ctypes.c_void_p]

    def build(self, *parameters):
        given = np.array([float(number) for number in parameters])
        return self._build(self.model.ctypes.data, given.ctypes.data)

    @property
    def estimate(self):
        return self._estimate(self.model.ctypes.data)

    def at(self, tau):
        out = np.empty(self.outputs)
        return self._eval(self.model.ctypes.data, tau, out.ctypes.data), out

    def sample(self, tau0, dtau, count):
        out = np.empty((self.outputs, count))
        return self._sample(self.model.ctypes.data, tau0, dtau, count, out.ctypes.data), out
