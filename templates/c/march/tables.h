/* tables.h: stands for what march.c.j2 writes above the text of march.c, where that is read by itself. */
#include "../name.h"

enum { NAME_DEGREE = 20, NAME_PANELS = 2, NAME_NODES = 3, NAME_FORCES = 1, NAME_WAYS = 3, NAME_SOURCES = 1, NAME_POINTS = 42 };

#include "state.h"

#include "../real.h"
typedef name_state march;

enum {
    OUTPUTS = NAME_OUTPUTS,
    DEGREE = NAME_DEGREE,
    SIZE = DEGREE + 1,
    PANELS = NAME_PANELS,
    NODES = NAME_NODES,
    FORCES = NAME_FORCES,
    SOURCES = NAME_SOURCES,
    EVENTS = 3,
    LAST_WINDOW = 100,
    LEFT = 0,
    RIGHT = 1,
    LOAD = 2,
    WAYS = NAME_WAYS
};

void name_init(march *state);
int name_advance(march *state, const real *loads);
int name_read(const march *state, real tau, real out[OUTPUTS]);
real name_energy(const march *state);

extern const real reach, last_tau, trusted, smooth, noise;

extern const real cosine[];
extern const real half_length[];
extern const real since[];
extern const real alpha[];
extern const real beta[];
extern const int body[];
extern const int force_on[];
extern const real motion[];
extern const real mass[];
extern const real impedance[];
extern const real rod[];
extern const real ratio[];
extern const real first[];
extern const real last[];
extern const real slack[];
extern const real loss[];
extern const real leak[];
extern const int event_window[];
extern const int event_panel[];
extern const int event_force[];
extern const real event_power[];
extern const int source_force[];
extern const real source_gain[];
extern const int source_integral[];
extern const int first_heard[];
extern const int way[];
extern const int sender[];
extern const real gain[];
extern const int summed[];
extern const int delay[];
extern const int first_stretch[];
extern const real from[];
extern const real start[];
extern const real excess[];
extern const int back[];
extern const int panel_of[];
