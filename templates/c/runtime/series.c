/* series.c: what all of a program with parameters at run time starts from: numbers, windows, places of waves and joints. */
#include "tables.h"

/* So many samples are a block. */
enum { BLOCK = 16 };

/* How many numbers of a wave follow its series: zeros. */
enum { SPARE = NAME_ROW - NAME_DEGREE };

/* Of series and of states of a block there is room for so many. */
enum { ROW = NAME_ROW, MOST_STATES = NAME_WIDEST };

/* The numbers of a body for each degree, k > 0: y_k = RATIO (p_(k-1) - p_(k+1) + y_(k+1)), with p_0 twice, q_k = y_k -
 * RATIO q_(k-1); FIRST and LAST sum to the velocity at both ends. At k = 0 what q_0 has less, and what the end has. */
enum { RATIO = 0, SUM_FIRST = 1, SUM_LAST = 2, SLACK = 0, LOSS = 1 };

/* A lane of a vector. */
#if VECTOR > 0
#define AT(x, lane) ((x)[lane])
#else
#define AT(x, lane) (x)
#endif

static real magnitude(real x)
{
#if defined(__GNUC__) && !defined(__FRAMAC__)
    return (real)__builtin_fabs((double)x);
#else
    return x < 0 ? -x : x;
#endif
}

static real larger(real one, real other)
{
    return magnitude(other) > one ? magnitude(other) : one;
}

/* False for what is no number. */
static int finite_number(real x)
{
    return x >= -largest_number && x <= largest_number;
}

static real positive_infinity(void)
{
    const volatile real zero = 0;
    return 1 / zero;
}

static const slice *slice_at(const real *x, size_t k)
{
    return (const slice *)(x + k);
}

/* When the cycle of a window begins: after CYCLE windows, which are `span` long, tau is a whole number again. */
static real cycle_begin(int window)
{
    return (real)(window / CYCLE) * span;
}

/* Where a section of a window is among those of its cycle. */
static int in_cycle(int window, int section)
{
    return window % CYCLE * SECTIONS + section;
}

/* Where the section ends; what lies beyond TAU_MAX does not count. */
static real section_end(int window, int section)
{
    const real reach = NAME_TAU_MAX - cycle_begin(window), end = from[in_cycle(window, section) + 1];
    return end < reach ? end : reach;
}

/* Of a strand the u on [-1, 1] at t after the start of its window's cycle. */
static real place_on(int strand, int window, real t)
{
    const int now = window % CYCLE * NAME_STRANDS + strand;
    return ((t - strand_start[now]) + strand_excess[now]) * strand_scale[strand] - 1;
}

/* Where a track has what it had so many windows ago, at most as many as it has steps: often each has just one. */
static int slot(int track, int window, int ago)
{
    const int turn = NAME_SLOTS == 2 * NAME_TRACKS ? 2 : steps[track] + 1;
    return turn == 2 ? ring[track] + ((window + ago) & 1) : ring[track] + (window + turn - ago) % turn;
}

/* Whether a strand is the sum of two waves, not of integrals. */
static int has_two(int strand)
{
    const int first = first_term[strand];
    return first_term[strand + 1] - first == 2 && !term_summed[first] && !term_summed[first + 1];
}

static int states_of(int joint)
{
    return first_state[joint + 1] - first_state[joint];
}

static int points_of(int joint)
{
    return first_point[joint + 1] - first_point[joint];
}

/* Whether a joint has matrices of a block. */
static int is_block(int joint)
{
    return NAME_SQUARES > 0 && at_square[joint + 1] > at_square[joint];
}

/* The time since a load changed, at the start of a panel: a sum, so that nothing cancels. */
static real time_since(const int *since, int window, int panel)
{
    return (real)(window - since[0] - (panel < since[1] ? 1 : 0)) * window_length + since_panel[panel * NAME_PANELS + since[1]];
}

/* Whether an event, of those in order, is on a panel. */
static int is_event(int event, int window, int panel)
{
    return NAME_EVENTS > 0 && event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel;
}

static int higher_than(int degree)
{
    const int higher = degree + degree / 4;
    return higher < NAME_DEGREE ? higher : NAME_DEGREE;
}
