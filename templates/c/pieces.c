/* pieces.c: polynomials on pieces, one by one and in vectors.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "pieces_tables.h"

/* Samples are computed in the widest vectors that the compiler may use; as numbers where it knows none, and where size
 * counts more than speed. */
#if !defined(__GNUC__) || defined(__OPTIMIZE_SIZE__) || defined(__FRAMAC__)
#define VECTOR 0
#elif defined(__AVX512F__)
#define VECTOR 64
#elif defined(__AVX__)
#define VECTOR 32
#elif defined(__SSE2__) || defined(__aarch64__) || defined(__VSX__) || defined(__wasm_simd128__)
#define VECTOR 16
#else
#define VECTOR 0
#endif

#if VECTOR
typedef real lanes __attribute__((vector_size(VECTOR)));
typedef real stored __attribute__((vector_size(VECTOR), aligned(sizeof(real)), may_alias)); /* anywhere in an array */
#define LANES ((size_t)(VECTOR / sizeof(real)))
#define APART __attribute__((noinline)) /* so that its vectors stay in registers */
#else
typedef real lanes;
typedef real stored;
#define LANES ((size_t)1)
#define APART
#endif
#define BLOCK (4 * LANES)

static const real offset[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

/* tau_k, both operations rounded. `one` is 1, which no compiler knows: so the product is rounded by itself, contracted
 * into the next operation or not. */
static real instant(real tau0, real dtau, real one, real k)
{
    const real step = k * dtau;
    return step * one + tau0;
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

/* The samples that are asked for: `out` has `count` for each output. Blocks start before `blocks`, vectors before
 * `vectors`: so they end with their row, and their numbers are exact. */
typedef struct {
    real tau0, dtau, one, per_tau;
    size_t count, blocks, vectors;
    real *out;
} samples;

static lanes everywhere(real x)
{
    const lanes zero = {0};
    return x - zero;
}

/* w of the samples from k on. */
static lanes places(const samples *s, size_t k, real centred)
{
    const lanes step = ((real)k + *(const stored *)offset) * s->dtau;
    return (step * s->one + s->tau0) - centred;
}

/* Samples k ... end - 1, all of them on one piece. Whole vectors are written: what is beyond the end is written anew by
 * the runs that follow. Returns the first sample that is left, at the end of a row. That is left to others: a call after
 * vectors makes gcc 12 return with their upper halves in use, which slows down all that follows. */
static APART size_t run(int grid, int piece, const samples *s, size_t k, size_t end)
{
    const int *const rows = member + first_member[grid];
    const int members = first_member[grid + 1] - first_member[grid];
    const real *const first = coefficient + first_power[piece];
    const real *const last = coefficient + first_power[piece + 1] - members;
    const real middle = centre[piece];
    const size_t count = s->count;
    const size_t long_before = end > 2 * LANES ? end - 2 * LANES : 0;
    const size_t blocks = long_before < s->blocks ? long_before : s->blocks;
    const size_t vectors = end < s->vectors ? end : s->vectors;
    for (; k < blocks; k += BLOCK) {
        const lanes w0 = places(s, k, middle);
        const lanes w1 = places(s, k + LANES, middle);
        const lanes w2 = places(s, k + 2 * LANES, middle);
        const lanes w3 = places(s, k + 3 * LANES, middle);
        for (int m = 0; m < members; ++m) {
            real *const row = s->out + (size_t)rows[m] * count + k;
            const real *power = first + m;
            const real *const lowest = last + m;
            lanes sum0 = everywhere(*power);
            lanes sum1 = sum0;
            lanes sum2 = sum0;
            lanes sum3 = sum0;
            while (power < lowest) {
                power += members;
                sum0 = sum0 * w0 + *power;
                sum1 = sum1 * w1 + *power;
                sum2 = sum2 * w2 + *power;
                sum3 = sum3 * w3 + *power;
            }
            *(stored *)row = sum0;
            *(stored *)(row + LANES) = sum1;
            *(stored *)(row + 2 * LANES) = sum2;
            *(stored *)(row + 3 * LANES) = sum3;
        }
    }
    for (; k < vectors; k += LANES) {
        const lanes w = places(s, k, middle);
        real *const column = s->out + k;
        /* four outputs at once; the last one again where there are fewer */
        for (int m = 0; m < members; m += 4) {
            const int rest = members - 1 - m;
            const int m1 = rest < 1 ? rest : 1;
            const int m2 = rest < 2 ? rest : 2;
            const int m3 = rest < 3 ? rest : 3;
            const real *power = first + m;
            const real *const lowest = last + m;
            lanes sum0 = everywhere(power[0]);
            lanes sum1 = everywhere(power[m1]);
            lanes sum2 = everywhere(power[m2]);
            lanes sum3 = everywhere(power[m3]);
            while (power < lowest) {
                power += members;
                sum0 = sum0 * w + power[0];
                sum1 = sum1 * w + power[m1];
                sum2 = sum2 * w + power[m2];
                sum3 = sum3 * w + power[m3];
            }
            *(stored *)(column + (size_t)rows[m] * count) = sum0;
            *(stored *)(column + (size_t)rows[m + m1] * count) = sum1;
            *(stored *)(column + (size_t)rows[m + m2] * count) = sum2;
            *(stored *)(column + (size_t)rows[m + m3] * count) = sum3;
        }
    }
    return k < end ? k : end;
}

/* Whether sample k comes before an edge, on the way that samples go. */
static int before(const samples *s, real edge, size_t k)
{
    const real tau = instant(s->tau0, s->dtau, s->one, (real)k);
    return s->dtau < 0 ? tau >= edge : tau < edge;
}

/* The first sample from k on that is not before an edge, or count. */
static size_t run_end(const samples *s, real edge, size_t k)
{
    const real reach = (edge - s->tau0) * s->per_tau; /* about where */
    size_t end = s->count;
    if (reach == reach && reach < (real)s->count) {
        end = reach > (real)k ? (size_t)reach + 1 : k;
    }
    while (end > k && !before(s, edge, end - 1)) {
        --end;
    }
    while (end < s->count && before(s, edge, end)) {
        ++end;
    }
    return end;
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

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    const volatile real unity = 1;
    const size_t counted = (real)count < exact ? count : (size_t)exact;
    const samples s = {
        tau0,
        dtau,
        unity,
        dtau < 0 || dtau > 0 ? 1 / dtau : 0,
        count,
        counted < BLOCK ? 0 : counted - BLOCK + 1,
        counted < LANES ? 0 : counted - LANES + 1,
        out,
    };
    const int onward = dtau < 0 ? -1 : 1;
    int outside = 0;
    for (int grid = 0; grid < GRIDS; ++grid) {
        const int begin = first_piece[grid];
        const int pieces = first_piece[grid + 1] - begin;
        const real *const edges = start + begin + grid + (dtau < 0 ? 0 : 1);
        size_t k = 0;
        while (k < count) {
            const real tau = instant(tau0, dtau, s.one, (real)k);
            if (tau == tau && tau >= 0 && tau <= NAME_TAU_MAX) {
                /* pieces in order, until one has no samples */
                for (int piece = piece_at(grid, tau); piece >= 0 && piece < pieces; piece += onward) {
                    const size_t end = run_end(&s, edges[piece], k);
                    if (end == k) {
                        break;
                    }
                    for (k = run(grid, begin + piece, &s, k, end); k < end; ++k) {
                        at(grid, begin + piece, instant(tau0, dtau, s.one, (real)k), out + k, count);
                    }
                }
            } else {
                for (int m = first_member[grid]; m < first_member[grid + 1]; ++m) {
                    out[(size_t)member[m] * count + k] = not_a_number();
                }
                outside = 1;
                ++k;
            }
        }
    }
    return outside;
}
