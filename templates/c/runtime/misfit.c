/* misfit.c: sums of squares of what models miss of data, taken from coefficients. */
#include "batch.c"

/* Whether a tau is on the section. */
static int belongs(real tau, int window, int section)
{
    const real t = tau - cycle_begin(window);
    const int at = in_cycle(window, section);
    return tau >= 0 && tau <= NAME_TAU_MAX && t >= from[at] && t < from[at + 1];
}

/* A group is an output on a section of a window. `numbers` has of each blocks of ROWS rows of its triangle R, interlaced:
 * their weights, z, lowest degrees and all columns; then what all rows from some one on add to the rest, by that row. The
 * columns go degree by degree, so that polynomials of low degree need the first blocks and columns alone. */
enum { WEIGHT = 0, AIM = 1, LOWEST = 2, COLUMNS = 3, ROWS = 8 };

static int strands_of(int group)
{
    return first_strand[group + 1] - first_strand[group];
}

static int columns_of(int group)
{
    return strands_of(group) * (NAME_DEGREE + 2);
}

/* Whole blocks. */
static size_t most_rows(size_t points, int group)
{
    const size_t most = points < (size_t)columns_of(group) ? points : (size_t)columns_of(group);
    return (most + ROWS - 1) / ROWS * ROWS;
}

/* Of a row the weight, z, or a column. */
static size_t cell(int group, size_t row, int what)
{
    return ((row / ROWS) * (size_t)(COLUMNS + columns_of(group)) + (size_t)what) * ROWS + row % ROWS;
}

size_t name_data_size(const name_real *tau, size_t count)
{
    size_t size = 0, work = 0;
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        for (int section = 0; section < SECTIONS; ++section) {
            size_t points = 0;
            for (size_t k = 0; k < count; ++k) {
                points += belongs(tau[k], window, section) ? 1 : 0;
            }
            for (int output = 0; output < NAME_OUTPUTS; ++output) {
                const int group = section * NAME_OUTPUTS + output;
                const size_t rows = most_rows(points, group);
                size += cell(group, rows, 0) + rows + 1;
                work = (rows + 1) * points > work ? (rows + 1) * points : work;
            }
        }
    }
    return size + work;
}

/* Take from v what it has of the rows found so far, each `points` long, and add how much that is to their cells. */
static void project(const real *found, size_t rows, size_t points, int group, int what, real *cells, real *v)
{
    for (int again = 0; again < 2; ++again) { /* twice is enough */
        for (size_t row = 0; row < rows; ++row) {
            const real *const q = found + row * points;
            real sum = 0;
            for (size_t k = 0; k < points; ++k) {
                sum += q[k] * v[k];
            }
            sum /= cells[cell(group, row, WEIGHT)];
            for (size_t k = 0; k < points; ++k) {
                v[k] -= sum * q[k];
            }
            cells[cell(group, row, what)] += sum;
        }
    }
}

static real squares(const real *v, size_t points)
{
    real sum = 0;
    for (size_t k = 0; k < points; ++k) {
        sum += v[k] * v[k];
    }
    return sum;
}

/* The triangle of a group by Gram and Schmidt, without square roots; `work` has room for all rows and one more. A column
 * that depends on those before, but for rounding, has no row. */
static int triangle(const real *tau, const real *values, size_t count, int window, int group, real *cells, real *work)
{
    const int section = group / NAME_OUTPUTS;
    const int strands = strands_of(group);
    const int columns = columns_of(group);
    size_t points = 0, row = 0;
    for (size_t k = 0; k < count; ++k) {
        points += belongs(tau[k], window, section) && values[k] - values[k] == 0 ? 1 : 0;
    }
    const size_t most = most_rows(points, group);
    for (size_t k = 0; k < cell(group, most, 0); ++k) {
        cells[k] = 0;
    }
    for (int column = 0; points > 0 && column < columns; ++column) {
        real *const v = work + row * points;
        const int s = strand_at[first_strand[group] + column % strands];
        size_t point = 0;
        for (size_t k = 0; k < count; ++k) {
            if (belongs(tau[k], window, section) && values[k] - values[k] == 0) {
                const real u = place_on(s, window, tau[k] - cycle_begin(window));
                real now = 1, next = u;
                for (int n = 0; n < column / strands; ++n) {
                    const real after = 2 * u * next - now;
                    now = next;
                    next = after;
                }
                v[point++] = now;
            }
        }
        const real whole = squares(v, points);
        project(work, row, points, group, COLUMNS + column, cells, v);
        const real left = squares(v, points);
        if (row < points && left > (64 * unit) * (64 * unit) * whole) {
            cells[cell(group, row, WEIGHT)] = left;
            cells[cell(group, row, LOWEST)] = (real)(column / strands);
            cells[cell(group, row, COLUMNS + column)] = 1;
            ++row;
        }
    }
    real *const y = work + row * points;
    size_t point = 0;
    for (size_t k = 0; k < count; ++k) {
        if (belongs(tau[k], window, section) && values[k] - values[k] == 0) {
            y[point++] = values[k];
        }
    }
    project(work, row, points, group, AIM, cells, y);
    const size_t kept = (row + ROWS - 1) / ROWS * ROWS;
    real *const rest = cells + cell(group, kept, 0);
    rest[kept] = squares(y, points);
    for (size_t i = kept; i > 0; --i) {
        const real z = cells[cell(group, i - 1, AIM)];
        rest[i - 1] = rest[i] + cells[cell(group, i - 1, WEIGHT)] * z * z;
    }
    return (int)row;
}

int name_data_init(
    name_data *data, name_real *numbers, const name_real *tau, const name_real *values, size_t count)
{
    size_t place = 0;
    int outside = 0;
    data->numbers = numbers;
    for (size_t k = 0; k < count; ++k) {
        outside |= !(tau[k] >= 0 && tau[k] <= NAME_TAU_MAX);
    }
    for (int n = 0; n < NAME_WINDOWS * NAME_GROUPS; ++n) {
        const int group = n % NAME_GROUPS;
        const real *const own = values + (size_t)(group % NAME_OUTPUTS) * count;
        /* the work lies behind what is kept, with room for all rows that there can be */
        size_t points = 0;
        for (size_t k = 0; k < count; ++k) {
            points += belongs(tau[k], n / NAME_GROUPS, group / NAME_OUTPUTS) ? 1 : 0;
        }
        const size_t most = most_rows(points, group);
        const size_t size = cell(group, most, 0) + most + 1;
        data->place[n] = place;
        data->rows[n] =
            triangle(tau, own, count, n / NAME_GROUPS, group, numbers + place, numbers + place + size);
        place += size;
    }
    return outside;
}

/* By how much the series of a group may be longer than those of waves: 1 where waves are integrated. */
static int longer_by(int group)
{
    int longer = 0;
    for (int k = first_strand[group]; k < first_strand[group + 1]; ++k) {
        for (int t = first_term[strand_at[k]]; t < first_term[strand_at[k] + 1]; ++t) {
            longer |= term_summed[t];
        }
    }
    return longer;
}

/* So many rows and parts at a time, so that what they miss stays in registers. */
enum { HALF = ROWS / 2, PAIRED = parts_batch < 2 ? parts_batch : 2 };

/* Add the squares of what half a block misses of series, from a degree on, to the sums of some parts; `cells` are those of
 * its first row. */
static BY_ITSELF void square_up(const wide *series, size_t size, int least, int degree, const real *cells, int group,
                                wide *sum)
{
    const int strands = strands_of(group);
    wide missed[HALF][PAIRED];
    UNROLLED
    for (int i = 0; i < HALF; ++i) {
        UNROLLED
        for (int j = 0; j < PAIRED; ++j) {
            missed[i][j] = none - cells[AIM * ROWS + i];
        }
    }
    for (int s = 0; s < strands; ++s) {
        const wide *const c = series + (size_t)strand_at[first_strand[group] + s] * size * parts_batch;
        const real *r = cells + (COLUMNS + least * strands + s) * ROWS;
        for (int k = least; k <= degree; ++k) {
            UNROLLED
            for (int i = 0; i < HALF; ++i) {
                UNROLLED
                for (int j = 0; j < PAIRED; ++j) {
                    missed[i][j] += r[i] * c[k * parts_batch + j];
                }
            }
            r += strands * ROWS;
        }
    }
    UNROLLED
    for (int i = 0; i < HALF; ++i) {
        UNROLLED
        for (int j = 0; j < PAIRED; ++j) {
            sum[j] += cells[WEIGHT * ROWS + i] * missed[i][j] * missed[i][j];
        }
    }
}

/* What the blocks of a group give of series to `degree`; the first row that is left out. */
static int blocks(const wide *series, size_t size, int degree, const real *cells, int rows, int group, wide *sum)
{
    int row = 0;
    while (row < rows && cells[LOWEST * ROWS] <= (real)degree) {
        for (int first = 0; first < ROWS; first += HALF) {
            const real lowest = cells[LOWEST * ROWS + first];
            const int least = lowest <= (real)degree ? (int)lowest : degree + 1; /* the rows before count alone, then */
            for (int side = 0; side < parts_batch; side += PAIRED) {
                square_up(series + side, size, least, degree, cells + first, group, sum + side);
            }
        }
        cells += (COLUMNS + columns_of(group)) * ROWS;
        row += ROWS;
    }
    return row;
}

/* The misfits of all sets of a batch. */
static void misfit_of(const name_batch *b, const name_data *data, wide *sum)
{
    int longer[NAME_GROUPS];
    for (int group = 0; group < NAME_GROUPS; ++group) {
        longer[group] = longer_by(group);
    }
    for (int n = 0; n < NAME_WINDOWS * NAME_GROUPS; ++n) {
        const int window = n / NAME_GROUPS, group = n % NAME_GROUPS;
        const int degree = b->degree[window];
        const real *const cells = data->numbers + data->place[n];
        const size_t kept = ((size_t)data->rows[n] + ROWS - 1) / ROWS * ROWS;
        const int row = blocks((const wide *)b->series[b->place[window]], (size_t)(degree + 2), degree + longer[group], cells,
                               data->rows[n], group, sum);
        for (int side = 0; side < parts_batch; ++side) {
            sum[side] += cells[cell(group, kept, 0) + (size_t)row];
        }
    }
}

void name_batch_misfit(const name_batch *batch, const name_data *data, name_real *misfit)
{
    wide sum[parts_batch];
    int any = 0;
    for (int side = 0; side < parts_batch; ++side) {
        sum[side] = none;
    }
    for (int set = 0; set < NAME_WIDTH; ++set) {
        any |= batch->status[set] == 0;
    }
    if (any) {
        misfit_of(batch, data, sum);
    }
    for (int set = 0; set < NAME_WIDTH; ++set) {
        misfit[set] = batch->status[set] == 0 ? AT(sum[set / SETS], set % SETS) : not_a_number();
    }
}
