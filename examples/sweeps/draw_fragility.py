"""How likely the lowest storey drifts by 0.5 % of its height or more, over the peak of the ground's acceleration."""

from pathlib import Path
from statistics import NormalDist

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import wavesym

STOREY, LIMIT = 3500.0, 0.005  # mm; of it
mpl.rcParams.update({"font.family": "DejaVu Sans", "font.size": 12})
found = wavesym.sweep("fragility.toml", "fragility")
drift = np.maximum(-found["min"], found["max"]).sel(output="drift@1").values / STOREY


def ground(name):
    """The peaks of a record's acceleration, in g, and of its velocity, in m/s."""
    lines = Path(name).read_text(encoding="utf-8").splitlines()
    step = float(lines[3].split("DT=")[1].split()[0])
    samples = np.array(" ".join(lines[4:]).split(), dtype=float)
    return np.max(np.abs(samples)), 9.80665 * step * np.max(np.abs(np.cumsum(samples)))


peaks = np.array([ground(str(name)) for name in found["record"].values])
synthetic = np.array(["synthetic" in str(name) for name in found["record"].values])
# the frame is linear: that many times the record is that many times the drift
capacity = peaks * LIMIT / drift[:, None]

figure = Figure(figsize=(6.9, 8.2), dpi=120, layout="constrained")
for axes, own, what, unit in zip(
    figure.subplots(2, 1), capacity.T, ("acceleration", "velocity"), ("g", "m/s"), strict=True
):
    steps = np.sort(own[synthetic])
    median, spread = np.exp(np.mean(np.log(steps))), np.std(np.log(steps), ddof=1)
    real = own[~synthetic][0]
    print(f"peak ground {what}: median {median:.3f} {unit}, spread {spread:.2f}; El Centro {real:.3f} {unit}")
    at = np.geomspace(steps[0] / 1.5, steps[-1] * 1.3, 200)
    axes.step(steps, np.arange(1, len(steps) + 1) / len(steps), where="post", color="0.5", label="40 synthetic records")
    axes.plot(at, [NormalDist().cdf(np.log(x / median) / spread) for x in at], color="black", label="lognormal")
    axes.axvline(real, color="#b2431f", linestyle="--", label="El Centro 1940")
    axes.set(xlabel=f"peak ground {what} [{unit}]", ylabel="part that drifts 0.5 % or more", ylim=(0, 1.02))
    axes.legend(loc="lower right", frameon=False)
figure.suptitle("How likely the lowest storey drifts 0.5 % or more", x=0.01, ha="left", weight="bold", size=12)
figure.savefig("fragility.png", metadata={"Software": None})
