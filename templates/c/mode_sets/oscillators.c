/* oscillators.c: what an oscillator does in a time. */
#include "projection.c"

/* Of displacement and velocity the entries of the matrix, and what a constant force and a growing one cause. */
typedef struct {
    real p12;
    real p22;
    real one;
    real two;
} turn;

/* A power series, where nothing much happens in s. */
static turn turn_little(real s, real w, real decay)
{
    turn made = {0, 0, 0, 0};
    real before = 0;
    real term = 1;
    for (int k = 1; k < 28; ++k) {
        const real next = -(2 * decay * s * term + w * s * w * s / k * before) / (k + 1);
        made.p22 += k * term;
        made.p12 += term;
        made.one += term / (k + 1);
        made.two += term / ((k + 1) * (k + 2));
        before = term;
        term = next;
    }
    made.p12 *= s;
    made.one *= s * s;
    made.two *= s * s * s;
    return made;
}

/* The mean of exp from -u to 0. */
static real mean_of_exp(real u)
{
    return u > 0 ? -expm1(-u) / u : 1;
}

/* Damping of 1 or more: two rates, the slow one without cancellation. */
static turn turn_creeping(real s, real w, real damping)
{
    const real apart = w * sqrt((damping - 1) * (damping + 1));
    const real decay = damping * w;
    const real fast = decay + apart;
    const real z = w * w / fast * s;
    const real x = 2 * apart * s;
    const real shrunk = exp(-z);
    real series = 1;
    turn made;
    for (int k = 20; k > 2; --k) {
        series = 1 - (z < 1 ? z : 1) / k * series;
    }
    made.p12 = s * shrunk * mean_of_exp(x);
    made.p22 = shrunk * (1 + exp(-x)) / 2 - decay * made.p12;
    made.one = s * (mean_of_exp(z) - shrunk * mean_of_exp(x)) / fast;
    made.two = (s * s * (z < 1 ? series / 2 : (1 - mean_of_exp(z)) / z) - made.one) / fast;
    return made;
}

static turn turn_swinging(real s, real w, real damping)
{
    const real decay = damping * w;
    const real turning = w * sqrt((1 - damping) * (1 + damping));
    const real shrunk = exp(-decay * s);
    const real cosine = shrunk * cos(turning * s);
    turn made;
    made.p12 = shrunk * (sin(turning * s) / turning);
    made.p22 = cosine - decay * made.p12;
    made.one = (1 - (cosine + decay * made.p12)) / (w * w);
    made.two = (s - 2 * decay * made.one - made.p12) / (w * w);
    return made;
}

/* What all oscillators do in s. */
static void turns_of(const real *frequency, const real *damping, real s, turns *t)
{
    for (int n = 0; n < MODES; ++n) {
        const real w = frequency[n];
        const real z = damping[n];
        const int little = (w + 2 * z * w) * s <= 2;
        const turn made = little ? turn_little(s, w, z * w) : z < 1 ? turn_swinging(s, w, z) : turn_creeping(s, w, z);
        t->p11[n] = made.p22 + 2 * z * w * made.p12;
        t->p12[n] = made.p12;
        t->p21[n] = -w * w * made.p12;
        t->p22[n] = made.p22;
        t->one[n] = made.one;
        t->two[n] = made.two;
    }
}
