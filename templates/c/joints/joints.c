/* joints.c: where the numbers of joints and waves of a chain are, under parameters that come at run time.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"
#define NAME_MARCHED
#include "../runtime/series.c"

/* The matrices of a joint for each degree, and two more: x_k = SOLVE r_k + DOWN y_(k+1) - DOWN x_(k-1), FIRST and LAST sum
 * to the state at both ends; START and END belong to x_0. */
enum { SOLVE = 0, DOWN = 1, FIRST = 2, LAST = 3, START = 0, END = 1 };

/* How many numbers of a wave follow its series: zeros. */
enum { SPARE = NAME_ROW - NAME_DEGREE };

/* Where a track has what it had so many windows ago, at most as many as it has steps. */
static int slot(int track, int window, int ago)
{
    const int turn = steps[track] + 1;
    return ring[track] + (window + turn - ago) % turn;
}

static int states_of(int joint)
{
    return first_state[joint + 1] - first_state[joint];
}

static int points_of(int joint)
{
    return first_point[joint + 1] - first_point[joint];
}

/* From which panel on, counted through all windows, something moves at a joint, or acts on it: its own, at first. */
static int stirred(const laws *law, int joint)
{
    int since = NAME_WINDOWS * NAME_PANELS;
    for (int event = NAME_EVENTS - 1; event >= 0; --event) {
        for (int point = first_point[joint]; point < first_point[joint + 1]; ++point) {
            if (force_on[point] == event_force[event] && magnitude(law->load[event_load[event]]) > 0) {
                since = event_window[event] * NAME_PANELS + event_panel[event];
            }
        }
    }
    for (int state = first_state[joint]; state < first_state[joint + 1]; ++state) {
        since = magnitude(law->begun[state]) > 0 ? 0 : since;
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        since = magnitude(law->held[arrive[port]]) > 0 || magnitude(law->held[send[port]]) > 0 ? 0 : since;
    }
    return since;
}

/* Whether a joint that something has come to can be felt in an output: what numbers that cancel leave does not matter. */
static int reached(const laws *law, int output)
{
    int since[NAME_TRACKS]; /* from which panel on something is sent */
    for (int track = 0; track < NAME_TRACKS; ++track) {
        since[track] = NAME_WINDOWS * NAME_PANELS;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            since[send[port]] = stirred(law, joint);
        }
    }
    for (int turn = 0; turn < NAME_JOINTS; ++turn) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            for (int in = first_port[joint]; in < first_port[joint + 1]; ++in) {
                const int then = since[arrive[in]] + steps[arrive[in]] * NAME_PANELS;
                for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                    since[send[port]] = then < since[send[port]] ? then : since[send[port]];
                }
            }
        }
    }
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        for (int of = 0; of < SECTIONS && cycle_begin(window) + from[in_cycle(window, of)] <= NAME_TAU_MAX; ++of) {
            const int at = of * NAME_OUTPUTS + output;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                for (int t = first_term[strand_at[k]]; t < first_term[strand_at[k] + 1]; ++t) {
                    const int when = (window - term_back[t]) * NAME_PANELS + term_panel[t];
                    if (when >= since[term_track[t]] || magnitude(law->held[term_track[t]]) > 0) {
                        return 1;
                    }
                }
            }
        }
    }
    return 0;
}

/* Where the matrices of a joint begin, of those of a degree. */
static size_t square_at(int joint, int k)
{
    return (size_t)k * NAME_SQUARES + (size_t)at_rates[joint];
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
