/* reach.c: where waves come to, whatever cancels, and what errors of outputs are relative to. */
#include "series.c"

/* A panel, counted through all windows, that there is not: what begins there does not begin. */
enum { NEVER = NAME_WINDOWS * NAME_PANELS };

/* No parameter: the values themselves. */
enum { OF_VALUES = -1 };

/* From which panel on, counted through all windows, something of its own acts at a joint, or is there at first. Of
 * derivatives, where `of` is what the laws change by: what differs as the parameter does. */
static BY_ITSELF int own_start(const laws *law, const laws *of, int lane, int joint)
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
        since = magnitude(of->initial[state]) > 0 ? 0 : since;
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        since = magnitude(of->initial_wave[arrive[port]]) > 0 || magnitude(of->initial_wave[send[port]]) > 0 ? 0 : since;
    }
    return since;
}

/* From which panel on something arrives at a port; `since` says from which on it is sent into each track. */
static int arrival(const int *since, int port)
{
    const int wait = steps[arrive[port]] * NAME_PANELS;
    const int sent = since[arrive[port]];
    return sent < NEVER - wait ? sent + wait : NEVER;
}

/* Whether some of the numbers of a joint in a law are not 0. */
static int differs(const real *numbers, int count)
{
    int some = 0;
    for (int k = 0; k < count; ++k) {
        some |= magnitude(numbers[k]) > 0;
    }
    return some;
}

/* Whether a joint answers otherwise as its laws change by `slope`. */
static int is_changed(const laws *slope, int joint)
{
    const int n = states_of(joint), points = points_of(joint), first = first_port[joint];
    return differs(slope->rates + at_rates[joint], n * n) || differs(slope->pushed + at_pushed[joint], n * points) ||
           differs(slope->shown + at_shown[joint], n * points) ||
           differs(slope->passed + at_passed[joint], points * points) ||
           differs(slope->push + first, first_port[joint + 1] - first);
}

/* From which panel on derivatives differ at a joint whose laws change: as soon as values move there. */
static int changed_start(const laws *law, const laws *slope, const int *since, int joint)
{
    int when = own_start(law, law, OF_VALUES, joint);
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const int then = arrival(since, port);
        when = then < when ? then : when;
    }
    return is_changed(slope, joint) ? when : NEVER;
}

/* From which panel on something is sent into each track, from what joints have of their own. */
static void propagate(int *since)
{
    for (int turn = 0; turn < NAME_JOINTS; ++turn) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            for (int in = first_port[joint]; in < first_port[joint + 1]; ++in) {
                const int then = arrival(since, in);
                for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                    since[send[port]] = then < since[send[port]] ? then : since[send[port]];
                }
            }
        }
    }
}

/* Whether an output reads what is sent, or what is there at first, up to TAU_MAX. */
static int is_read(const laws *of, const int *since, int output)
{
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        for (int s = 0; s < SECTIONS && cycle_begin(window) + from[in_cycle(window, s)] <= NAME_TAU_MAX; ++s) {
            const int at = s * NAME_OUTPUTS + output;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                for (int t = first_term[strand_at[k]]; t < first_term[strand_at[k] + 1]; ++t) {
                    const int when = (window - term_back[t]) * NAME_PANELS + term_panel[t];
                    if (when >= since[term_track[t]] || magnitude(of->initial_wave[term_track[t]]) > 0) {
                        return 1;
                    }
                }
            }
        }
    }
    return 0;
}

/* Whether what a joint sends can be seen in an output up to TAU_MAX: what numbers that cancel leave does not matter. Of
 * derivatives, by the parameter of a lane, that is what differs as laws change by `slope`. */
static int reached(const laws *law, const laws *slope, int lane, int output)
{
    int since[NAME_TRACKS], changed[NAME_TRACKS], weighs = 0;
    for (int track = 0; track < NAME_TRACKS; ++track) {
        since[track] = NEVER;
        changed[track] = NEVER;
    }
    for (int port = 0, joint = 0; port < NAME_PORTS; ++port) {
        joint += port == first_port[joint + 1] ? 1 : 0;
        since[send[port]] = own_start(law, law, OF_VALUES, joint);
    }
    propagate(since);
    if (lane == OF_VALUES) {
        return is_read(law, since, output);
    }
    for (int port = 0, joint = 0; port < NAME_PORTS; ++port) {
        joint += port == first_port[joint + 1] ? 1 : 0;
        const int own = own_start(law, slope, lane, joint), of_laws = changed_start(law, slope, since, joint);
        changed[send[port]] = own < of_laws ? own : of_laws;
    }
    propagate(changed);
    for (int k = 0; k < NAME_GAINS; ++k) {
        weighs |= gain_output[k] == output && magnitude(slope->gain[k]) > 0;
    }
    return is_read(slope, changed, output) || (weighs && is_read(law, since, output));
}

/* An error of a derivative relative to what is surely there of it; of one that waves have reached that may be nothing. */
static real relative_slope(const laws *law, const laws *slope, int lane, int output, real error, real largest)
{
    if (is_zero[output]) {
        return 0;
    }
    if (error < largest) {
        return error / (largest - error);
    }
    return !(error <= 0) && (largest > 0 || reached(law, slope, lane, output)) ? positive_infinity() : (real)0;
}

/* The same of an output. */
static real relative(const name_parameters *parameters, int output, real error, real largest)
{
    laws law;
    if (is_zero[output] || error < largest) {
        return is_zero[output] ? 0 : error / (largest - error);
    }
    laws_of(parameters, &law);
    return relative_slope(&law, &law, OF_VALUES, output, error, largest);
}

/* Of an output of size 1 the rounding error of reading it at a degree: sums of so many coefficients lose up to a sixteenth
 * of the degree squared. */
static real read_by(int degree)
{
    return unit * (real)(degree * degree) / 16;
}

/* About the largest error of velocities of such a size, of which polynomials miss so much: errors were up to five times
 * that (docs/march.md of wavesym has what was measured), and the sums of bodies are rounded as what is read is. */
static real velocity_error(real missed, real size, int degree)
{
    return 6 * missed + (unit * (real)(degree + NAME_WINDOWS) + (NAME_BODIES > 0 ? read_by(degree) : (real)0)) * size;
}
