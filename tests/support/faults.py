"""What is computed wrong in C with parameters at run time, errors then far above rounding: the text and another."""

BODIES = [
    ("const num less = 2 * own", "const num less = 1.9999999 * own"),
    ("first = (real)(k % 2 ? -1 : 1)", "first = (real)(k % 2 ? -1.0000001 : 1)"),
    ("last = 1 - above", "last = 1.0000001 - above"),
    ("y[j] = q[j][k] - table[j]", "y[j] = q[j][k] * (k == 3 ? 1.0000001 : 1) - table[j]"),
    ("on_right[j] * y[j] - b[j][k];", "on_right[j] * y[j] - (k == 1 ? 1.0000001 : 1) * b[j][k];"),
    ("+ other[j] * b[j][k - 1];", "+ (k == 1 ? 1.0000001 : 1) * other[j] * b[j][k - 1];"),
    ("below += e->drive[j] * e->", "below += 1.0000001 * e->drive[j] * e->"),
    ("(e->rate[j] * (half", "(0 * e->rate[j] * (half"),
]
"""Of masses between rods; the last one does not see what its polynomials miss."""

BLOCKS = [
    ("now[i] = one - (real)(k == 0 ? 2 : 1) * now[i]", "now[i] = one - (real)(k == 0 ? 2.0000001 : 1) * now[i]"),
    ("half * ((k == 1 ? (num)(2 * f[i][0])", "half * ((k == 1 ? (num)(1.9999999 * f[i][0])"),
    ("m->stride, y, n, -1, now);", "m->stride, y, n, k == 3 ? -1.0000001 : -1, now);"),
    (
        "ratio[port] * q[point_of[port]][k] - a[k]",
        "ratio[port] * q[point_of[port]][k] - (k == 1 ? 1.0000001 : 1) * a[k]",
    ),
    (
        "&law->push[port], m->waves[now->arrived[arrive[port]]][panel], degree);",
        "&law->push[port], m->waves[now->arrived[arrive[port]]][panel], degree); s[point_of[port]][0] *= 1.0000001;",
    ),
    ("k < count ? acting[k]", "k < count ? 1.0000001 * acting[k]"),
    ("rest = weight * rest * (half", "rest = 0 * weight * rest * (half"),
]
"""Of what springs link; the same."""

POINTS = [
    ("right[k] = on_right * sum - b[k];", "right[k] = on_right * sum - (k == 1 ? 1.0000001 : 1) * b[k];"),
    ("sum = one * a[k] + other * b[k];", "sum = one * a[k] + (k == 0 ? 1.0000001 : 1) * other * b[k];"),
]
"""Of points without mass."""
