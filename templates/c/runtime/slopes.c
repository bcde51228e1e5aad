/* slopes.c: the march of runtime.c for derivatives by parameters.
 * Plain C that stands below the text of read.c in generated files, which have what stands below the first empty line. */
#include "read.c"

/* How much of p - q a body takes up on a window as its rate changes, at most: a slow one no more than its share. */
static real turned_by(const laws *law, const laws *slope, int node)
{
    const real rate = law->rate[node];
    return magnitude(rate < 1 ? slope->rate[node] : slope->rate[node] / rate);
}

/* How much of what values are wrong by acts on their derivatives on a window, at most. */
static real felt(const laws *law, const laws *slope)
{
    real most = 0;
    for (int node = 0; node < NAME_NODES; ++node) {
        const real rate = law->rate[node];
        const real arrives = magnitude(slope->alpha[node]) + magnitude(slope->beta[node]);
        most = larger(most, rate > 0 && rate < 1 ? rate * arrives : arrives);
        most = larger(most, 2 * turned_by(law, slope, node));
    }
    return most;
}

/* One window of the derivatives by a parameter, of which `slope` is what the laws change by. With q'/rate + q = p,
 *
 *     dq'/rate + dq = dp + drate/rate (p - q).
 *
 * What its polynomials miss. */
static real follow(name_tangent *tangent, const laws *law, const laws *slope, int lane, int half, int degree)
{
    const work_of *const m = &tangent->work;
    wave_of(*const waves)[3] = tangent->waves[lane];
    real *const velocity = tangent->velocity[lane][1];
    real *const size = &tangent->size[lane][1];
    moving bodies;
    real missed = 0, acts = tangent->acts[lane];
    bodies.count = 0;
    bodies.node[0] = 0;
    bodies.node[1] = 0;
    *size = tangent->size[lane][0];
    for (int node = 0; node < NAME_NODES; ++node) {
        velocity[node] = tangent->velocity[lane][0][node];
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int f = 0; f < NAME_FORCES; ++f) {
            for (int k = 0; k < 3; ++k) {
                waves[half][LOAD][panel][f][k] = tangent->force[lane][panel][f][k];
            }
        }
        for (int node = 0; node < NAME_NODES; ++node) {
            const real *const a = m->waves[!half][RIGHT][panel][node];
            const real *const b = m->waves[!half][LEFT][panel][node + 2];
            const real *const da = waves[!half][RIGHT][panel][node];
            const real *const db = waves[!half][LEFT][panel][node + 2];
            real *const p = bodies.p[bodies.count];
            const int f = force_on[node];
            for (int k = 0; k <= degree; ++k) {
                p[k] = law->alpha[node] * da[k] + law->beta[node] * db[k] + slope->alpha[node] * a[k] +
                       slope->beta[node] * b[k];
            }
            p[degree + 1] = 0;
            for (int k = 0; f >= 0 && k < 3; ++k) {
                p[k] += tangent->force[lane][panel][f][k];
            }
            if (law->rate[node] > 0) {
                const real share_of_rate = slope->rate[node] / law->rate[node];
                const real *const back = m->waves[half][LEFT][panel][node + 1];
                for (int k = 0; k <= degree; ++k) {
                    const real load = f >= 0 && k < 3 ? m->force[panel][f][k] : (real)0;
                    const real pushed = law->alpha[node] * a[k] + law->beta[node] * b[k] + load;
                    p[k] += share_of_rate * (pushed - (back[k] + a[k]));
                }
                const real pushed = law->alpha[node] * a[0] + law->beta[node] * b[0] + (f >= 0 ? m->force[panel][f][0] : (real)0);
                acts = larger(acts, turned_by(law, slope, node) * pushed);
                bodies.node[bodies.count] = node;
                bodies.count += 1;
            } else {
                send(waves, half, panel, node, degree, p, size);
            }
            if (bodies.count == PAIR || (bodies.count > 0 && node == NAME_NODES - 1)) {
                missed += moved(m, waves, half, panel, degree, &bodies, velocity, size);
            }
        }
    }
    tangent->acts[lane] = acts;
    return missed;
}

/* What begins derivatives by a parameter. */
static void started_lane(name_tangent *tangent, const laws *slope, int lane)
{
    start_waves(tangent->waves[lane], slope, LEAST);
    for (int node = 0; node < NAME_NODES; ++node) {
        tangent->velocity[lane][0][node] = slope->motion[node];
    }
}

/* As settle. */
static void settle_lane(name_tangent *tangent, int lane)
{
    for (int node = 0; node < NAME_NODES; ++node) {
        tangent->velocity[lane][0][node] = tangent->velocity[lane][1][node];
    }
}

/* Derivatives on the window of now; `before` is the degree of the one before. What their polynomials miss. */
static real follow_lane(name_tangent *tangent, const laws *law, const laws *slope, int lane, const progress *now,
                        int before)
{
    lengthen(tangent->waves[lane], before, now->degree);
    return follow(tangent, law, slope, lane, now->window % 2, now->degree);
}
