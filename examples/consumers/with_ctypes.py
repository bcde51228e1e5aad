"""All outputs of building_m2 at tau = 2.5, and the largest strain at the foot, from Python by ctypes."""

import ctypes
import json
import sys
from pathlib import Path

import numpy as np

library = ctypes.CDLL(sys.argv[1])
about = json.loads(Path("building_m2/building_m2.json").read_text(encoding="utf-8"))
names = [output["name"] for output in about["outputs"]]
library.building_m2_eval.argtypes = [ctypes.c_double, ctypes.c_void_p]
library.building_m2_sample.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.c_size_t, ctypes.c_void_p]

out = np.empty(len(names))
assert library.building_m2_eval(2.5, out.ctypes.data) == 0
for name, value in zip(names, out, strict=True):
    print(f"{name} {value:.12g}")

rows = np.empty((len(names), 2001))
assert library.building_m2_sample(0.0, about["tau_max"] / 2000, 2001, rows.ctypes.data) == 0
print(f"largest {rows[0].max():.12g}")
