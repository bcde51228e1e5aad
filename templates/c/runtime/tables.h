/* tables.h: stands for what runtime.c.j2 writes above the text of runtime.c, where that is read by itself. */
#include <stddef.h>

#ifdef SINGLE
typedef float name_real;
#else
typedef double name_real;
#endif

#define NAME_TAU_MAX ((name_real)8)

enum {
    NAME_OUTPUTS = 2,
    NAME_WINDOWS = 9,
    NAME_STRANDS = 4,
    NAME_DEGREE = 40,
    NAME_PANELS = 2,
    NAME_NODES = 3,
    NAME_FORCES = 1,
    NAME_HEARD = 4,
    NAME_EVENTS = 3,
    NAME_LANES = 3,
    NAME_GROUPS = 6
};

typedef struct {
    name_real kappa[3];
} name_parameters;

typedef struct name_work name_work;
typedef struct name_model name_model;
typedef struct name_tangent name_tangent;
typedef struct name_batch name_batch;
typedef struct name_data name_data;

#include "work.h"
struct name_model {
#include "model.h"
};
#include "tangent.h"
#include "batch.h"
#include "data.h"

int name_build(name_model *model, const name_parameters *parameters);
int name_build_with(name_work *work, name_model *model, const name_parameters *parameters);
name_real name_error_estimate(const name_model *model);
int name_model_peaks(const name_model *model, name_real *out);
int name_model_eval(const name_model *model, name_real tau, name_real *out);
int name_model_sample(const name_model *model, name_real tau0, name_real dtau, size_t count, name_real *out);
int name_build_tangent(name_tangent *tangent, const name_parameters *parameters);
name_real name_tangent_estimate(const name_tangent *tangent, int lane);
int name_tangent_sample(
    const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out);
int name_error_bound(name_model *model, const name_parameters *parameters, name_real *bound);
int name_error_bound_with(
    name_work *work, name_model *model, const name_parameters *parameters, name_real *bound);
int name_build_batch(name_batch *batch, const name_parameters *parameters, size_t sets);
int name_batch_model(const name_batch *batch, int set, name_model *model);
size_t name_data_size(const name_real *tau, size_t count);
int name_data_init(
    name_data *data, name_real *numbers, const name_real *tau, const name_real *values, size_t count);
void name_batch_misfit(const name_batch *batch, const name_data *data, name_real *misfit);

#include <float.h>
#include "../real.h"
#include "../vectors.h"
typedef name_model model_of;
typedef name_work work_of;

enum { LEAST = 8, LOAD_LANE = -1, STRENGTHS = 1, SECTIONS = 3, CYCLE = 1, JOINTED = 0 };

/* What parameters make of nodes, rods, loads and outputs. */
typedef struct {
    real alpha[NAME_NODES];
    real beta[NAME_NODES];
    real rate[NAME_NODES];
    real motion[NAME_NODES];
    real rod[NAME_NODES + 1];
    real strength[STRENGTHS + 1];
    real gain[NAME_HEARD + 1];
    const real *load;
} laws;

int good(const name_parameters *p);
int good_for_slopes(const name_parameters *p);
void laws_of(const name_parameters *p, laws *law);
void slopes_of(const name_parameters *p, int lane, laws *law);

extern const real largest_number;
extern const real least_number;
extern const real faint;
extern const real share;
extern const real unit;
extern const real window_length;
extern const real span;
extern const real roundings;

/* half the length of a panel; what its start is later than that of another: since_panel[panel*PANELS + other] */
extern const real half_length[];
extern const real since_panel[];
/* which load acts on a node, -1 for none */
extern const int force_on[];
/* whether a node has inertia */
extern const int is_body[];
/* changes of loads, in order: a weight times an amplitude times a strength is added to a power of the time since, or
 * where 3 is added to this power stands for all that acted before */
extern const int event_window[];
extern const int event_panel[];
extern const int event_force[];
extern const int event_power[];
extern const real event_weight[];
extern const int event_strength[];
extern const int event_load[];
/* sections of a window, from which t on; an output on one is a sum of strands: first_strand[section*OUTPUTS + output] */
extern const real from[];
extern const int first_strand[];
extern const int strand_at[];
/* strands of a section that are read together, one behind the other: at the same instants, each of another output
 * (strand_output), which one before is of where there is `more` */
extern const int strand_output[];
extern const int first_reading[];
extern const int reading_strand[];
extern const int reading_strands[];
extern const int reading_more[];
/* strands: u = (t - start + excess) * scale - 1 */
extern const real strand_start[];
extern const real strand_excess[];
extern const real strand_scale[];
/* what a strand is the sum of: which wave, where it is, and from which u to which its integral goes */
extern const int first_term[];
extern const int term_heard[];
extern const int term_way[];
extern const int term_sender[];
extern const int term_back[];
extern const int term_panel[];
extern const int term_summed[];
extern const real term_low[];
extern const real term_high[];
/* of which output each wave is */
extern const int heard_output[];
/* whether it is 0 whatever the parameters are */
extern const int silent[];

/* the first alike[panel*NODES + node] of which a body has the same tables */
extern const int alike[];
