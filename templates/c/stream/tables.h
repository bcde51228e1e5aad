/* tables.h: stands for what stream.c.j2 writes above the text of stream.c, where that is read by itself. */
#define TABLES
#include "../name.h"

#include "../real.h"

enum {
    NAME_LOADS = 1,
    NAME_DEGREE = 11,
    NAME_PANELS = 8,
    NAME_TRACKS = 5,
    NAME_SLOTS = 37,
    NAME_STATES = 2,
    NAME_FORCES = 1,
    NAME_BREAKPOINTS = 4,
    NAME_ENTRIES = 9
};

#ifdef NAME_RUNTIME
typedef struct {
    name_real kappa[3];
} name_parameters;

enum { NAME_LAW_COUNT = 16, NAME_PORTS = 4, NAME_ANSWERS = 1000, NAME_SLIPS = 100, NAME_TERMS = 4 };

typedef struct {
    name_real rates[NAME_LAW_COUNT + 1];
    name_real pushed[NAME_LAW_COUNT + 1];
    name_real shown[NAME_LAW_COUNT + 1];
    name_real passed[NAME_LAW_COUNT + 1];
    name_real weight[NAME_STATES + 1];
    name_real initial_state[NAME_STATES + 1];
    name_real push[NAME_PORTS + 1];
    name_real held[NAME_TRACKS + 1];
    name_real track_impedance[NAME_TRACKS + 1];
    name_real base[NAME_FORCES + 1];
    name_real strength[NAME_FORCES * NAME_LOADS + 1];
    name_real gain[NAME_TERMS + 1];
    name_real matrix[NAME_ANSWERS + 1];
    name_real drive[NAME_PORTS + 1];
    name_real slip[NAME_SLIPS + 1];
    name_real root_impedance[NAME_TRACKS + 1];
    name_real state_gain[NAME_TRACKS + 1];
    name_real growth;
} name_made;
#endif

typedef struct name_state {
#ifdef NAME_RUNTIME
    name_made made;
#endif
#include "state.h"
} name_state;

typedef name_state stream;

enum {
    OUTPUTS = NAME_OUTPUTS,
    DEGREE = NAME_DEGREE,
    SIZE = DEGREE + 1,
    TRACKS = NAME_TRACKS,
    LOADS = NAME_LOADS,
    FORCES = NAME_FORCES,
    STATES = NAME_STATES,
    JOINTS = 3,
    LOADED = 1,
    LOADED_PORTS = 2,
    BODIES = 1,
    BLOCKS = 1,
    MOST_STATES = 1,
    ENTRIES = NAME_ENTRIES,
    DEEPEST = 2, /* windows that a wave is on its way */
    MOST_PORTS = 2,
    POWERS = 3, /* of a force on a panel */
    WIDEST = 13, /* rows of the matrix of a block */
    BODY = 1,
    BLOCK = 2
};

/* tracks: what is sent into one end of a rod; how many panels it keeps, and windows of each breakpoint, where they begin,
 * what is on its way at tau = 0 */
extern const int slots[];
extern const int first_slot[];
extern const int entries[];
extern const int first_entry[];
extern const real held[];
/* what an error of a track counts for: in its rod, or at its point, where states may count besides */
extern const real root_impedance[];
extern const real state_gain[];
#include "../ports.h"
/* what acts for a wave that arrives at a port; what joints do (0 scatter, BODY, BLOCK), how strong loads are on a body;
 * their matrix, by columns: of a body three numbers for each degree, slack, loss and 0, then RATIO, SUM_FIRST and SUM_LAST */
extern const real push[];
extern const int law[];
extern const real drive[];
extern const int answer[];
extern const real matrix[];
extern const real initial_state[];
/* the point with which a state moves; where there is none, what it gains by how far points have moved, by rows */
extern const int moves_with[];
extern const int first_stretch[];
extern const real lengthening[];
/* what the polynomials of a joint miss, of its states, as the root of an energy: of a body its last p less q so many times,
 * of a block of what its matrix takes, by rows */
extern const int first_slip[];
extern const real slip[];
/* joints on which loads act */
extern const int loaded[];
/* forces: what they are without loads, how much of each load they are, and whether of its integral */
extern const real base[];
extern const real strength[];
extern const int integrated[];
/* the instants of a panel; from values there to coefficients, by rows; and how wrong these are at most where a jump, a kink
 * or a bend is between two instants */
extern const real instant[];
extern const real transform[];
extern const real kink[];
/* Outputs: where their tracks start in the next tables; factors, whether the integral counts, delays in panels and what
 * is left; and the force that is shown in place of a track, -1 for none. */
extern const int first_term[];
extern const int track[];
extern const real gain[];
extern const int summed[];
extern const int late[];
extern const real rest[];
extern const int shown_force[];

/* A panel in two numbers, 2 / its length, and the length of a window. */
extern const real panel;
extern const real panel_low;
extern const real scale;
extern const real step_length;
/* What may be lost, of the largest wave; and by one breakpoint that is given up, for a tau of its step. */
extern const real tolerance;
extern const real share;
/* Of what polynomials miss: what it makes wrong at once, and how steep; how steep the rest becomes in a window; the root of
 * a panel; and waves that are no larger than rounding. */
extern const real rough;
extern const real steep;
extern const real growth;
extern const real root_panel;
extern const real least;
/* Instants that are one, and what of the time that is past is rounding; the shortest step but 0, the shortest in which
 * loads do not jump, and the longest. */
extern const real nearest;
extern const real rounding;
extern const real shortest;
extern const real shortest_ramp;
extern const real longest;

/* where the laws of a joint begin */
extern const int at_rates[];
extern const int at_pushed[];
extern const int at_shown[];
extern const int at_passed[];

#ifdef NAME_RUNTIME
enum { TERMS = NAME_TERMS, CALM = 4, ROW = SIZE + 1 };

extern const name_parameters name_defaults;
extern const real largest_number;

int good(const name_parameters *p);
void laws_of(const name_parameters *p, name_made *made);
int laws_within_reach(const name_made *made);
int name_build(stream *state, const name_parameters *parameters);

#define matrix state->made.matrix
#define drive state->made.drive
#define slip state->made.slip
#define growth state->made.growth
#define root_impedance state->made.root_impedance
#define state_gain state->made.state_gain
#define initial_state state->made.initial_state
#define push state->made.push
#define held state->made.held
#define base state->made.base
#define strength state->made.strength
#define gain state->made.gain
#endif

void name_init(stream *state);
int name_step(stream *state, real dtau, const real *load, real *out);
real name_lost(const stream *state);
