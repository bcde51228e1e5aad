# %% [markdown]
# # A drive train: frequencies and a transfer function
#
# The engine of a small ship, a clutch and a propeller on two shafts. At which speeds does it resonate, and how much of
# the engine's pulsation comes to the shafts? The scene is
# [drive_train.toml](../../examples/drive_train/drive_train.toml).

# %%
import matplotlib.pyplot as plt
import numpy as np

import wavesym

scene = wavesym.Scene.from_toml("../../examples/drive_train/drive_train.toml")
scene

# %% [markdown]
# ## Frequencies
#
# The first is that of the drive turning as a whole. With three ignitions in a turn, a frequency is met at 20 times as
# many revolutions a minute.

# %%
modes = scene.modes(5)
for mode in modes:
    print(f"{mode.number}: {mode.hz:10.4f} Hz, met at {20 * mode.hz:8.1f} rpm")

# %% [markdown]
# Three discs on two springs without weight, as many a handbook has it: nearly the same for the first two, and blind for
# what the shafts do themselves.

# %%
SHEAR, DENSITY = 80e9, 7850
polar = np.pi / 32 * np.array([0.16, 0.14]) ** 4
springs = SHEAR * polar / [4, 12]
discs = np.array([600.0, 50.0, 400.0])
stiffness = np.zeros((3, 3))
for k, spring in enumerate(springs):
    stiffness[k : k + 2, k : k + 2] += spring * np.array([[1, -1], [-1, 1]])
lumped = np.sqrt(np.abs(np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(discs, discs))))) / (2 * np.pi)
print("three discs:", ", ".join(f"{each:.4f} Hz" for each in lumped[1:]))
assert abs(lumped[1] / modes[1].hz - 1) < 0.02

# %% [markdown]
# The third and higher ones are the shafts' own, nearly as if clamped at heavy discs: c/(2 l) and its multiples.

# %%
speed = np.sqrt(SHEAR / DENSITY)
print(f"12 m of shaft, clamped: {speed / 24:.2f} Hz and {speed / 12:.2f} Hz")
print(f"wavesym:                {modes[3].hz:.2f} Hz and {modes[4].hz:.2f} Hz")
assert abs(modes[3].hz / (speed / 24) - 1) < 0.02

# %% [markdown]
# ## The transfer function
#
# `frf` has the complex amplitudes of all outputs under one unit of the engine's moment: no integration in time, no
# window, each value proved. Damping is 2 % of critical in every mode, as the scene says.

# %%
frequencies = np.geomspace(0.5, 500, 1500)
response = scene.frf(frequencies, load=0)
print(response)
figure, (size, phase) = plt.subplots(2, 1, sharex=True, figsize=(7, 5), layout="constrained")
for name, title in (("force@1/2", "shaft 1"), ("force@3/2", "shaft 2")):
    size.loglog(frequencies, np.abs(response[name]), label=title)
    phase.semilogx(frequencies, np.degrees(np.angle(response[name])))
for mode in modes[1:]:
    for axes in (size, phase):
        axes.axvline(mode.hz, color="0.85", linewidth=0.8, zorder=0)
size.set(ylabel="shaft moment / engine moment", title="Both shafts over the frequency of the engine's pulsation")
phase.set(xlabel="frequency [Hz]", ylabel="phase [degrees]", yticks=[-180, -90, 0, 90, 180])
size.legend(frameon=False)
plt.show()

# %% [markdown]
# At rest the shafts only hand on what the discs behind them need: shaft 2 carries the propeller's part of the inertia,
# 400/1050 of the moment (the shafts' own inertia adds some per mille). In resonance it carries:

# %%
shaft = np.abs(response["force@3/2"])
resonance = frequencies[shaft.argmax()]
print(f"slowly: {shaft[0]:.4f}, by inertias {400 / 1050:.4f}; at {resonance:.2f} Hz: {shaft.max():.1f}")
assert abs(shaft[0] / (400 / 1050) - 1) < 0.05
assert abs(resonance / modes[1].hz - 1) < 0.01

# %% [markdown]
# ## How it starts
#
# The record takes the engine through that resonance, at 93.6 rpm.

# %%
scene.plot()
