/* fmi2.c: simulation.h as FMI 2.0 calls it, for co-simulation. Errors and warnings are logged always, and nothing else. */
#include "fmi2.h"
#include "simulation.h"

/* What functions are given stands in the standard; not all of it matters here. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

typedef struct {
    simulation run;
    fmi2CallbackFunctions calls;
    char name[64];
} instance;

static fmi2Status answer(instance *it, verdict found)
{
    const fmi2Status status = found == FINE ? fmi2OK : found == LOSING ? fmi2Warning : fmi2Error;
    if (status != fmi2OK && it->calls.logger) {
        it->calls.logger(it->calls.componentEnvironment, it->name, status,
                         status == fmi2Warning ? "logStatusWarning" : "logStatusError", "%s", it->run.said);
    }
    return status;
}

/* What this model has none of. */
static fmi2Status none(instance *it, const char *what)
{
    return answer(it, lack(&it->run, what));
}

/* A call of simulation.h. */
#define CALL(function, arguments, call) \
    FMI2_FUNCTION(fmi2Status, function, arguments) \
    { \
        simulation *const s = &((instance *)c)->run; \
        return answer((instance *)c, call); \
    }

/* Functions and values that this model has none of, though simulators look for their names. */
#define VARIABLES fmi2Component c, const fmi2ValueReference reference[], size_t count
#define NONE(function, what, arguments) \
    FMI2_FUNCTION(fmi2Status, function, arguments) \
    { \
        return none((instance *)c, what); \
    }
#define NO_VALUE(function, what, arguments) \
    FMI2_FUNCTION(fmi2Status, function, arguments) \
    { \
        return count ? none((instance *)c, what) : fmi2OK; \
    }

FMI2_FUNCTION(const char *, fmi2GetTypesPlatform, (void))
{
    return "default";
}

FMI2_FUNCTION(const char *, fmi2GetVersion, (void))
{
    return "2.0";
}

FMI2_FUNCTION(fmi2Status, fmi2SetDebugLogging,
              (fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]))
{
    return fmi2OK;
}

FMI2_FUNCTION(fmi2Component, fmi2Instantiate,
              (fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
               const fmi2CallbackFunctions *calls, fmi2Boolean visible, fmi2Boolean logging))
{
    const char *wrong = "not enough memory";
    instance *it = NULL;
    if (type != fmi2CoSimulation) {
        wrong = "fmuType: co-simulation expected";
    } else if (guid == NULL || strcmp(guid, TOKEN) != 0) {
        wrong = "fmuGUID: not that of this model";
    } else {
        it = (instance *)calloc(1, sizeof *it);
    }
    if (it == NULL) {
        if (calls && calls->logger) {
            calls->logger(calls->componentEnvironment, name, fmi2Error, "logStatusError", "%s", wrong);
        }
        return NULL;
    }
    if (calls) {
        it->calls = *calls;
    }
    snprintf(it->name, sizeof it->name, "%s", name ? name : "");
    reset(&it->run);
    return it;
}

FMI2_FUNCTION(void, fmi2FreeInstance, (fmi2Component c))
{
    free(c);
}

CALL(fmi2SetupExperiment,
     (fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop, fmi2Real stop),
     set_times(s, start, has_stop, stop))
CALL(fmi2EnterInitializationMode, (fmi2Component c), begin(s))
CALL(fmi2ExitInitializationMode, (fmi2Component c), ready(s))
CALL(fmi2Terminate, (fmi2Component c), finish(s))

FMI2_FUNCTION(fmi2Status, fmi2Reset, (fmi2Component c))
{
    reset(&((instance *)c)->run);
    return fmi2OK;
}

CALL(fmi2GetReal, (VARIABLES, fmi2Real value[]), get_reals(s, reference, count, value))
CALL(fmi2SetReal, (VARIABLES, const fmi2Real value[]), set_reals(s, reference, count, value))

FMI2_FUNCTION(fmi2Status, fmi2GetBoolean,
              (fmi2Component c, const fmi2ValueReference reference[], size_t count, fmi2Boolean value[]))
{
    instance *const it = (instance *)c;
    const verdict found = may_be_linear(&it->run, reference, count, 0);
    for (size_t k = 0; k < count && found == FINE; ++k) {
        value[k] = it->run.now.linear;
    }
    return answer(it, found);
}

FMI2_FUNCTION(fmi2Status, fmi2SetBoolean,
              (fmi2Component c, const fmi2ValueReference reference[], size_t count, const fmi2Boolean value[]))
{
    instance *const it = (instance *)c;
    const verdict found = may_be_linear(&it->run, reference, count, 1);
    for (size_t k = 0; k < count && found == FINE; ++k) {
        it->run.now.linear = value[k] != 0;
    }
    return answer(it, found);
}

NO_VALUE(fmi2GetInteger, "an integer", (VARIABLES, fmi2Integer value[]))
NO_VALUE(fmi2SetInteger, "an integer", (VARIABLES, const fmi2Integer value[]))
NO_VALUE(fmi2GetString, "a string", (VARIABLES, fmi2String value[]))
NO_VALUE(fmi2SetString, "a string", (VARIABLES, const fmi2String value[]))
CALL(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *state), keep(s, &s->now, state))
CALL(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate state), put_back(s, state))

FMI2_FUNCTION(fmi2Status, fmi2FreeFMUstate, (fmi2Component c, fmi2FMUstate *state))
{
    give_up(state);
    return fmi2OK;
}

FMI2_FUNCTION(fmi2Status, fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size))
{
    *size = KEPT_SIZE;
    return fmi2OK;
}

CALL(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
     serialize(s, state, bytes, size))
CALL(fmi2DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
     deserialize(s, bytes, size, state))
NONE(fmi2GetDirectionalDerivative, "a directional derivative",
     (fmi2Component c, const fmi2ValueReference unknowns[], size_t rows, const fmi2ValueReference knowns[],
      size_t columns, const fmi2Real seed[], fmi2Real product[]))
NO_VALUE(fmi2SetRealInputDerivatives, "an input's derivative (canInterpolateInputs is false)",
         (VARIABLES, const fmi2Integer order[], const fmi2Real value[]))
NO_VALUE(fmi2GetRealOutputDerivatives, "an output's derivative (maxOutputDerivativeOrder is 0)",
         (VARIABLES, const fmi2Integer order[], fmi2Real value[]))
CALL(fmi2DoStep, (fmi2Component c, fmi2Real at, fmi2Real step, fmi2Boolean never_back), advance(s, at, step))
NONE(fmi2CancelStep, "a step that runs while others do", (fmi2Component c))

FMI2_FUNCTION(fmi2Status, fmi2GetRealStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Real *value))
{
    if (kind != fmi2LastSuccessfulTime) {
        return none((instance *)c, "such a status");
    }
    *value = ((instance *)c)->run.now.time;
    return fmi2OK;
}

NONE(fmi2GetStatus, "a step that runs while others do", (fmi2Component c, const fmi2StatusKind kind, fmi2Status *value))
NONE(fmi2GetIntegerStatus, "a status that is an integer",
     (fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value))

FMI2_FUNCTION(fmi2Status, fmi2GetBooleanStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value))
{
    if (kind != fmi2Terminated) {
        return none((instance *)c, "such a status");
    }
    *value = 0; /* it never wants to end */
    return fmi2OK;
}

NONE(fmi2GetStringStatus, "a status that is text", (fmi2Component c, const fmi2StatusKind kind, fmi2String *value))
