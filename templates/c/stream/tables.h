/* tables.h: stands for what stream.c.j2 writes above the text of stream.c, where that is read by itself. */
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
    NAME_OWN_POINTS = 1
};

#ifdef NAME_RUNTIME
typedef struct {
    name_real kappa[3];
} name_parameters;

enum { NAME_LAW_COUNT = 16, NAME_PORTS = 4, NAME_ANSWERS = 1000, NAME_SLIPS = 100, NAME_HEARD = 4 };

typedef struct {
    name_real law[NAME_LAW_COUNT + 1];
    name_real weight[NAME_STATES + 1];
    name_real begun[NAME_STATES + 1];
    name_real push[NAME_PORTS + 1];
    name_real held[NAME_TRACKS + 1];
    name_real base[NAME_FORCES + 1];
    name_real strength[NAME_FORCES * NAME_LOADS + 1];
    name_real gain[NAME_HEARD + 1];
    name_real matrix[NAME_ANSWERS + 1];
    name_real slip[NAME_SLIPS + 1];
    name_real fastest;
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
    OWN_POINTS = NAME_OWN_POINTS,
    MOST_STATES = 1,
    MOST_POINTS = 1,
    MOST_JOINED = 2,
    TERMS = 18,
    WIDEST = SIZE + 1
};

#ifdef NAME_RUNTIME
enum { MOST_MOVED = 2, HEARD = NAME_HEARD, CAUTION = 4, CALM = 4 };

extern const name_parameters name_defaults;
extern const real largest_number;
extern const int law_of[];
extern const int is_mass[];

int good(const name_parameters *p);
void laws_of(const name_parameters *p, stream *state);
int laws_within_reach(const stream *state);
int name_build(stream *state, const name_parameters *parameters);

#define matrix state->made.matrix
#define slip state->made.slip
#define fastest state->made.fastest
#define law state->made.law
#define weight state->made.weight
#define begun state->made.begun
#define push state->made.push
#define held state->made.held
#define base state->made.base
#define strength state->made.strength
#define gain state->made.gain
#else
extern const real fastest;
extern const real held[];
extern const real matrix[];
extern const real begun[];
extern const real push[];
extern const real slip[];
extern const real law[];
extern const real base[];
extern const real strength[];
extern const real gain[];
#endif

void name_init(stream *state);
int name_step(stream *state, real dtau, const real *load, real *out);
real name_lost(const stream *state);

extern const real panel, panel_low, scale, tolerance, shortest, longest;

extern const int slots[];
extern const int first_slot[];
extern const int first_point[];
extern const int first_state[];
extern const int first_port[];
extern const int answer[];
extern const int force_on[];
extern const int point_of[];
extern const real ratio[];
extern const int arrive[];
extern const int send[];
extern const int first_slip[];
extern const int loaded[];
extern const int first_own[];
extern const int first_law[];
extern const int integrated[];
extern const real instant[];
extern const real transform[];
extern const real kink[];
extern const int first_heard[];
extern const int track[];
extern const int summed[];
extern const int late[];
extern const real rest[];
extern const int own_point[];
extern const real own_ratio[];
