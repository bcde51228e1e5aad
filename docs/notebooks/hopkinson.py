# %% [markdown]
# # A Hopkinson bar against its textbook fractions
#
# A striker sends a rectangular pulse through a bar, a specimen and a second bar. Every wave that meets another
# impedance is split, and the strain in the second bar climbs in steps that a textbook writes as fractions. What wavesym
# gives is compared with them: not nearly equal, equal.

# %%
from fractions import Fraction

import matplotlib.pyplot as plt
import numpy as np

import wavesym

bars = wavesym.Scene.from_toml("../../examples/chains/split_hopkinson_bar.toml")
bars

# %% [markdown]
# ## The textbook
#
# The bars have the impedance 1, the specimen Z = 1/4. At a change from $Z_1$ to $Z_2$ a wave of force goes on with
#
# $$T = \frac{2 Z_2}{Z_1 + Z_2}, \qquad R = \frac{Z_2 - Z_1}{Z_1 + Z_2}.$$
#
# The pulse has the strain $-\tfrac12$, as the striker and the bar are alike. It enters the specimen with $T_{in}$ and
# leaves it with $T_{out}$; what stays inside is reflected at both ends, with $R^2$ for each way to and fro:
#
# $$\varepsilon_n = -\tfrac12\, T_{in} T_{out} \sum_{k=0}^{n-1} R^{2k}.$$


# %%
def passed(first: Fraction, second: Fraction) -> Fraction:
    return 2 * second / (first + second)


def textbook(impedance: Fraction, arrivals: int) -> list[Fraction]:
    """The strain in the second bar after each arrival of the pulse's front."""
    bar = Fraction(1)
    back = (bar - impedance) / (bar + impedance)
    first = -passed(bar, impedance) * passed(impedance, bar) / 2
    return [first * sum(back ** (2 * k) for k in range(n)) for n in range(1, arrivals + 1)]


steps = textbook(Fraction(1, 4), 5)
print(", ".join(map(str, steps)))

# %% [markdown]
# ## wavesym
#
# The front needs 5 to the specimen, 1/2 through it and 5/2 to the gauge at 10, so it arrives at 8; then a part goes to
# and fro in the specimen, 1 each time. Between two arrivals the strain stands still.

# %%
exact = wavesym.evaluator(bars)
taus = [8.5 + n for n in range(len(steps))]
values = exact(taus)[exact.outputs.index("strain@10")]
for tau, value, step in zip(taus, values, steps, strict=True):
    print(f"tau = {tau:4}: {float(value)!r:14} {step}")
assert [float(step) for step in steps[:4]] == values[:4].tolist(), "right to the last bit"

# %% [markdown]
# The fifth step is lower than that of the front alone: the pulse is 4 long, as the striker is 2, and at 12 its end has
# arrived. The end is the same wave with the other sign.

# %%
expected = steps[4] - steps[0]
print(float(values[4]), float(expected), expected)
assert values[4] == float(expected)

# %% [markdown]
# ## Other specimens
#
# The same for specimens of other impedances, a field of the scene. Impedances of 1/2 and 2 hand on the same.

# %%
for impedance in (Fraction(1, 10), Fraction(1, 2), Fraction(2), Fraction(9)):
    other = bars.with_({"system.parts[3].impedance": impedance})
    value = wavesym.evaluator(other)([10.25])[1][0]
    expected = float(textbook(impedance, 3)[-1])
    print(f"impedance {impedance!s:>4}: {value:.15f}")
    assert abs(value - expected) <= 2**-52 * abs(expected)

# %%
result = bars.run(np.linspace(0, 16, 1601))
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
axes.plot(result.time, result["strain@9/2"], label="in front of the specimen", color="0.6")
axes.plot(result.time, result["strain@10"], label="behind it")
for step in steps[:4]:
    axes.axhline(float(step), color="0.8", linewidth=0.8, zorder=0)
axes.set(xlabel="time, in crossings of a unit of bar", ylabel="strain", title="The second bar climbs in textbook steps")
axes.legend(frameon=False)
plt.show()
