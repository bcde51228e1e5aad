/* batch.c: the march of a chain in lanes.
 * Plain C that stands below the text of march.c in generated files, which have what stands below the first
 * empty line. */
#include "part.c"
#include "march.c"

#undef num
#undef OF
#undef PICK
#undef SIZE
#undef ZERO
#undef FUSED

static void tabulate_parts(part_of *p, const laws_batch *law, int degree)
{
    tabulate_batch(p, law, PARTS, degree);
}

static void march_parts(part_of *p, const laws_batch *law, int window, int degree, wide *size, wide *missed)
{
    march_batch(p, law, PARTS, window, degree, size, missed);
}

/* At rest, or as rods and masses move at first. */
static void started_batch(part_of *b, const laws_batch *law)
{
    start_waves_batch(b->waves, law, LEAST + 1);
    for (int k = 0; k < NAME_STATES; ++k) {
        b->state[0][k] = law->begun[k];
    }
}

/* Series of another degree: what they had not is 0. */
static void raise_batch(part_of *b, int degree, int higher)
{
    for (int place = 0; place < NAME_SLOTS; ++place) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int k = degree + 1; k <= higher; ++k) {
                b->waves[place][panel][k] = none;
            }
        }
    }
}

/* The next window begins as this one ends. */
static void settle_batch(part_of *b)
{
    for (int k = 0; k < NAME_STATES; ++k) {
        b->state[0][k] = b->state[1][k];
    }
}

static const wide *sent_batch(part_of *b, int t, int window)
{
    return b->waves[slot(term_track[t], window, term_back[t])][term_panel[t]];
}
