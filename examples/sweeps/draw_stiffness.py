"""The greatest strain of each shaft over both kappas, from the folder of the sweep."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import wavesym

mpl.rcParams.update({"font.family": "DejaVu Sans", "font.size": 12})
found = wavesym.sweep("stiffness.toml", "stiffness")
size = np.maximum(abs(found["min"]), abs(found["max"]))
k1, k2 = (size[f"system.kappa[{k}]"].values for k in (0, 1))

figure = Figure(figsize=(6.9, 9.6), dpi=120, layout="constrained")
for axes, output in zip(figure.subplots(2, 1), size["output"].values, strict=True):
    values = size.sel(output=output).values
    cells = axes.pcolormesh(k1, k2, values.T, cmap="viridis", shading="nearest")
    figure.colorbar(cells, ax=axes, label="greatest size of the strain")
    at = np.unravel_index(np.argmax(values), values.shape)
    axes.plot(k1[at[0]], k2[at[1]], "o", color="white", markeredgecolor="black")
    axes.set(xlabel="kappa_1", ylabel="kappa_2")
    axes.set_title(f"Strain at {output[7:]}: at most {values[at]:.2f}, at the spot", loc="left", weight="bold", size=12)
    print(f"{output}: from {values.min():.3f} to {values[at]:.3f}, at kappa = {k1[at[0]]:.1f}, {k2[at[1]]:.1f}")
figure.savefig("stiffness.png", metadata={"Software": None})
