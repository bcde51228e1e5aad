/* joints.c: where the numbers of joints and waves of a chain are, under parameters that come at run time.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "series.c"

/* The numbers of a body for each degree, k > 0: y_k = GAIN (s_(k-1) - s_(k+1)) + RATIO y_(k+1), with s_0 twice,
 * q_k = y_k - RATIO q_(k-1), the others sum to the velocity at both ends; at k = 0 what q_0 has less, and what the end has. */
enum { GAIN = 0, RATIO = 1, SUM_FIRST = 2, SUM_LAST = 3, SLACK = 0, LOSS = 1, RATE = 2, DRIVE = 3 };

/* Bodies move side by side: each step of a recurrence waits for the one before. */
enum { BODIES_AT_ONCE = 2 };

/* The matrices of a block for each degree, and two more: x_k = SOLVE r_k + DOWN y_(k+1) - DOWN x_(k-1), FIRST and LAST sum
 * to the state at both ends; START and END belong to x_0. */
enum { SOLVE = 0, DOWN = 1, FIRST = 2, LAST = 3, START = 0, END = 1 };

/* Bytes of vectors of many sets: clang keeps several registers side by side in one, which hides what joints wait for. */
#if defined(__clang__) && VECTOR
#define WIDE 64
#else
#define WIDE VECTOR
#endif

/* How many numbers of a wave follow its series: zeros. */
enum { SPARE = NAME_ROW - NAME_DEGREE };

/* Where a track has what it had so many windows ago, at most as many as it has steps: often each has just one. */
static int slot(int track, int window, int ago)
{
    const int turn = NAME_SLOTS == 2 * NAME_TRACKS ? 2 : steps[track] + 1;
    return turn == 2 ? ring[track] + ((window + ago) & 1) : ring[track] + (window + turn - ago) % turn;
}

/* Where each track has what is sent into it on a window, and what arrives from it: the oldest that it has. */
typedef struct {
    int sent[NAME_TRACKS], arrived[NAME_TRACKS];
} places;

static void placed(int window, places *now)
{
    for (int track = 0; track < NAME_TRACKS; ++track) {
        const int sent = slot(track, window, 0);
        now->sent[track] = sent;
        now->arrived[track] = sent < ring[track] + steps[track] ? sent + 1 : ring[track];
    }
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

/* A panel, counted through all windows, that there is not: what begins there does not begin. */
enum { NEVER = NAME_WINDOWS * NAME_PANELS };

/* No parameter: the values themselves. */
enum { OF_VALUES = -1 };

/* From which panel on, counted through all windows, something moves at a joint, or acts on it: its own, at first. Of
 * derivatives, where `of` is what the laws change by: what differs as the parameter does. */
static int stirred(const laws *law, const laws *of, int lane, int joint)
{
    int since = NEVER;
    for (int event = NAME_EVENTS - 1; event >= 0; --event) {
        const int loaded = magnitude(law->load[event_load[event]]) > 0;
        const int own = LOAD_LANE >= 0 && lane == LOAD_LANE + event_load[event];
        const int acts = own || (loaded && (lane == OF_VALUES || magnitude(of->strength[event_strength[event]]) > 0));
        for (int point = first_point[joint]; point < first_point[joint + 1]; ++point) {
            if (force_on[point] == event_force[event] && acts) {
                since = event_window[event] * NAME_PANELS + event_panel[event];
            }
        }
    }
    for (int state = first_state[joint]; state < first_state[joint + 1]; ++state) {
        since = magnitude(of->begun[state]) > 0 ? 0 : since;
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        since = magnitude(of->held[arrive[port]]) > 0 || magnitude(of->held[send[port]]) > 0 ? 0 : since;
    }
    return since;
}

/* From which panel on something arrives at a port; `since` says from which on it is sent into each track. */
static int arrives(const int *since, int port)
{
    const int wait = steps[arrive[port]] * NAME_PANELS;
    const int sent = since[arrive[port]];
    return sent < NEVER - wait ? sent + wait : NEVER;
}

/* What `stirred` says, where its laws change: as soon as values move there. */
static int turned(const laws *law, const laws *slope, const int *since, int joint)
{
    const int n = states_of(joint), points = points_of(joint);
    int when = stirred(law, law, OF_VALUES, joint);
    real most = 0;
    for (int k = 0; k < n * n; ++k) {
        most = larger(most, slope->rates[at_rates[joint] + k]);
    }
    for (int k = 0; k < n * points; ++k) {
        most = larger(larger(most, slope->pushed[at_pushed[joint] + k]), slope->shown[at_shown[joint] + k]);
    }
    for (int k = 0; k < points * points; ++k) {
        most = larger(most, slope->passed[at_passed[joint] + k]);
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const int then = arrives(since, port);
        most = larger(most, slope->push[port]);
        when = then < when ? then : when;
    }
    return most > 0 ? when : NEVER;
}

/* From which panel on something is sent into each track, from what joints have of their own. */
static void spread_out(int *since)
{
    for (int turn = 0; turn < NAME_JOINTS; ++turn) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            for (int in = first_port[joint]; in < first_port[joint + 1]; ++in) {
                const int then = arrives(since, in);
                for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                    since[send[port]] = then < since[send[port]] ? then : since[send[port]];
                }
            }
        }
    }
}

/* Whether an output hears what is sent, or what is there at first, up to TAU_MAX. */
static int heard_since(const laws *of, const int *since, int output)
{
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        for (int s = 0; s < SECTIONS && cycle_begin(window) + from[in_cycle(window, s)] <= NAME_TAU_MAX; ++s) {
            const int at = s * NAME_OUTPUTS + output;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                for (int t = first_term[strand_at[k]]; t < first_term[strand_at[k] + 1]; ++t) {
                    const int when = (window - term_back[t]) * NAME_PANELS + term_panel[t];
                    if (when >= since[term_track[t]] || magnitude(of->held[term_track[t]]) > 0) {
                        return 1;
                    }
                }
            }
        }
    }
    return 0;
}

/* Whether a joint that something has come to can be felt in an output up to TAU_MAX: what numbers that cancel leave does
 * not matter. Of derivatives that is a joint whose laws change, by `slope`. */
static int reached(const laws *law, const laws *slope, int lane, int output)
{
    int since[NAME_TRACKS], changed[NAME_TRACKS];
    real weight = 0;
    for (int track = 0; track < NAME_TRACKS; ++track) {
        since[track] = NEVER;
        changed[track] = NEVER;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            since[send[port]] = stirred(law, law, OF_VALUES, joint);
        }
    }
    spread_out(since);
    if (lane == OF_VALUES) {
        return heard_since(law, since, output);
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int own = stirred(law, slope, lane, joint), of_laws = turned(law, slope, since, joint);
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            changed[send[port]] = own < of_laws ? own : of_laws;
        }
    }
    spread_out(changed);
    for (int k = 0; k < NAME_HEARD; ++k) {
        weight = heard_output[k] == output ? larger(weight, slope->gain[k]) : weight;
    }
    return heard_since(slope, changed, output) || (weight > 0 && heard_since(law, since, output));
}

/* Where the matrices of a joint begin, of those of a degree. */
static size_t square_at(int joint, int k)
{
    return (size_t)k * NAME_SQUARES + (size_t)at_square[joint];
}

/* `most` grows to the magnitude of x */
static void enlarge(real *most, const real *x)
{
    *most = larger(*most, *x);
}

static void add_magnitude(real *sum, const real *x)
{
    *sum += magnitude(*x);
}

/* The march follows, of one set of parameters. */
#define num real
#define OF(name) name
#define PICK(test, one, other) ((test) ? (one) : (other))
#define SIZE(x) magnitude(x)
#define ZERO ((real)0)
#define FUSED 0
