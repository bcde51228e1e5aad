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

/* The points of a panel on [-1, 1], from 1 down. */
extern const real cosine[];
/* half the length of a panel; what its start is later than that of another: since[panel*PANELS + other] */
extern const real half_length[];
extern const real since[];
/* Nodes; body[panel*NODES + node] is the row of a body in the tables below, -1 for a node without inertia. */
extern const real alpha[];
extern const real beta[];
extern const int body[];
extern const int force_on[];
extern const real motion[];
extern const real mass[];
/* rods: impedance, and their waves at tau = 0, of the one on the left of each node and that on the right of the last */
extern const real impedance[];
extern const real rod[];
/* bodies on panels: rows of DEGREE + 1 */
extern const real ratio[];
extern const real first[];
extern const real last[];
extern const real slack[];
extern const real loss[];
extern const real leak[];
/* changes of the scene's loads: from there on three powers of the time since */
extern const int event_window[];
extern const int event_panel[];
extern const int event_force[];
extern const real event_power[];
/* loads that can be given: on which force, how strong, and whether it is their integral that acts */
extern const int source_force[];
extern const real source_gain[];
extern const int source_integral[];
/* Outputs: where what they hear starts in the next tables; which way it is sent and by which node (or which load it is),
 * factors, whether the integral counts, and how late it arrives. */
extern const int first_heard[];
extern const int way[];
extern const int sender[];
extern const real gain[];
extern const int summed[];
extern const int delay[];
/* Delays: in a window, t after its start, a wave is that of `panel`, `back` windows ago, from t >= `from` on, with
 * u = (t - start + excess) / half - 1. */
extern const int first_stretch[];
extern const real from[];
extern const real start[];
extern const real excess[];
extern const int back[];
extern const int panel_of[];
