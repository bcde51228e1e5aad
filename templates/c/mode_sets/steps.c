/* steps.c: oscillators, step by step, and what outputs are then. */
#include "estimate.c"

static void rest(motion *s)
{
    const motion none = {{0}, {0}, {0}, {0}, {0}};
    *s = none;
}

/* How they move `time` later, for which `t` are the turns, while loads go by `slope`. */
static BY_ITSELF void advance(const model *m, const turns *t, real time, const real *slope, const motion *s, motion *out)
{
    real start[MODES] = {0};
    real ramp[MODES] = {0};
    for (int j = 0; j < LOADS; ++j) {
        for (int n = 0; n < MODES; ++n) {
            start[n] += m->push[j][n] * s->load[j];
            ramp[n] += m->push[j][n] * slope[j];
        }
    }
    for (int n = 0; n < MODES; ++n) {
        const real y = s->y[n];
        const real v = s->v[n];
        out->y[n] = t->p11[n] * y + t->p12[n] * v + t->one[n] * start[n] + t->two[n] * ramp[n];
        out->v[n] = t->p21[n] * y + t->p22[n] * v + t->p12[n] * start[n] + t->one[n] * ramp[n];
    }
    for (int j = 0; j < LOADS; ++j) {
        const real load = s->load[j];
        const real once = s->once[j];
        out->twice[j] = s->twice[j] + time * (once + time / 2 * (load + time / 3 * slope[j]));
        out->once[j] = once + time * (load + time / 2 * slope[j]);
        out->load[j] = load + time * slope[j];
    }
}

/* All outputs of TOGETHER motions, and zeros up to FILLED: sums side by side, as one waits for each of its additions. */
static void read_together(const model *m, const motion *const *s, real *const *out)
{
    for (int first = 0; first < FILLED; first += LANES) {
        slice sum[TOGETHER];
        UNROLLED
        for (int k = 0; k < TOGETHER; ++k) {
            sum[k] = *(const slice *)(m->direct[0][0] + first) * s[k]->load[0];
            for (int j = 1; j < LOADS; ++j) {
                sum[k] += *(const slice *)(m->direct[j][0] + first) * s[k]->load[j];
            }
            for (int j = 0; SUMS && j < LOADS; ++j) {
                sum[k] += *(const slice *)(m->direct[j][1] + first) * s[k]->once[j];
                sum[k] += *(const slice *)(m->direct[j][2] + first) * s[k]->twice[j];
            }
        }
        for (int n = 0; n < MODES; ++n) {
            const slice weight = *(const slice *)(m->moved[n] + first);
            UNROLLED
            for (int k = 0; k < TOGETHER; ++k) {
                sum[k] += weight * s[k]->y[n];
            }
        }
        for (int n = 0; group_moves[first / GROUP] && n < MODES; ++n) {
            const slice weight = *(const slice *)(m->moving[n] + first);
            UNROLLED
            for (int k = 0; k < TOGETHER; ++k) {
                sum[k] += weight * s[k]->v[n];
            }
        }
        UNROLLED
        for (int k = 0; k < TOGETHER; ++k) {
            *(slice *)(out[k] + first) = sum[k];
        }
    }
}

static void read_motion(const model *m, const motion *s, real *out)
{
    const motion *all[TOGETHER];
    real *values[TOGETHER];
    for (int k = 0; k < TOGETHER; ++k) {
        all[k] = s;
        values[k] = out;
    }
    read_together(m, all, values);
}

/* The slopes of the scene's loads after their sample k. */
static void slopes_after(const model *m, int k, real *slope)
{
    for (int j = 0; j < LOADS; ++j) {
        slope[j] = (load_at(m, j, k + 1) - load_at(m, j, k)) / spacing;
    }
}
