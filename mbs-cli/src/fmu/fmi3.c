/*
 * FMI 3.0, model exchange and co-simulation. The types and functions that the standard's headers declare are declared
 * here, so that the sources compile alone. With FMI3_FUNCTION_PREFIX defined names begin with it, for static linking.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(
    fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean, fmi3Boolean, fmi3Boolean, fmi3Boolean *,
    fmi3Float64 *);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

#define MBS_PASTED(a, b) a##b
#define MBS_PASTE(a, b) MBS_PASTED(a, b)
#if defined FMI3_FUNCTION_PREFIX
#define FMI(name) MBS_PASTE(FMI3_FUNCTION_PREFIX, name)
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

typedef fmi3LogMessageCallback mbs_fmu_logger;
#include "instance.h"
#include "jacobian.h"
#include "constraints.h"
#include "integration.h"
#include "states.h"

static void fmu_deliver(const fmu_instance *a, int status, const char *category, const char *message)
{
    if (a->log != NULL) a->log(a->environment, (fmi3Status)status, category, message);
}

#define ANY (INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS | STEP | TERMINATED)
#define MOVING (EVENT | CONTINUOUS | STEP)
/* The instance behind a pointer, if the function may be called now. */
#define CALLED(name, modes) \
    fmu_instance *a = (fmu_instance *)c; \
    static const char function[] = name; \
    if (is_out_of_place(a, function, modes)) return fmi3Error

EXPORT(const char *, fmi3GetVersion)(void) { return "3.0"; }

EXPORT(fmi3Status, fmi3SetDebugLogging)(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    CALLED("fmi3SetDebugLogging", ANY);
    (void)function;
    (void)n;
    (void)categories;
    a->talks = on;
    return fmi3OK;
}

EXPORT(fmi3Instance, fmi3InstantiateModelExchange)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean talks,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void)resources;
    (void)visible;
    return fmu_created(name, token, log, environment, talks, 0);
}

EXPORT(fmi3Instance, fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean talks,
    fmi3Boolean event_mode, fmi3Boolean early, const fmi3ValueReference intermediate[], size_t n,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)resources;
    (void)visible;
    (void)event_mode; /* hasEventMode is false */
    (void)early;
    (void)intermediate;
    (void)n;
    (void)update;
    return fmu_created(name, token, log, environment, talks, 1);
}

EXPORT(fmi3Instance, fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean talks,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)talks;
    (void)update;
    (void)lock;
    (void)unlock;
    if (log != NULL) log(environment, fmi3Error, "logStatusError", "fmi3InstantiateScheduledExecution: not supported");
    return NULL;
}

EXPORT(void, fmi3FreeInstance)(fmi3Instance c) { fmu_destroyed((fmu_instance *)c); }

EXPORT(fmi3Status, fmi3EnterInitializationMode)(
    fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 start_time, fmi3Boolean has_stop,
    fmi3Float64 stop_time)
{
    CALLED("fmi3EnterInitializationMode", INSTANTIATED);
    if (has_stop && !(stop_time >= start_time))
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: the stop time lies before the start time", function);
    const fmu_values before = a->v;
    int status = parameters_checked(a, function);
    if (status == GOOD && has_tolerance) status = tolerance_set(a, function, tolerance);
    if (status == GOOD) status = time_set(a, function, start_time);
    if (status == GOOD) a->v.mode = INITIALIZATION;
    if (status != GOOD) a->v = before;
    return (fmi3Status)status;
}

EXPORT(fmi3Status, fmi3ExitInitializationMode)(fmi3Instance c)
{
    CALLED("fmi3ExitInitializationMode", INITIALIZATION);
    return (fmi3Status)fmu_initialized(a, function, a->v.is_co_simulation ? STEP : EVENT);
}

EXPORT(fmi3Status, fmi3EnterEventMode)(fmi3Instance c)
{
    CALLED("fmi3EnterEventMode", EVENT | CONTINUOUS);
    (void)function;
    return (fmi3Status)fmu_interrupted(a);
}

EXPORT(fmi3Status, fmi3Terminate)(fmi3Instance c)
{
    CALLED("fmi3Terminate", MOVING);
    (void)function;
    a->v.mode = TERMINATED;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3Reset)(fmi3Instance c)
{
    CALLED("fmi3Reset", ANY);
    (void)function;
    fmu_start(a, a->v.is_co_simulation);
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetFloat64)(
    fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[], size_t count)
{
    CALLED("fmi3GetFloat64", ANY);
    if (n != count)
        return (fmi3Status)fmu_refuse(
            a, FAILED, "%s: %u variables have not %u values", function, (unsigned)n, (unsigned)count);
    return (fmi3Status)read_values(a, function, vr, n, value);
}

EXPORT(fmi3Status, fmi3SetFloat64)(
    fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[], size_t count)
{
    CALLED("fmi3SetFloat64", ANY & ~TERMINATED);
    if (n != count)
        return (fmi3Status)fmu_refuse(
            a, FAILED, "%s: %u variables have not %u values", function, (unsigned)n, (unsigned)count);
    return (fmi3Status)write_values(a, function, vr, n, value);
}

/* Variables of other types: there are none. */
#define NONE(name, type) \
    EXPORT(fmi3Status, name)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type value, size_t count) \
    { \
        CALLED(#name, ANY); \
        (void)vr; \
        (void)value; \
        (void)count; \
        if (n == 0) return fmi3OK; \
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: all variables are Float64", function); \
    }
NONE(fmi3GetFloat32, fmi3Float32 *)
NONE(fmi3GetInt8, fmi3Int8 *)
NONE(fmi3GetUInt8, fmi3UInt8 *)
NONE(fmi3GetInt16, fmi3Int16 *)
NONE(fmi3GetUInt16, fmi3UInt16 *)
NONE(fmi3GetInt32, fmi3Int32 *)
NONE(fmi3GetUInt32, fmi3UInt32 *)
NONE(fmi3GetInt64, fmi3Int64 *)
NONE(fmi3GetUInt64, fmi3UInt64 *)
NONE(fmi3GetBoolean, fmi3Boolean *)
NONE(fmi3GetString, fmi3String *)
NONE(fmi3SetFloat32, const fmi3Float32 *)
NONE(fmi3SetInt8, const fmi3Int8 *)
NONE(fmi3SetUInt8, const fmi3UInt8 *)
NONE(fmi3SetInt16, const fmi3Int16 *)
NONE(fmi3SetUInt16, const fmi3UInt16 *)
NONE(fmi3SetInt32, const fmi3Int32 *)
NONE(fmi3SetUInt32, const fmi3UInt32 *)
NONE(fmi3SetInt64, const fmi3Int64 *)
NONE(fmi3SetUInt64, const fmi3UInt64 *)
NONE(fmi3SetBoolean, const fmi3Boolean *)
NONE(fmi3SetString, const fmi3String *)

#define NO_BINARY(name, sizes_type, type) \
    EXPORT(fmi3Status, name)( \
        fmi3Instance c, const fmi3ValueReference vr[], size_t n, sizes_type sizes, type value, size_t count) \
    { \
        CALLED(#name, ANY); \
        (void)vr; \
        (void)sizes; \
        (void)value; \
        (void)count; \
        if (n == 0) return fmi3OK; \
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: all variables are Float64", function); \
    }
NO_BINARY(fmi3GetBinary, size_t *, fmi3Binary *)
NO_BINARY(fmi3SetBinary, const size_t *, const fmi3Binary *)

/* Clocks: there are none, so that none can be meant. */
#define NO_CLOCK(name, ...) \
    EXPORT(fmi3Status, name)(fmi3Instance c, __VA_ARGS__) \
    { \
        CALLED(#name, ANY); \
        (void)vr; \
        (void)x; \
        if (n == 0) return fmi3OK; \
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: there are no clocks", function); \
    }
#define NO_INTERVAL(name, ...) \
    EXPORT(fmi3Status, name)(fmi3Instance c, __VA_ARGS__) \
    { \
        CALLED(#name, ANY); \
        (void)vr; \
        (void)x; \
        (void)y; \
        if (n == 0) return fmi3OK; \
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: there are no clocks", function); \
    }
#define NO_FRACTION(name, ...) \
    EXPORT(fmi3Status, name)(fmi3Instance c, __VA_ARGS__) \
    { \
        CALLED(#name, ANY); \
        (void)vr; \
        (void)x; \
        (void)y; \
        (void)z; \
        if (n == 0) return fmi3OK; \
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: there are no clocks", function); \
    }
NO_CLOCK(fmi3GetClock, const fmi3ValueReference vr[], size_t n, fmi3Clock x[])
NO_CLOCK(fmi3SetClock, const fmi3ValueReference vr[], size_t n, const fmi3Clock x[])
NO_INTERVAL(fmi3GetIntervalDecimal, const fmi3ValueReference vr[], size_t n, fmi3Float64 x[], fmi3IntervalQualifier y[])
NO_FRACTION(
    fmi3GetIntervalFraction, const fmi3ValueReference vr[], size_t n, fmi3UInt64 x[], fmi3UInt64 y[],
    fmi3IntervalQualifier z[])
NO_CLOCK(fmi3GetShiftDecimal, const fmi3ValueReference vr[], size_t n, fmi3Float64 x[])
NO_INTERVAL(fmi3GetShiftFraction, const fmi3ValueReference vr[], size_t n, fmi3UInt64 x[], fmi3UInt64 y[])
NO_CLOCK(fmi3SetIntervalDecimal, const fmi3ValueReference vr[], size_t n, const fmi3Float64 x[])
NO_INTERVAL(
    fmi3SetIntervalFraction, const fmi3ValueReference vr[], size_t n, const fmi3UInt64 x[], const fmi3UInt64 y[])
NO_CLOCK(fmi3SetShiftDecimal, const fmi3ValueReference vr[], size_t n, const fmi3Float64 x[])
NO_INTERVAL(fmi3SetShiftFraction, const fmi3ValueReference vr[], size_t n, const fmi3UInt64 x[], const fmi3UInt64 y[])

EXPORT(fmi3Status, fmi3ActivateModelPartition)(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    CALLED("fmi3ActivateModelPartition", ANY);
    (void)clock;
    (void)time;
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: there are no clocks", function);
}

/* Every variable that depends on others may depend on all that modelDescription.xml does not exclude. */
EXPORT(fmi3Status, fmi3GetNumberOfVariableDependencies)(fmi3Instance c, fmi3ValueReference vr, size_t *n)
{
    CALLED("fmi3GetNumberOfVariableDependencies", ANY);
    (void)vr;
    (void)n;
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: providesPerElementDependencies is false", function);
}

EXPORT(fmi3Status, fmi3GetVariableDependencies)(
    fmi3Instance c, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[],
    size_t element_of[], fmi3DependencyKind kinds[], size_t n)
{
    CALLED("fmi3GetVariableDependencies", ANY);
    (void)dependent;
    (void)elements;
    (void)independents;
    (void)element_of;
    (void)kinds;
    (void)n;
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: providesPerElementDependencies is false", function);
}

EXPORT(fmi3Status, fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    CALLED("fmi3GetFMUState", ANY);
    return (fmi3Status)state_saved(a, function, state);
}

EXPORT(fmi3Status, fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state)
{
    CALLED("fmi3SetFMUState", ANY);
    return (fmi3Status)state_restored(a, function, state);
}

EXPORT(fmi3Status, fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state)
{
    CALLED("fmi3FreeFMUState", ANY);
    (void)function;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    CALLED("fmi3SerializedFMUStateSize", ANY);
    if (state == NULL || size == NULL) return (fmi3Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    *size = SERIALIZED;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SerializeFMUState)(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    CALLED("fmi3SerializeFMUState", ANY);
    return (fmi3Status)state_serialized(a, function, state, bytes, size);
}

EXPORT(fmi3Status, fmi3DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    CALLED("fmi3DeserializeFMUState", ANY);
    return (fmi3Status)state_deserialized(a, function, bytes, size, state);
}

EXPORT(fmi3Status, fmi3GetDirectionalDerivative)(
    fmi3Instance c, const fmi3ValueReference unknowns[], size_t rows, const fmi3ValueReference knowns[], size_t columns,
    const fmi3Float64 seed[], size_t seeds, fmi3Float64 result[], size_t results)
{
    CALLED("fmi3GetDirectionalDerivative", INITIALIZATION | MOVING);
    if (seeds != columns || results != rows)
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: the numbers of values do not fit", function);
    return (fmi3Status)jacobian_product(a, function, 0, unknowns, rows, knowns, columns, seed, result);
}

EXPORT(fmi3Status, fmi3GetAdjointDerivative)(
    fmi3Instance c, const fmi3ValueReference unknowns[], size_t rows, const fmi3ValueReference knowns[], size_t columns,
    const fmi3Float64 seed[], size_t seeds, fmi3Float64 result[], size_t results)
{
    CALLED("fmi3GetAdjointDerivative", INITIALIZATION | MOVING);
    if (seeds != rows || results != columns)
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: the numbers of values do not fit", function);
    return (fmi3Status)jacobian_product(a, function, 1, unknowns, rows, knowns, columns, seed, result);
}

/* There are no structural parameters. */
EXPORT(fmi3Status, fmi3EnterConfigurationMode)(fmi3Instance c)
{
    CALLED("fmi3EnterConfigurationMode", ANY);
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: there are no structural parameters", function);
}

EXPORT(fmi3Status, fmi3ExitConfigurationMode)(fmi3Instance c)
{
    CALLED("fmi3ExitConfigurationMode", ANY);
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: there are no structural parameters", function);
}

EXPORT(fmi3Status, fmi3EvaluateDiscreteStates)(fmi3Instance c)
{
    CALLED("fmi3EvaluateDiscreteStates", INITIALIZATION | EVENT);
    (void)function;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3UpdateDiscreteStates)(
    fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
    fmi3Boolean *values_changed, fmi3Boolean *has_next, fmi3Float64 *next)
{
    CALLED("fmi3UpdateDiscreteStates", EVENT);
    if (again == NULL || terminate == NULL || nominals_changed == NULL || values_changed == NULL || has_next == NULL ||
        next == NULL) {
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    }
    int status = parameters_checked(a, function);
    int changed = 0;
    if (status == GOOD) status = brought_back(a, function, &changed);
    *again = *terminate = *nominals_changed = *has_next = false;
    *values_changed = changed != 0;
    *next = 0.0;
    return (fmi3Status)status;
}

/* Model exchange. */

EXPORT(fmi3Status, fmi3EnterContinuousTimeMode)(fmi3Instance c)
{
    CALLED("fmi3EnterContinuousTimeMode", EVENT);
    return (fmi3Status)fmu_continued(a, function);
}

EXPORT(fmi3Status, fmi3CompletedIntegratorStep)(
    fmi3Instance c, fmi3Boolean no_return, fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
{
    CALLED("fmi3CompletedIntegratorStep", CONTINUOUS);
    (void)no_return;
    if (enter_event_mode == NULL || terminate == NULL)
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    *enter_event_mode = has_drifted(a) != 0;
    *terminate = false;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3SetTime)(fmi3Instance c, fmi3Float64 time)
{
    CALLED("fmi3SetTime", EVENT | CONTINUOUS);
    return (fmi3Status)time_set(a, function, time);
}

EXPORT(fmi3Status, fmi3SetContinuousStates)(fmi3Instance c, const fmi3Float64 x[], size_t n)
{
    CALLED("fmi3SetContinuousStates", CONTINUOUS);
    return (fmi3Status)states_set(a, function, x, n);
}

EXPORT(fmi3Status, fmi3GetContinuousStateDerivatives)(fmi3Instance c, fmi3Float64 derivatives[], size_t n)
{
    CALLED("fmi3GetContinuousStateDerivatives", INITIALIZATION | EVENT | CONTINUOUS | TERMINATED);
    return (fmi3Status)derivatives_read(a, function, derivatives, n);
}

EXPORT(fmi3Status, fmi3GetEventIndicators)(fmi3Instance c, fmi3Float64 indicators[], size_t n)
{
    CALLED("fmi3GetEventIndicators", INITIALIZATION | EVENT | CONTINUOUS | TERMINATED);
    return (fmi3Status)switches_read(a, function, indicators, n);
}

EXPORT(fmi3Status, fmi3GetContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    CALLED("fmi3GetContinuousStates", INITIALIZATION | EVENT | CONTINUOUS | TERMINATED);
    return (fmi3Status)states_read(a, function, x, n);
}

EXPORT(fmi3Status, fmi3GetNominalsOfContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    CALLED("fmi3GetNominalsOfContinuousStates", ANY);
    const int status = states_read(a, function, x, n);
    for (size_t i = 0; status == GOOD && i < n; i++) x[i] = 1.0;
    return (fmi3Status)status;
}

EXPORT(fmi3Status, fmi3GetNumberOfEventIndicators)(fmi3Instance c, size_t *n)
{
    CALLED("fmi3GetNumberOfEventIndicators", ANY);
    if (n == NULL) return (fmi3Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    *n = Z;
    return fmi3OK;
}

EXPORT(fmi3Status, fmi3GetNumberOfContinuousStates)(fmi3Instance c, size_t *n)
{
    CALLED("fmi3GetNumberOfContinuousStates", ANY);
    if (n == NULL) return (fmi3Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    *n = 2 * N;
    return fmi3OK;
}

/* Co-simulation. */

EXPORT(fmi3Status, fmi3EnterStepMode)(fmi3Instance c)
{
    CALLED("fmi3EnterStepMode", ANY);
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: co-simulation has no event mode", function);
}

EXPORT(fmi3Status, fmi3GetOutputDerivatives)(
    fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int32 orders[], fmi3Float64 value[],
    size_t count)
{
    CALLED("fmi3GetOutputDerivatives", STEP | TERMINATED);
    (void)vr;
    (void)orders;
    (void)value;
    (void)count;
    if (n == 0) return fmi3OK;
    return (fmi3Status)fmu_refuse(a, FAILED, "%s: derivatives of outputs are not given", function);
}

EXPORT(fmi3Status, fmi3DoStep)(
    fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *terminate,
    fmi3Boolean *early, fmi3Float64 *last)
{
    CALLED("fmi3DoStep", STEP);
    (void)no_return;
    if (event == NULL || terminate == NULL || early == NULL || last == NULL)
        return (fmi3Status)fmu_refuse(a, FAILED, "%s: a null pointer", function);
    const int status = communication_step(a, function, t, h);
    *event = *terminate = *early = false;
    *last = a->v.t;
    return (fmi3Status)status;
}
