/* blocks.c: an output of a model that has been built at many instants of a section. */
#include "read.c"

/* A block of an output at t after the start of a window's cycle. */
static BY_ITSELF void output_block(const name_model *m, int window, int at, const real *t, real *out)
{
    enum { WIDTH = BLOCK / LANES < ABREAST ? BLOCK / LANES : ABREAST };
    const size_t size = (size_t)m->degree[window] + 2;
    for (int j = 0; j < BLOCK; ++j) {
        out[j] = 0;
    }
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const int now = window % CYCLE * NAME_STRANDS + s;
        const real begin = strand_start[now], excess = strand_excess[now], scale = strand_scale[s];
        for (size_t first = 0; first < BLOCK; first += WIDTH * LANES) {
            slice u[WIDTH], sum[WIDTH];
            UNROLLED
            for (size_t j = 0; j < WIDTH; ++j) {
                u[j] = ((*slice_at(t, first + j * LANES) - begin) + excess) * scale - 1;
            }
            together(1, WIDTH, m->series + m->place[window] + (size_t)s * size, size, u, sum);
            UNROLLED
            for (size_t j = 0; j < WIDTH; ++j) {
                *(slice *)(out + first + j * LANES) += sum[j];
            }
        }
    }
}
