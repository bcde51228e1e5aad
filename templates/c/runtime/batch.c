/* batch.c: models of many sets of parameters at once. */
#include "lanes.c"
#include "laws.h"
#include "set.h"
void spread(laws_batch *all, int lane, const laws *law);
#include "build.c"

/* Lanes of sets are where sets are, and as large; else this is no type. */
typedef char as_large[sizeof(march_state_batch) == SETS * sizeof(name_march_state) ? 1 : -1];

/* A set's laws, and how its loads change, into its lane. */
static void place_laws(march_state_batch *sets, laws_batch *all, int set, const laws *law)
{
    spread(all + set / SETS, set % SETS, law);
    for (int event = 0; event < NAME_EVENTS; ++event) {
        AT(sets[set / SETS].change[event], set % SETS) = change_by(law, event, law->strength[event_strength[event]]);
    }
}

/* The laws of all sets; others go along as one that is good. How many are good. */
static int check_batch(progress_batch *b, laws_batch *all, const name_parameters *parameters, size_t sets)
{
    laws law, other;
    int good_ones = 0;
    for (int set = 0; set < NAME_WIDTH; ++set) {
        b->status[set] = (size_t)set < sets ? check_laws(parameters + set, &law) : 1;
        if (b->status[set] == 0) {
            place_laws(b->sets, all, set, &law);
            other = law;
            ++good_ones;
        }
    }
    for (int set = 0; good_ones > 0 && set < NAME_WIDTH; ++set) {
        if (b->status[set]) {
            place_laws(b->sets, all, set, &other);
        }
    }
    return good_ones;
}

int name_build_batch(name_batch *batch, const name_parameters *parameters, size_t sets)
{
    laws_batch law[parts_batch];
    progress_batch now;
    int highest = 0;
    now.sets = (march_state_batch *)(void *)batch->work;
    now.tables = (march_tables_batch *)(void *)batch->tables;
    now.law = law;
    now.inverse = batch->inverse;
    now.since = batch->since;
    now.series = (wide *)(void *)batch->series;
    now.degrees = batch->degree;
    now.places = batch->place;
    for (int set = 0; set < NAME_WIDTH; ++set) {
        batch->estimate[set] = not_a_number();
    }
    if (check_batch(&now, law, parameters, sets) > 0) {
        start_batch(&now);
        march_all_batch(&now);
        finish_batch(&now, parameters, batch->estimate);
    }
    for (int set = 0; set < NAME_WIDTH; ++set) {
        batch->status[set] = now.status[set];
        highest = (size_t)set < sets && now.status[set] > highest ? now.status[set] : highest;
    }
    return highest;
}

int name_batch_model(const name_batch *batch, int set, name_model *model)
{
    model->built = set >= 0 && set < NAME_WIDTH && batch->status[set] == 0;
    model->estimate = model->built ? batch->estimate[set] : not_a_number();
    for (int window = 0; window < NAME_WINDOWS && model->built; ++window) {
        const size_t begin = batch->place[window];
        const size_t size = (size_t)NAME_STRANDS * (size_t)(batch->degree[window] + 2);
        model->degree[window] = batch->degree[window];
        model->place[window] = begin;
        for (size_t k = begin; k < begin + size; ++k) {
            model->series[k] = batch->series[k][set];
        }
    }
    return !model->built;
}
