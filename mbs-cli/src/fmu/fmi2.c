/*
 * FMI 2.0, model exchange and co-simulation. The types and functions that the standard's headers declare are declared
 * here, so that the sources compile alone. With FMI2_FUNCTION_PREFIX defined names begin with it, for static linking.
 */
#include <stddef.h>

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

#define fmi2True 1
#define fmi2False 0

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#define MBS_PASTED(a, b) a##b
#define MBS_PASTE(a, b) MBS_PASTED(a, b)
#if defined FMI2_FUNCTION_PREFIX
#define FMI(name) MBS_PASTE(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif
#if defined _WIN32
#define EXPORT(type, name) __declspec(dllexport) type FMI(name)
#elif defined __GNUC__
#define EXPORT(type, name) __attribute__((visibility("default"))) type FMI(name)
#else
#define EXPORT(type, name) type FMI(name)
#endif

typedef fmi2CallbackLogger mbs_fmu_logger;
#include "instance.h"
#include "jacobian.h"
#include "constraints.h"
#include "integration.h"
#include "states.h"

static void fmu_deliver(const fmu_instance *a, int status, const char *category, const char *message)
{
    if (a->log != NULL) a->log(a->environment, a->name, (fmi2Status)status, category, "%s", message);
}

#define ANY (INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS | STEP | TERMINATED)
#define MOVING (EVENT | CONTINUOUS | STEP)
/* The instance behind a component, if the function may be called now. */
#define CALLED(name, modes) \
    fmu_instance *a = (fmu_instance *)c; \
    static const char function[] = name; \
    if (is_out_of_place(a, function, modes)) return fmi2Error

EXPORT(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
EXPORT(const char *, fmi2GetVersion)(void) { return "2.0"; }

EXPORT(fmi2Status, fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    CALLED("fmi2SetDebugLogging", ANY);
    (void)function;
    (void)n;
    (void)categories;
    a->talks = on;
    return fmi2OK;
}

EXPORT(fmi2Component, fmi2Instantiate)(
    fmi2String name, fmi2Type type, fmi2String token, fmi2String resources, const fmi2CallbackFunctions *callbacks,
    fmi2Boolean visible, fmi2Boolean talks)
{
    (void)resources;
    (void)visible;
    if (callbacks == NULL || (type != fmi2ModelExchange && type != fmi2CoSimulation)) return NULL;
    return fmu_created(
        name, token, callbacks->logger, callbacks->componentEnvironment, talks, type == fmi2CoSimulation);
}

EXPORT(void, fmi2FreeInstance)(fmi2Component c) { fmu_destroyed((fmu_instance *)c); }

EXPORT(fmi2Status, fmi2SetupExperiment)(
    fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start_time, fmi2Boolean has_stop,
    fmi2Real stop_time)
{
    CALLED("fmi2SetupExperiment", INSTANTIATED);
    if (has_stop && !(stop_time >= start_time))
        return (fmi2Status)fmu_refuse(a, FAILED, "%s: the stop time lies before the start time", function);
    const fmu_values before = a->v;
    int status = time_set(a, function, start_time);
    if (status == GOOD && has_tolerance) status = tolerance_set(a, function, tolerance);
    if (status != GOOD) a->v = before;
    return (fmi2Status)status;
}

EXPORT(fmi2Status, fmi2EnterInitializationMode)(fmi2Component c)
{
    CALLED("fmi2EnterInitializationMode", INSTANTIATED);
    const int status = parameters_checked(a, function);
    if (status == GOOD) a->v.mode = INITIALIZATION;
    return (fmi2Status)status;
}

EXPORT(fmi2Status, fmi2ExitInitializationMode)(fmi2Component c)
{
    CALLED("fmi2ExitInitializationMode", INITIALIZATION);
    return (fmi2Status)fmu_initialized(a, function, a->v.is_co_simulation ? STEP : EVENT);
}

EXPORT(fmi2Status, fmi2Terminate)(fmi2Component c)
{
    CALLED("fmi2Terminate", MOVING);
    (void)function;
    a->v.mode = TERMINATED;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2Reset)(fmi2Component c)
{
    CALLED("fmi2Reset", ANY);
    (void)function;
    fmu_start(a, a->v.is_co_simulation);
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    CALLED("fmi2GetReal", ANY);
    return (fmi2Status)read_values(a, function, vr, n, value);
}

EXPORT(fmi2Status, fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    CALLED("fmi2SetReal", ANY & ~TERMINATED);
    return (fmi2Status)write_values(a, function, vr, n, value);
}

/* Variables of other types: there are none. */
#define NONE(name, type) \
    EXPORT(fmi2Status, name)(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value) \
    { \
        CALLED(#name, ANY); \
        (void)vr; \
        (void)value; \
        if (n == 0) return fmi2OK; \
        return (fmi2Status)fmu_refuse(a, FAILED, "%s: all variables are Real", function); \
    }
NONE(fmi2GetInteger, fmi2Integer *)
NONE(fmi2GetBoolean, fmi2Boolean *)
NONE(fmi2GetString, fmi2String *)
NONE(fmi2SetInteger, const fmi2Integer *)
NONE(fmi2SetBoolean, const fmi2Boolean *)
NONE(fmi2SetString, const fmi2String *)

EXPORT(fmi2Status, fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    CALLED("fmi2GetFMUstate", ANY);
    return (fmi2Status)state_saved(a, function, state);
}

EXPORT(fmi2Status, fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    CALLED("fmi2SetFMUstate", ANY);
    return (fmi2Status)state_restored(a, function, state);
}

EXPORT(fmi2Status, fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    CALLED("fmi2FreeFMUstate", ANY);
    (void)function;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    CALLED("fmi2SerializedFMUstateSize", ANY);
    if (state == NULL || size == NULL) return (fmi2Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    *size = SERIALIZED;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    CALLED("fmi2SerializeFMUstate", ANY);
    return (fmi2Status)state_serialized(a, function, state, bytes, size);
}

EXPORT(fmi2Status, fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    CALLED("fmi2DeSerializeFMUstate", ANY);
    return (fmi2Status)state_deserialized(a, function, bytes, size, state);
}

EXPORT(fmi2Status, fmi2GetDirectionalDerivative)(
    fmi2Component c, const fmi2ValueReference unknowns[], size_t rows, const fmi2ValueReference knowns[],
    size_t columns, const fmi2Real seed[], fmi2Real result[])
{
    CALLED("fmi2GetDirectionalDerivative", INITIALIZATION | MOVING);
    return (fmi2Status)jacobian_product(a, function, 0, unknowns, rows, knowns, columns, seed, result);
}

/* Model exchange. */

EXPORT(fmi2Status, fmi2EnterEventMode)(fmi2Component c)
{
    CALLED("fmi2EnterEventMode", EVENT | CONTINUOUS);
    (void)function;
    return (fmi2Status)fmu_interrupted(a);
}

EXPORT(fmi2Status, fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info)
{
    CALLED("fmi2NewDiscreteStates", EVENT);
    if (info == NULL) return (fmi2Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    int status = parameters_checked(a, function);
    int changed = 0;
    if (status == GOOD) status = brought_back(a, function, &changed);
    memset(info, 0, sizeof *info);
    info->valuesOfContinuousStatesChanged = changed;
    return (fmi2Status)status;
}

EXPORT(fmi2Status, fmi2EnterContinuousTimeMode)(fmi2Component c)
{
    CALLED("fmi2EnterContinuousTimeMode", EVENT);
    return (fmi2Status)fmu_continued(a, function);
}

EXPORT(fmi2Status, fmi2CompletedIntegratorStep)(
    fmi2Component c, fmi2Boolean no_return, fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
{
    CALLED("fmi2CompletedIntegratorStep", CONTINUOUS);
    (void)no_return;
    if (enter_event_mode == NULL || terminate == NULL)
        return (fmi2Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    *enter_event_mode = has_drifted(a);
    *terminate = fmi2False;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2SetTime)(fmi2Component c, fmi2Real time)
{
    CALLED("fmi2SetTime", EVENT | CONTINUOUS);
    return (fmi2Status)time_set(a, function, time);
}

EXPORT(fmi2Status, fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t n)
{
    CALLED("fmi2SetContinuousStates", CONTINUOUS);
    return (fmi2Status)states_set(a, function, x, n);
}

EXPORT(fmi2Status, fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t n)
{
    CALLED("fmi2GetDerivatives", INITIALIZATION | EVENT | CONTINUOUS | TERMINATED);
    return (fmi2Status)derivatives_read(a, function, derivatives, n);
}

EXPORT(fmi2Status, fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[], size_t n)
{
    CALLED("fmi2GetEventIndicators", INITIALIZATION | EVENT | CONTINUOUS | TERMINATED);
    return (fmi2Status)switches_read(a, function, indicators, n);
}

EXPORT(fmi2Status, fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t n)
{
    CALLED("fmi2GetContinuousStates", INITIALIZATION | EVENT | CONTINUOUS | TERMINATED);
    return (fmi2Status)states_read(a, function, x, n);
}

EXPORT(fmi2Status, fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real x[], size_t n)
{
    CALLED("fmi2GetNominalsOfContinuousStates", ANY);
    const int status = states_read(a, function, x, n);
    for (size_t i = 0; status == GOOD && i < n; i++) x[i] = 1.0;
    return (fmi2Status)status;
}

/* Co-simulation. */

EXPORT(fmi2Status, fmi2SetRealInputDerivatives)(
    fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], const fmi2Real value[])
{
    CALLED("fmi2SetRealInputDerivatives", INSTANTIATED | INITIALIZATION | STEP);
    if (n > 0 && (vr == NULL || order == NULL || value == NULL))
        return (fmi2Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    for (size_t i = 0; i < n; i++) {
        if (vr[i] < VR_U || vr[i] >= VR_P)
            return (fmi2Status)fmu_refuse(a, FAILED, "%s: variable %u is no input", function, vr[i]);
        if (order[i] < 1 || order[i] > ORDERS) {
            return (fmi2Status)fmu_refuse(
                a, FAILED, "%s: derivatives of orders 1 to %d are taken, not %d", function, ORDERS, order[i]);
        }
        if (!isfinite(value[i]))
            return (fmi2Status)fmu_refuse(a, FAILED, "%s: a derivative of variable %u is not finite", function, vr[i]);
    }
    for (size_t i = 0; i < n; i++) a->v.slopes[order[i] - 1][vr[i] - VR_U] = value[i];
    a->v.has_slopes |= n > 0;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetRealOutputDerivatives)(
    fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real value[])
{
    CALLED("fmi2GetRealOutputDerivatives", STEP | TERMINATED);
    (void)vr;
    (void)order;
    (void)value;
    if (n == 0) return fmi2OK;
    return (fmi2Status)fmu_refuse(a, FAILED, "%s: derivatives of outputs are not given", function);
}

EXPORT(fmi2Status, fmi2DoStep)(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_return)
{
    CALLED("fmi2DoStep", STEP);
    (void)no_return;
    return (fmi2Status)communication_step(a, function, t, h);
}

EXPORT(fmi2Status, fmi2CancelStep)(fmi2Component c)
{
    CALLED("fmi2CancelStep", STEP);
    return (fmi2Status)fmu_refuse(a, FAILED, "%s: steps are not asynchronous", function);
}

EXPORT(fmi2Status, fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind what, fmi2Real *value)
{
    CALLED("fmi2GetRealStatus", STEP | TERMINATED);
    if (what != fmi2LastSuccessfulTime || value == NULL)
        return (fmi2Status)fmu_refuse(a, DISCARDED, "%s: there is no such status", function);
    *value = a->v.t;
    return fmi2OK;
}

EXPORT(fmi2Status, fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind what, fmi2Boolean *value)
{
    CALLED("fmi2GetBooleanStatus", STEP | TERMINATED);
    if (what != fmi2Terminated || value == NULL)
        return (fmi2Status)fmu_refuse(a, DISCARDED, "%s: there is no such status", function);
    *value = fmi2False;
    return fmi2OK;
}

#define NO_STATUS(name, type) \
    EXPORT(fmi2Status, name)(fmi2Component c, const fmi2StatusKind what, type *value) \
    { \
        CALLED(#name, STEP | TERMINATED); \
        (void)what; \
        (void)value; \
        return (fmi2Status)fmu_refuse(a, DISCARDED, "%s: steps are not asynchronous", function); \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)
