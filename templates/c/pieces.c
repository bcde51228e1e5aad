/* pieces.c: polynomials on pieces, one by one and in blocks.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "pieces_tables.h"

/* Loops over a block of samples are unrolled, so that its values stay in registers; not where size counts more than
 * speed. */
enum { BLOCK = 32 };

#if defined(__OPTIMIZE_SIZE__)
#define UNROLLED
#elif defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 32")
#else
#define UNROLLED
#endif

static const real offset[BLOCK] = {
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
};

static int inside(real tau)
{
    return tau >= 0 && tau <= NAME_TAU_MAX;
}

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
    int piece = part[first_part[grid] + (int)(tau * scale[grid])];
    while (tau >= starts[piece + 1]) {
        ++piece;
    }
    return piece;
}

static real polynomial_at(const real *power, const real *end, real w)
{
    real sum = *power;
    while (++power < end) {
        sum = sum * w + *power;
    }
    return sum;
}

static void at(int grid, real tau, real *out, size_t stride)
{
    const int piece = piece_at(grid, tau);
    const int members = first_member[grid + 1] - first_member[grid];
    const int *const power = first_power + first_polynomial[grid] + piece * members;
    const real w = tau - centre[first_piece[grid] + piece];
    for (int m = 0; m < members; ++m) {
        out[(size_t)member[first_member[grid] + m] * stride] =
            polynomial_at(coefficient + power[m], coefficient + power[m + 1], w);
    }
}

static void polynomial_block(const real *power, const real *end, const real *w, real *out)
{
    real sum[BLOCK];
    const real highest = *power;
    UNROLLED
    for (int j = 0; j < BLOCK; ++j) {
        sum[j] = highest;
    }
    while (++power < end) {
        const real next = *power;
        UNROLLED
        for (int j = 0; j < BLOCK; ++j) {
            sum[j] = sum[j] * w[j] + next;
        }
    }
    UNROLLED
    for (int j = 0; j < BLOCK; ++j) {
        out[j] = sum[j];
    }
}

/* The samples that are asked for: `out` has `count` for each output. */
typedef struct {
    real tau0, dtau, one, per_tau;
    size_t count;
    real *out;
} samples;

static void block_offsets(const samples *s, size_t k, real middle, real *w)
{
    const real first = (real)k, tau0 = s->tau0, dtau = s->dtau, one = s->one;
    UNROLLED
    for (int j = 0; j < BLOCK; ++j) {
        w[j] = instant(tau0, dtau, one, first + offset[j]) - middle;
    }
}

/* Samples k ... end - 1, all of them on one piece. Whole blocks are written: what is beyond the end is written anew by
 * the runs that follow. */
static void run(int grid, int piece, const samples *s, size_t k, size_t end)
{
    const int *const members = member + first_member[grid];
    const int count = first_member[grid + 1] - first_member[grid];
    const int *const power = first_power + first_polynomial[grid] + piece * count;
    const real middle = centre[first_piece[grid] + piece];
    real w[BLOCK], rest[BLOCK];
    /* short runs by themselves; long ones too, where (real)k is no longer exact */
    if (end - k < BLOCK / 4 || (real)end > exact) {
        for (; k < end; ++k) {
            at(grid, instant(s->tau0, s->dtau, s->one, (real)k), s->out + k, s->count);
        }
        return;
    }
    for (; k < end && s->count - k >= BLOCK; k += BLOCK) {
        block_offsets(s, k, middle, w);
        for (int m = 0; m < count; ++m) {
            real *const row = s->out + (size_t)members[m] * s->count + k;
            polynomial_block(coefficient + power[m], coefficient + power[m + 1], w, row);
        }
    }
    if (k < end) {
        block_offsets(s, k, middle, w);
        for (int m = 0; m < count; ++m) {
            real *const row = s->out + (size_t)members[m] * s->count;
            polynomial_block(coefficient + power[m], coefficient + power[m + 1], w, rest);
            for (size_t j = k; j < end; ++j) {
                row[j] = rest[j - k];
            }
        }
    }
}

static int on_piece(const real *starts, const samples *s, size_t k)
{
    const real tau = instant(s->tau0, s->dtau, s->one, (real)k);
    return tau >= starts[0] && tau < starts[1] && inside(tau);
}

/* The first sample after k that is not on the piece of sample k, or count. */
static size_t run_end(const real *starts, const samples *s, size_t k)
{
    const real edge = s->dtau < 0 ? starts[0] : starts[1];
    const real reach = (edge - s->tau0) * s->per_tau; /* about where the run ends */
    size_t end = reach < (real)s->count ? (reach > (real)k ? (size_t)reach : k) + 1 : s->count;
    while (end > k + 1 && !on_piece(starts, s, end - 1)) {
        --end;
    }
    while (end < s->count && on_piece(starts, s, end)) {
        ++end;
    }
    return end;
}

int name_eval(real tau, real out[NAME_OUTPUTS])
{
    if (!inside(tau)) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            out[output] = (real)NAN;
        }
        return 1;
    }
    for (int grid = 0; grid < GRIDS; ++grid) {
        at(grid, tau, out, 1);
    }
    return 0;
}

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    const volatile real unity = 1;
    const samples s = {tau0, dtau, unity, dtau < 0 || dtau > 0 ? 1 / dtau : 0, count, out};
    int outside = 0;
    for (int grid = 0; grid < GRIDS; ++grid) {
        size_t k = 0;
        while (k < count) {
            const real tau = instant(tau0, dtau, s.one, (real)k);
            if (inside(tau)) {
                const int piece = piece_at(grid, tau);
                const size_t end = run_end(start + first_piece[grid] + grid + piece, &s, k);
                run(grid, piece, &s, k, end);
                k = end;
            } else {
                for (int m = first_member[grid]; m < first_member[grid + 1]; ++m) {
                    out[(size_t)member[m] * count + k] = (real)NAN;
                }
                outside = 1;
                ++k;
            }
        }
    }
    return outside;
}
