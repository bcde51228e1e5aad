"""All outputs of building_m2 at tau = 2.5, and the largest strain at the foot, from Python by cffi."""

import json
import sys
from pathlib import Path

import cffi

about = json.loads(Path("building_m2/building_m2.json").read_text(encoding="utf-8"))
ffi = cffi.FFI()
ffi.cdef("""
    int building_m2_eval(double tau, double *out);
    int building_m2_sample(double tau0, double dtau, size_t count, double *out);
""")
library = ffi.dlopen(sys.argv[1])

out = ffi.new("double[]", len(about["outputs"]))
assert library.building_m2_eval(2.5, out) == 0
for output, value in zip(about["outputs"], out, strict=True):
    print(f"{output['name']} {value:.12g}")

rows = ffi.new("double[]", len(out) * 2001)
assert library.building_m2_sample(0.0, about["tau_max"] / 2000, 2001, rows) == 0
print(f"largest {max(rows[0:2001]):.12g}")
