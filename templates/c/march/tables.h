/* tables.h: stands for what plain.c.j2 writes above the text of march.c, where that is read by itself. */
#define TABLES
#include "../name.h"

#include "../real.h"

enum {
    OUTPUTS = NAME_OUTPUTS,
    DEGREE = 20,
    SIZE = DEGREE + 1,
    PANELS = 2,
    JOINTS = 3,
    BODIES = 1,
    BLOCKS = 1,
    STATES = 2,
    FORCES = 1,
    EVENTS = 3,
    TRACKS = 5,
    SLOTS = 13,
    CYCLE = 2,
    WIDEST = 43, /* rows of the matrix of a block */
    MOST_PORTS = 2,
    POWERS = 3, /* of a force */
    BODY = 1,
    BLOCK = 2
};

/* tracks: how many windows later what is sent arrives */
extern const int steps[];
/* where the ring of its windows starts */
extern const int ring[];
/* what is on its way at tau = 0 */
extern const real held[];
#include "../ports.h"
/* what acts for a wave that arrives at a port; what joints do (0 scatter, 1 a body, 2 a block), how strong loads are on a
 * body; where on each panel their matrix is, by columns: of a body three numbers for each degree, slack, loss and 0, then
 * ratio, first and last */
extern const real push[];
extern const int law[];
extern const real drive[];
extern const int answer[];
extern const real matrix[];
extern const real initial_state[];
/* half the length of a panel; what its start is later than that of another: since[panel*PANELS + other] */
extern const real half_length[];
extern const real since[];
/* changes of the loads: from there on three powers of the time since */
extern const int event_window[];
extern const int event_panel[];
extern const int event_force[];
extern const real event_power[];
/* Outputs: where their tracks start in the next tables; factors, whether the integral counts, and delays. */
extern const int first_term[];
extern const int track[];
extern const real gain[];
extern const int summed[];
extern const int delay[];

/* A window, and a cycle: after so many windows tau is a whole number again; where they begin in it. */
extern const real step;
extern const real span;
extern const real begin[];
/* Delays: from t >= `from` on, t counted from the start of the cycle, a wave is that of `panel_of`, `back` windows ago,
 * with u = (t - start + excess) / half - 1; an integral over all of a window is from low to high. */
extern const int first_stretch[];
extern const real from[];
extern const real start[];
extern const real excess[];
extern const real low[];
extern const real high[];
extern const int back[];
extern const int panel_of[];
