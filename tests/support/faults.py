"""What is computed wrong in C with parameters at run time, errors then far above rounding: the text and another."""

BODIES = [
    ("const num less = 2 * own[j]", "const num less = 1.9999999 * own[j]"),
    ("first_own[j] = (real)(k % 2 ? -1 : 1)", "first_own[j] = (real)(k % 2 ? -1.0000001 : 1)"),
    ("last_own[j] = 1 - above", "last_own[j] = 1.0000001 - above"),
    ("y[j] = q[j][k] - table[j]", "y[j] = q[j][k] * (k == 3 ? 1.0000001 : 1) - table[j]"),
    ("right[k] = other * q[k] - b[k];", "right[k] = other * q[k] - (k == 1 ? 1.0000001 : 1) * b[k];"),
    ("s[k] = one * a[k] + other * b[k];", "s[k] = one * a[k] + (k == 0 ? 1.0000001 : 1) * other * b[k];"),
    ("s[k] += m->force[panel][force][k];", "s[k] += 1.0000001 * m->force[panel][force][k];"),
    ("(table[0][RATE] * (half_length[panel]", "(0 * table[0][RATE] * (half_length[panel]"),
]
"""Of masses between rods; the last one does not see what its polynomials miss."""

BLOCKS = [
    ("now[i] = one - (real)(k == 0 ? 2 : 1) * now[i]", "now[i] = one - (real)(k == 0 ? 2.0000001 : 1) * now[i]"),
    ("half * ((k == 1 ? (num)(2 * f[i][0])", "half * ((k == 1 ? (num)(1.9999999 * f[i][0])"),
    ("x[i][k] = now[i];\n            before", "x[i][k] = now[i] * (k == 3 ? 1.0000001 : 1);\n            before"),
    (
        "ratio[port] * q[point_of[port]][k] - a[k]",
        "ratio[port] * q[point_of[port]][k] - (k == 1 ? 1.0000001 : 1) * a[k]",
    ),
    ("s[k] += factor * a[k];", "s[k] += (k == 0 ? 1.0000001 : 1) * factor * a[k];"),
    ("acting[point][k] += force[force_on[point]][k];", "acting[point][k] += 1.0000001 * force[force_on[point]][k];"),
    ("rest = weight * rest * (half", "rest = 0 * weight * rest * (half"),
]
"""Of what springs link; the same."""

POINTS = [
    ("right[k] = on_right * sum - b[k];", "right[k] = on_right * sum - (k == 1 ? 1.0000001 : 1) * b[k];"),
    ("sum = one * a[k] + other * b[k];", "sum = one * a[k] + (k == 0 ? 1.0000001 : 1) * other * b[k];"),
]
"""Of points without mass."""
