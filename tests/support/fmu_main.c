/* A program that loads an FMU's binary, sets a parameter and a load, steps, and prints the outputs after each step:
 *     main LIBRARY TOKEN PARAMETER VALUE LOAD VALUE FIRST_OUTPUT OUTPUTS STEPS LENGTH
 * where parameters, loads and outputs are value references. Compiled with -DVERSION=2 or 3. */
#if VERSION == 2
#include "fmi2.h"
fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean,
                              fmi2Boolean);
void fmi2FreeInstance(fmi2Component);
fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
fmi2Status fmi2EnterInitializationMode(fmi2Component);
fmi2Status fmi2ExitInitializationMode(fmi2Component);
fmi2Status fmi2GetReal(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
fmi2Status fmi2SetReal(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
fmi2Status fmi2DoStep(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
#else
#include "fmi3.h"
fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, const fmi3ValueReference[], size_t, fmi3InstanceEnvironment,
                                         fmi3LogMessageCallback, fmi3IntermediateUpdateCallback);
void fmi3FreeInstance(fmi3Instance);
fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64);
fmi3Status fmi3ExitInitializationMode(fmi3Instance);
fmi3Status fmi3GetFloat64(fmi3Instance, const fmi3ValueReference[], size_t, fmi3Float64[], size_t);
fmi3Status fmi3SetFloat64(fmi3Instance, const fmi3ValueReference[], size_t, const fmi3Float64[], size_t);
fmi3Status fmi3DoStep(fmi3Instance, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Boolean *, fmi3Boolean *, fmi3Boolean *,
                      fmi3Float64 *);
#endif

#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

/* A function of the library, of the type that the standard gives it. */
#define CALL(name) ((__typeof__(&name))FIND(library, #name))
#define NEED(call) \
    if ((call) != 0) { \
        printf("%s: refused\n", #call); \
        return 1; \
    }

int main(int count, char **given)
{
    void *const library = count == 11 ? OPEN(given[1]) : NULL;
    if (library == NULL) {
        printf("no library\n");
        return 1;
    }
    const unsigned parameter = (unsigned)atoi(given[3]), load = (unsigned)atoi(given[5]);
    const double kappa = atof(given[4]), force = atof(given[6]), length = atof(given[10]);
    const int first = atoi(given[7]), outputs = atoi(given[8]), steps = atoi(given[9]);
    unsigned out[64];
    double value[64];
    for (int k = 0; k < outputs; ++k) {
        out[k] = (unsigned)(first + k);
    }
#if VERSION == 2
    const fmi2Component it = CALL(fmi2Instantiate)("one", fmi2CoSimulation, given[2], "", NULL, 0, 0);
    NEED(it == NULL)
    NEED(CALL(fmi2SetReal)(it, &parameter, 1, &kappa))
    NEED(CALL(fmi2SetupExperiment)(it, 0, 0, 0, 0, 0))
    NEED(CALL(fmi2EnterInitializationMode)(it))
    NEED(CALL(fmi2SetReal)(it, &load, 1, &force))
    NEED(CALL(fmi2ExitInitializationMode)(it))
#else
    const fmi3Instance it =
        CALL(fmi3InstantiateCoSimulation)("one", given[2], "", 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
    NEED(it == NULL)
    NEED(CALL(fmi3SetFloat64)(it, &parameter, 1, &kappa, 1))
    NEED(CALL(fmi3EnterInitializationMode)(it, 0, 0, 0, 0, 0))
    NEED(CALL(fmi3SetFloat64)(it, &load, 1, &force, 1))
    NEED(CALL(fmi3ExitInitializationMode)(it))
#endif
    for (int k = 0; k < steps; ++k) {
#if VERSION == 2
        NEED(CALL(fmi2DoStep)(it, k * length, length, 1))
        NEED(CALL(fmi2GetReal)(it, out, (size_t)outputs, value))
#else
        fmi3Boolean event, end, early;
        fmi3Float64 last;
        NEED(CALL(fmi3DoStep)(it, k * length, length, 1, &event, &end, &early, &last))
        NEED(CALL(fmi3GetFloat64)(it, out, (size_t)outputs, value, (size_t)outputs))
#endif
        for (int j = 0; j < outputs; ++j) {
            printf("%.17g%c", value[j], j + 1 < outputs ? ' ' : '\n');
        }
    }
#if VERSION == 2
    CALL(fmi2FreeInstance)(it);
#else
    CALL(fmi3FreeInstance)(it);
#endif
    return 0;
}
