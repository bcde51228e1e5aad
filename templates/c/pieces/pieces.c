/* pieces.c: polynomials on pieces, one by one and in vectors. */
#include "tables.h"

/* Pieces: for start[p] <= tau < start[p + 1] an output is one polynomial in w = tau - centre[p]. Outputs that may jump
 * or bend at the same times share a grid of pieces. */

/* What is computed in vectors is apart, so that these stay in registers. */
#if VECTOR > 0
#define APART static __attribute__((noinline))
#else
#define APART static
#endif

/* Where size counts more than speed, samples are computed one by one if there are no vectors; and what is found of runs
 * ahead of them is found as they begin. */
#ifdef __OPTIMIZE_SIZE__
enum { IN_RUNS = VECTOR > 0 };
#define LOOKS_AHEAD 0
#else
enum { IN_RUNS = 1 };
#define LOOKS_AHEAD (VECTOR > 0)
#endif

static const real offset[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

/* Machines turn signed integers into numbers sooner. */
static real number(size_t k)
{
    return (real)(ptrdiff_t)k;
}

/* When samples are. `one` is 1, which no compiler knows. */
typedef struct {
    real tau0, dtau, one;
} instants;

/* tau_k, both operations rounded: multiplied by `one` the product is rounded by itself, contracted into the next
 * operation or not. */
static real instant(const instants *t, real k)
{
    const real step = k * t->dtau;
    return step * t->one + t->tau0;
}

static int piece_at(int grid, real tau)
{
    const real *const starts = start + first_piece[grid] + grid;
    const int last = first_piece[grid + 1] - first_piece[grid] - 1;
    int piece = part[first_part[grid] + (int)(tau * scale[grid])];
    while (piece < last && tau >= starts[piece + 1]) {
        ++piece;
    }
    return piece;
}

static real polynomial_at(const real *power, const real *lowest, int members, real w)
{
    real sum = *power;
    while (power < lowest) {
        power += members;
        sum = sum * w + *power;
    }
    return sum;
}

/* All outputs of a grid at tau, which is on a piece: pieces of all grids are counted on. */
static void at(int grid, int piece, real tau, real *out, size_t stride)
{
    const int members = first_member[grid + 1] - first_member[grid];
    const real *const first = coefficient + first_power[piece];
    const real *const last = coefficient + first_power[piece + 1] - members;
    const real w = tau - centre[piece];
    for (int m = 0; m < members; ++m) {
        out[(size_t)member[first_member[grid] + m] * stride] =
            polynomial_at(first + m, last + m, members, w);
    }
}

/* The samples that are asked for: `out` has `count` for each output, in rows as `member` has them. Four vectors start
 * before `fours`, and so on: so they end with their row, and the numbers of samples are exact. Where `apart` is not 0,
 * all numbers are, and half a step is longer than what is rounded from an edge to `nearest`, in run_end, and in tau_k:
 * less than 8 times what |tau0| + TAU_MAX can be rounded by. A run ends at edge `later` of its piece; then comes the
 * piece `next` to it. */
typedef struct {
    instants at;
    real per_tau;
    size_t count, fours, twos, ones;
    int apart, next, later;
    real *out;
    real *rows[NAME_OUTPUTS];
} samples;

/* Up to four vectors side by side. How many are in use is `width`: 1, 2 or 4. */
typedef struct {
    lanes a, b, c, d;
} block;

static lanes everywhere(real x)
{
    const lanes zero = {0};
    return x - zero;
}

/* tau_k as `instant` has it. */
WITHIN lanes instants_of(const instants *t, lanes k)
{
    lanes step = k * t->dtau;
#if VECTOR > 0 && defined(__SSE2__)
    __asm__("" : "+v"(step)); /* so it is contracted into nothing: `one` would cost a multiplication */
#else
    step = step * t->one;
#endif
    return step + t->tau0;
}

/* tau_k less the centre of a piece. */
WITHIN lanes place(const instants *t, lanes k, real middle)
{
    return instants_of(t, k) - middle;
}

WITHIN block places(int width, const instants *t, lanes k, real middle)
{
    block w;
    w.a = place(t, k, middle);
    w.b = width > 1 ? place(t, k + (real)LANES, middle) : w.a;
    w.c = width > 2 ? place(t, k + (real)(2 * LANES), middle) : w.a;
    w.d = width > 2 ? place(t, k + (real)(3 * LANES), middle) : w.a;
    return w;
}

WITHIN block constant(real x)
{
    const lanes same = everywhere(x);
    const block sum = {same, same, same, same};
    return sum;
}

/* One more step of Horner's rule. */
WITHIN block onward(int width, block sum, block w, real power)
{
    sum.a = sum.a * w.a + power;
    if (width > 1) {
        sum.b = sum.b * w.b + power;
    }
    if (width > 2) {
        sum.c = sum.c * w.c + power;
        sum.d = sum.d * w.d + power;
    }
    return sum;
}

WITHIN void store(int width, block sum, real *to)
{
    *(slice *)to = sum.a;
    if (width > 1) {
        *(slice *)(to + LANES) = sum.b;
    }
    if (width > 2) {
        *(slice *)(to + 2 * LANES) = sum.c;
        *(slice *)(to + 3 * LANES) = sum.d;
    }
}

/* A piece: its outputs, where their samples go, and the polynomials' highest and lowest powers. */
typedef struct {
    int members;
    real *const *rows;
    const real *first, *last;
} polynomials;

/* `count` outputs from number m on, 1 to 4, side by side. */
WITHIN void together(int count, int width, const polynomials *p, int m, block w, size_t k)
{
    const real *power = p->first + m;
    const real *const lowest = p->last + m;
    block sum0 = constant(power[0]);
    block sum1 = count > 1 ? constant(power[1]) : sum0;
    block sum2 = count > 2 ? constant(power[2]) : sum0;
    block sum3 = count > 3 ? constant(power[3]) : sum0;
    while (power < lowest) {
        power += p->members;
        sum0 = onward(width, sum0, w, power[0]);
        if (count > 1) {
            sum1 = onward(width, sum1, w, power[1]);
        }
        if (count > 2) {
            sum2 = onward(width, sum2, w, power[2]);
        }
        if (count > 3) {
            sum3 = onward(width, sum3, w, power[3]);
        }
    }
    store(width, sum0, p->rows[m] + k);
    if (count > 1) {
        store(width, sum1, p->rows[m + 1] + k);
    }
    if (count > 2) {
        store(width, sum2, p->rows[m + 2] + k);
    }
    if (count > 3) {
        store(width, sum3, p->rows[m + 3] + k);
    }
}

/* One vector of each output, or two: so few that several outputs are computed together. */
WITHIN void few(int width, const polynomials *p, block w, size_t k)
{
    int m = 0;
    for (; m + 4 <= p->members; m += 4) {
        together(4, width, p, m, w, k);
    }
    if (p->members - m == 3) {
        together(3, width, p, m, w, k);
    }
    if (p->members - m == 2) {
        together(2, width, p, m, w, k);
    }
    if (p->members - m == 1) {
        together(1, width, p, m, w, k);
    }
}

/* Whether sample k comes before an edge, on the way that samples go. */
WITHIN int before(const instants *t, real edge, size_t k)
{
    const real tau = instant(t, number(k));
    return t->dtau < 0 ? tau >= edge : tau < edge;
}

/* The first sample from k on that is not before an edge, or count. */
WITHIN size_t run_end(const samples *s, real edge, size_t k)
{
    const real reach = (edge - s->at.tau0) * s->per_tau; /* about where */
    size_t end = s->count;
    if (s->apart) {
        const real nearest = reach + (real)0.5;
        if (nearest == nearest && nearest < number(end)) {
            end = nearest > 0 ? (size_t)(ptrdiff_t)nearest : 0;
            end += before(&s->at, edge, end) ? 1 : 0;
        }
        return end;
    }
    if (reach == reach && reach < number(end)) {
        end = reach > number(k) ? (size_t)(ptrdiff_t)reach + 1 : k;
    }
    while (end > k && !before(&s->at, edge, end - 1)) {
        --end;
    }
    while (end < s->count && before(&s->at, edge, end)) {
        ++end;
    }
    return end;
}

#if LOOKS_AHEAD
enum { AHEAD = 32 };

/* Where runs end at edges of a grid from number `first` on: found together, for less, and long before they are needed,
 * so that a core seldom guesses wrong how many vectors a piece has. */
typedef struct {
    int first;
    size_t end[AHEAD];
} run_ends;

/* Of edges up to number `last`, where samples are `apart`: the sample nearest to an edge, or where that comes before
 * it the next one; as run_end has it. */
static BY_ITSELF void look_ahead(const samples *s, const real *edges, int last, run_ends *found)
{
    const instants t = s->at;
    const real whole = exact * (real)0.75; /* so large that a sum with it is a whole number */
    const lanes none = everywhere(0);
    const lanes count = everywhere(number(s->count));
    const real next = s->next < 0 ? 0 : 1; /* after samples that come before an edge */
    const int wide = (int)LANES;
    const int many = last - found->first + 1;
    real ends[AHEAD];
    for (int i = 0; i < many; i += wide) {
        const int from = i + wide > many ? many - wide : i;
        const lanes edge = *(const slice *)(edges + found->first + from);
        lanes nearest = (edge - t.tau0) * s->per_tau + whole;
#ifdef __SSE2__
        __asm__("" : "+v"(nearest)); /* so it is rounded, whatever may be assumed of sums */
#else
        nearest = nearest * t.one;
#endif
        nearest = nearest - whole;
        const lanes not_earlier = (lanes)((instants_of(&t, nearest) >= edge) & (choice)everywhere(1));
        lanes end = nearest + (next - (real)s->next * not_earlier);
        end = (lanes)((end > none) & (choice)end);
        const choice inside = end < count;
        end = (lanes)((inside & (choice)end) | (~inside & (choice)count));
        *(slice *)(ends + from) = end;
    }
    for (int i = 0; i < many; ++i) {
        found->end[i] = (size_t)(ptrdiff_t)ends[i];
    }
}

/* What run_end is at an edge of so many. */
WITHIN size_t end_ahead(const samples *s, const real *edges, int edge, int many, run_ends *known)
{
    if (edge < known->first || edge >= known->first + AHEAD) {
        const int first = s->next < 0 ? edge - AHEAD + 1 : edge;
        const int latest = many > AHEAD ? many - AHEAD : 0;
        known->first = first < 0 ? 0 : first < latest ? first : latest;
        look_ahead(s, edges, known->first + (many < AHEAD ? many : AHEAD) - 1, known);
    }
    return known->end[edge - known->first];
}
#endif

/* All outputs of a piece, four vectors at a time, from sample k to one before `end` or a little further. The first sample
 * that is left. */
static BY_ITSELF size_t by_fours(const polynomials *p, instants t, real middle, size_t k, size_t end)
{
    lanes numbers = number(k) + *(const slice *)offset;
    for (; k < end; k += 4 * LANES) {
        const block w = places(4, &t, numbers, middle);
        numbers = numbers + (real)(4 * LANES);
        int m = 0;
        for (; m + 2 <= p->members; m += 2) { /* eight sums: each waits for its own last step */
            together(2, 4, p, m, w, k);
        }
        if (m < p->members) {
            together(1, 4, p, m, w, k);
        }
    }
    return k;
}

static BY_ITSELF void two_vectors(const polynomials *p, instants t, real middle, size_t k)
{
    few(2, p, places(2, &t, number(k) + *(const slice *)offset, middle), k);
}

static BY_ITSELF void one_vector(const polynomials *p, instants t, real middle, size_t k)
{
    few(1, p, places(1, &t, number(k) + *(const slice *)offset, middle), k);
}

/* The outputs of a grid from sample k on, which is on a piece: piece after piece, until one has no samples and it is
 * not known where the next ones end. Whole vectors are written: what is beyond a piece is written anew by the next one.
 * Returns the first sample that is left. */
APART size_t run(int grid, int piece, const samples *s, size_t k)
{
    const int begin = first_piece[grid];
    const int pieces = first_piece[grid + 1] - begin;
    const instants t = s->at; /* rows might be where *s is, for all that a compiler knows */
    const real *const edges = start + begin + grid;
    polynomials p;
    p.members = first_member[grid + 1] - first_member[grid];
    p.rows = s->rows + first_member[grid];
#if LOOKS_AHEAD
    /* worth it where a piece has samples, and samples are on some pieces */
    const real step = t.dtau < 0 ? -t.dtau : t.dtau;
    const real width = edges[piece + 1] - edges[piece];
    const int ahead =
        s->apart && pieces >= (int)LANES && step <= width && number(s->count - k) * step > 4 * width;
    run_ends known;
    known.first = -AHEAD;
#endif
    for (; piece >= 0 && piece < pieces; piece += s->next) {
        const real middle = centre[begin + piece];
#if LOOKS_AHEAD
        const size_t end = ahead ? end_ahead(s, edges, piece + s->later, pieces + 1, &known)
                                 : run_end(s, edges[piece + s->later], k);
#else
        const size_t end = run_end(s, edges[piece + s->later], k);
#endif
        if (end <= k) {
#if LOOKS_AHEAD
            if (ahead) {
                continue;
            }
#endif
            break;
        }
        p.first = coefficient + first_power[begin + piece];
        p.last = coefficient + first_power[begin + piece + 1] - p.members;
        if (end > k + 2 * LANES && k < s->fours) {
            const size_t left = end - 2 * LANES; /* from here on there are two vectors at most */
            k = by_fours(&p, t, middle, k, left < s->fours ? left : s->fours);
        }
        if (end > k + LANES && k < s->twos) {
            two_vectors(&p, t, middle, k);
            k += 2 * LANES;
        }
        if (end > k && k < s->ones) {
            one_vector(&p, t, middle, k);
            k += LANES;
        }
        for (; k < end; ++k) {
            at(grid, begin + piece, instant(&s->at, number(k)), s->out + k, s->count);
        }
        k = end;
    }
    return k;
}

int name_eval(real tau, real out[NAME_OUTPUTS])
{
    if (!(tau == tau && tau >= 0 && tau <= NAME_TAU_MAX)) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            out[output] = not_a_number();
        }
        return 1;
    }
    for (int grid = 0; grid < GRIDS; ++grid) {
        at(grid, first_piece[grid] + piece_at(grid, tau), tau, out, 1);
    }
    return 0;
}

/* Where the last `many` of the `counted` first samples start, and one more; 0 where there are fewer. */
static size_t starts(size_t counted, size_t many)
{
    return counted < many ? 0 : counted - many + 1;
}

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    const volatile real unity = 1;
    const real per_tau = dtau < 0 || dtau > 0 ? 1 / dtau : 0;
    const real farthest = (tau0 < 0 ? -tau0 : tau0) + NAME_TAU_MAX;
    const size_t counted = (real)count < exact ? count : (size_t)exact;
    int outside = 0;
    samples s;
    s.at.tau0 = tau0;
    s.at.dtau = dtau;
    s.at.one = unity;
    s.per_tau = per_tau;
    s.count = count;
    s.fours = starts(counted, 4 * LANES);
    s.twos = starts(counted, 2 * LANES);
    s.ones = starts(counted, LANES);
    s.apart = (dtau < 0 ? -dtau : dtau) >= farthest * (16 / exact) && per_tau - per_tau == 0 && counted == count;
    s.next = dtau < 0 ? -1 : 1;
    s.later = dtau < 0 ? 0 : 1;
    s.out = out;
    for (int m = 0; m < NAME_OUTPUTS; ++m) {
        s.rows[m] = out + (size_t)member[m] * count;
    }
    for (int grid = 0; grid < GRIDS; ++grid) {
        size_t k = 0;
        while (k < count) {
            const real tau = instant(&s.at, number(k));
            if (!(tau == tau && tau >= 0 && tau <= NAME_TAU_MAX)) {
                for (int m = first_member[grid]; m < first_member[grid + 1]; ++m) {
                    s.rows[m][k] = not_a_number();
                }
                outside = 1;
                ++k;
            } else if (IN_RUNS) {
                k = run(grid, piece_at(grid, tau), &s, k);
            } else {
                at(grid, first_piece[grid] + piece_at(grid, tau), tau, out + k, count);
                ++k;
            }
        }
    }
    return outside;
}
