/* stream_tables.h: stands for what stream.c.j2 writes above the text of stream.c, where that is read by itself. */
#include "name.h"

#include "real.h"

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

#include "stream_state.h"

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

void name_init(stream *state);
int name_step(stream *state, real dtau, const real *load, real *out);
real name_lost(const stream *state);

extern const real panel, panel_low, scale, fastest, tolerance, shortest, longest;

extern const int slots[];
extern const int first_slot[];
extern const real held[];
extern const int first_point[];
extern const int first_state[];
extern const int first_port[];
extern const int answer[];
extern const real matrix[];
extern const real begun[];
extern const int force_on[];
extern const int point_of[];
extern const real push[];
extern const real ratio[];
extern const int arrive[];
extern const int send[];
extern const int first_slip[];
extern const real slip[];
extern const int loaded[];
extern const int first_own[];
extern const int first_law[];
extern const real law[];
extern const real base[];
extern const real strength[];
extern const int integrated[];
extern const real instant[];
extern const real transform[];
extern const real kink[];
extern const int first_heard[];
extern const int track[];
extern const real gain[];
extern const int summed[];
extern const int late[];
extern const real rest[];
extern const int own_point[];
extern const real own_ratio[];
