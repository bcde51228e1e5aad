/* fmi2.h: of FMI 2.0 (fmi-standard.org) what a model for co-simulation exports, in our own words. */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#ifdef __cplusplus
#define FMI2_LINKAGE extern "C"
#else
#define FMI2_LINKAGE
#endif
#if defined(_WIN32)
#define FMI2_EXPORT FMI2_LINKAGE __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT FMI2_LINKAGE __attribute__((visibility("default")))
#else
#define FMI2_EXPORT FMI2_LINKAGE
#endif

/* Names begin with FMI2_FUNCTION_PREFIX where several models are linked into one program. */
#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_JOINED(prefix, name) prefix##name
#define FMI2_NAMED(prefix, name) FMI2_JOINED(prefix, name)
#define FMI2(name) FMI2_NAMED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2(name) name
#endif

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

FMI2_EXPORT const char *FMI2(fmi2GetTypesPlatform)(void);
FMI2_EXPORT const char *FMI2(fmi2GetVersion)(void);
FMI2_EXPORT fmi2Status FMI2(fmi2SetDebugLogging)(fmi2Component, fmi2Boolean, size_t, const fmi2String[]);

FMI2_EXPORT fmi2Component FMI2(fmi2Instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                                const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
FMI2_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(fmi2SetupExperiment)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
FMI2_EXPORT fmi2Status FMI2(fmi2EnterInitializationMode)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(fmi2ExitInitializationMode)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(fmi2Terminate)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(fmi2Reset)(fmi2Component);

FMI2_EXPORT fmi2Status FMI2(fmi2GetReal)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
FMI2_EXPORT fmi2Status FMI2(fmi2GetBoolean)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Boolean[]);
FMI2_EXPORT fmi2Status FMI2(fmi2SetReal)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
FMI2_EXPORT fmi2Status FMI2(fmi2SetBoolean)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Boolean[]);

FMI2_EXPORT fmi2Status FMI2(fmi2GetFMUstate)(fmi2Component, fmi2FMUstate *);
FMI2_EXPORT fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component, fmi2FMUstate);
FMI2_EXPORT fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component, fmi2FMUstate *);
FMI2_EXPORT fmi2Status FMI2(fmi2SerializedFMUstateSize)(fmi2Component, fmi2FMUstate, size_t *);
FMI2_EXPORT fmi2Status FMI2(fmi2SerializeFMUstate)(fmi2Component, fmi2FMUstate, fmi2Byte[], size_t);
FMI2_EXPORT fmi2Status FMI2(fmi2DeSerializeFMUstate)(fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate *);

FMI2_EXPORT fmi2Status FMI2(fmi2DoStep)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
FMI2_EXPORT fmi2Status FMI2(fmi2GetRealStatus)(fmi2Component, const fmi2StatusKind, fmi2Real *);
FMI2_EXPORT fmi2Status FMI2(fmi2GetBooleanStatus)(fmi2Component, const fmi2StatusKind, fmi2Boolean *);

#endif
