# %% [markdown]
# # A frame in El Centro
#
# A steel frame of ten storeys stands on ground that moves as in El Centro in 1940. A client asks four things: the base
# shear, the largest drift, the acceleration of the roof, the periods. The scene is
# [steel.toml](../../examples/frames/steel.toml); [the example](../../examples/frames/README.md) says where its numbers
# come from.

# %%
import matplotlib.pyplot as plt
import numpy as np

import wavesym

scene = wavesym.Scene.from_toml("../../examples/frames/steel.toml")
scene

# %% [markdown]
# ## Periods
#
# `scene.modes` misses no frequency and says how much of the mass follows the ground in each mode.

# %%
modes = scene.modes(5)
for mode in modes:
    print(f"T{mode.number} = {mode.period:.3f} s, {mode.effective_mass:.1%} of the mass")

# %% [markdown]
# The same frame as ten masses on springs without weight: the stiffness of a storey's 20 columns is 12 E I/l³ each. The
# columns' own mass counts, half a storey's at each floor it stands between.

# %%
STOREYS, FLOOR, COLUMNS = 10, 350e3, 10.871e3  # kg
spring = 20 * 12 * 210e9 * 57680e-8 / 3.5**3  # N/m
stiffness = spring * (np.diag([2.0] * 9 + [1.0]) - np.eye(STOREYS, k=1) - np.eye(STOREYS, k=-1))
mass = np.full(STOREYS, FLOOR + COLUMNS)
mass[-1] -= COLUMNS / 2
lumped = 2 * np.pi / np.sqrt(np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass))))
print("masses on springs:", ", ".join(f"{period:.3f} s" for period in lumped[:3]))
assert abs(lumped[0] / modes[0].period - 1) < 1e-3

# %% [markdown]
# ## What the client gets
#
# `summary` has the extremes of every output, between samples too. The base shear is compared with the frame's weight.

# %%
summary = scene.summary()
shear = summary["force@0"].largest
weight = 9.80665 * (10 * (FLOOR + COLUMNS)) / 1e6  # MN
drift = summary["drift@1"].largest
roof = summary["acceleration@10"].largest
share = abs(shear.value) / weight
print(f"base shear         {abs(shear.value):6.2f} MN at {shear.at.time:.2f} s, {share:.1%} of the weight")
print(f"drift of storey 1  {abs(drift.value):6.2f} mm, {abs(drift.value) / 3500:.2%} of its height")
print(f"roof               {abs(roof.value):6.2f} m/s² at {roof.at.time:.2f} s")

# %%
scene.plot()

# %% [markdown]
# ## The spectrum of the roof
#
# What would a machine on the roof feel? Its largest acceleration over its own period, at 5 % damping: it is greatest
# where the machine has a period of the frame.

# %%
spectrum = wavesym.spectrum(scene)
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
axes.semilogx(spectrum.periods, spectrum["acceleration@10"])
for mode in modes[:3]:
    axes.axvline(mode.period, color="0.7", linewidth=0.8)
    axes.annotate(f"T{mode.number}", (mode.period, 1), xycoords=("data", "axes fraction"), va="top")
axes.set(xlabel="period of the machine [s]", ylabel="largest acceleration [m/s²]", title="Spectrum of the roof")
plt.show()

# %% [markdown]
# The page for the client, with all this and a table of storeys, is one line: `scene.report("frame.html")`.
