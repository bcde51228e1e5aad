"""Forty synthetic records: Clough and Penzien's noise, as long, as strong and on such soil as a seed says."""

from pathlib import Path

import numpy as np

COUNT, SAMPLES, STEP = 40, 1500, 0.02  # records; samples of each; s
random = np.random.RandomState(1940)  # its numbers are the same in every version of NumPy
time = STEP * np.arange(1, SAMPLES + 1)


def filtered(noise, omega, zeta, relative):
    """What a mass on a spring does on ground that moves so: its acceleration, or that relative to the ground."""
    x = v = 0.0
    out = np.empty_like(noise)
    for k, ground in enumerate(noise):
        a = -2 * zeta * omega * v - omega**2 * x
        out[k] = a - ground if relative else a
        v += STEP * (a - ground)  # first the velocity, then the place: stable
        x += STEP * v
    return out


Path("records").mkdir(exist_ok=True)
for number in range(1, COUNT + 1):
    soil = 2.5 * np.exp(0.35 * random.standard_normal())  # Hz
    rise, strong = random.uniform(1, 4), random.uniform(5, 14)  # s
    peak = 0.3 * np.exp(0.4 * random.standard_normal())  # g
    envelope = np.minimum(1, (time / rise) ** 2) * np.exp(-0.35 * np.maximum(0, time - rise - strong))
    shaken = filtered(random.standard_normal(SAMPLES), 2 * np.pi * soil, 0.6, relative=False)
    shaken = filtered(shaken, 2 * np.pi * 0.2, 0.7, relative=True) * envelope
    samples = shaken * peak / np.max(np.abs(shaken))
    lines = [
        "Synthetic, not measured: made by wavesym/examples/sweeps/ground_motions.py",
        f"Clough-Penzien noise, soil {soil:.2f} Hz, rise {rise:.1f} s, strong for {strong:.1f} s",
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {SAMPLES:5d}, DT= {STEP:.4f} SEC",
        *("".join(f"{value:12.5f}" for value in row) for row in samples.reshape(-1, 5)),
    ]
    Path(f"records/synthetic_{number:02d}.at2").write_text("\n".join(lines) + "\n", encoding="utf-8")
