/*
 * An instance of a mechanism behind the functions of FMI: its variables. Behind it come jacobian.h, constraints.h,
 * integration.h and states.h.
 *
 * Included once, by fmi2.c or fmi3.c, behind the definition of `mbs_fmu_logger`. What depends on the mechanism is in
 * model.h. Nothing is static but functions, so that there may be any number of instances, each in one piece of memory.
 */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

enum {
    N = MBS_COORDINATES,
    M = MBS_INPUTS,
    S = 3 * MBS_SIGNALS, /* value, rate, acceleration of each */
    P = MBS_PARAMETERS,
    Y = MBS_OUTPUTS,
    K = MBS_ROWS,
    C = MBS_COMPARISONS,
    Z = MBS_SWITCHES,
    ORDERS = 3 /* derivatives of inputs that are taken */
};

/* Value references: kinds of variables, one behind the other. */
enum {
    VR_TIME,
    VR_Q,
    VR_QD = VR_Q + N,
    VR_DER_Q = VR_QD + N,
    VR_DER_QD = VR_DER_Q + N,
    VR_U = VR_DER_QD + N,
    VR_S = VR_U + M,
    VR_P = VR_S + S,
    VR_Y = VR_P + P,
    VR_ENERGY = VR_Y + Y, /* kinetic, potential, their sum */
    VR_LAMBDA = VR_ENERGY + 3,
    VR_RESIDUAL = VR_LAMBDA + K,
    VR_SWITCH = VR_RESIDUAL + K,
    VR_END = VR_SWITCH + Z
};

/* The values of both standards' statuses. */
enum { GOOD, WARNED, DISCARDED, FAILED };

enum { INSTANTIATED = 1, INITIALIZATION = 2, EVENT = 4, CONTINUOUS = 8, STEP = 16, TERMINATED = 32 };

/* What is kept in an FMU state: all that does not follow from the rest. */
typedef struct {
    double t;
    double q[N + 1];
    double qd[N + 1];
    double u[M + C + 1]; /* and which side of each comparison is less, as forward dynamics is told */
    double s[S + 1];
    double p[P + 1];
    double slopes[ORDERS][M + S + 1]; /* derivatives of inputs and signals by time, for the step to come */
    double step;                      /* what the integration would try next; 0 before the first */
    double tolerance;                 /* relative; absolute is a hundredth of it */
    int mode;
    int is_co_simulation;
    int has_slopes;
    int parameters_are_new; /* and have to be looked at before the mechanism moves */
} fmu_values;

enum {
    HAS_MODEL = 1,
    HAS_MOTION = 2,
    HAS_OUTPUTS = 4,
    HAS_ENERGIES = 8,
    HAS_RESIDUALS = 16,
    HAS_SWITCHES = 32,
    HAS_SLOPES = 64,
    HAS_SIDES = 128
};

typedef struct {
    fmu_values v;
    unsigned has; /* which of what follows belongs to the values */
    mbs_fmu_model self;
    double qdd[N + 1], lambda[K + 1], y[Y + 1], energies[3], residual[K + 1], z[Z + 1];
    double by_q[N * N + 1], by_qd[N * N + 1], by_u[N * M + 1], by_p[N * P + 1];
    double y_by_q[Y * N + 1], y_by_qd[Y * N + 1], y_by_u[Y * M + 1];
    char *name;
    int talks; /* debug logging is on */
    mbs_fmu_logger log;
    void *environment;
} fmu_instance;

/* Hands a message to the environment; each standard's own. */
static void fmu_deliver(const fmu_instance *a, int status, const char *category, const char *message);

/* Reports why a call does not do what it was asked to, and returns the status. */
static int fmu_refuse(const fmu_instance *a, int status, const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const char *category = status == FAILED      ? "logStatusError"
                           : status == DISCARDED ? "logStatusDiscard"
                                                 : "logStatusWarning";
    fmu_deliver(a, status, category, message);
    return status;
}

static const char *mode_name(int mode)
{
    switch (mode) {
    case INSTANTIATED: return "instantiated";
    case INITIALIZATION: return "initialization mode";
    case EVENT: return "event mode";
    case CONTINUOUS: return "continuous-time mode";
    case STEP: return "step mode";
    default: return "terminated";
    }
}

/* Whether a function may be called now; there is no instance to ask where it is null. */
static int is_out_of_place(const fmu_instance *a, const char *function, int modes)
{
    if (a == NULL) return 1;
    if (a->v.mode & modes) return 0;
    fmu_refuse(a, FAILED, "%s: not while the FMU is in this state: %s", function, mode_name(a->v.mode));
    return 1;
}

static int all_finite(const double *x, int n)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(x[i])) return 0;
    }
    return 1;
}

static void fmu_start(fmu_instance *a, int is_co_simulation)
{
    memset(&a->v, 0, sizeof a->v);
    memcpy(a->v.q, mbs_fmu_start_q, N * sizeof(double));
    memcpy(a->v.qd, mbs_fmu_start_qd, N * sizeof(double));
    memcpy(a->v.u, mbs_fmu_start_u, M * sizeof(double));
    memcpy(a->v.s, mbs_fmu_start_s, S * sizeof(double));
    memcpy(a->v.p, mbs_fmu_start_p, P * sizeof(double));
    a->v.t = MBS_START_TIME;
    a->v.tolerance = MBS_TOLERANCE;
    a->v.mode = INSTANTIATED;
    a->v.is_co_simulation = is_co_simulation;
    a->v.parameters_are_new = 1;
    a->has = 0;
}

/* A new instance, or null: where there is no memory, or the token is that of another FMU. */
static fmu_instance *fmu_created(
    const char *name, const char *token, mbs_fmu_logger log, void *environment, int talks, int is_co_simulation)
{
    fmu_instance *a = (fmu_instance *)calloc(1, sizeof(fmu_instance));
    if (a == NULL) return NULL;
    const char *called = name == NULL || name[0] == '\0' ? MBS_MODEL : name;
    a->log = log;
    a->environment = environment;
    a->talks = talks;
    a->name = (char *)calloc(strlen(called) + 1, 1);
    if (a->name == NULL) {
        free(a);
        return NULL;
    }
    memcpy(a->name, called, strlen(called));
    fmu_start(a, is_co_simulation);
    if (token == NULL || strcmp(token, MBS_TOKEN) != 0) {
        fmu_refuse(
            a, FAILED, "instantiate: the token is `%s`, that of this FMU is `%s`", token == NULL ? "" : token,
            MBS_TOKEN);
        free(a->name);
        free(a);
        return NULL;
    }
    return a;
}

static void fmu_destroyed(fmu_instance *a)
{
    if (a == NULL) return;
    free(a->name);
    free(a);
}

/* Tells forward dynamics what comparisons give at a state. */
static void fmu_told(const mbs_fmu_model *self, double t, const double *s, const double *q, const double *qd, double *u)
{
    double z[Z + 1];
    mbs_fmu_switches(self, t, s, q, qd, u, z);
    for (int i = 0; i < C; i++) u[M + i] = z[i] < 0.0 ? -1.0 : 1.0;
}

/* Computes what of the values is asked for and not known yet. Comparisons are made anew but between events. */
static void fmu_complete(fmu_instance *a, unsigned what)
{
    fmu_values *v = &a->v;
    if (!(a->has & HAS_MODEL)) a->self = mbs_fmu_model_of(v->p);
    if (v->mode != CONTINUOUS && !(a->has & HAS_SIDES)) fmu_told(&a->self, v->t, v->s, v->q, v->qd, v->u);
    a->has |= HAS_MODEL | HAS_SIDES;
    const unsigned missing = what & ~a->has;
    if (missing & HAS_MOTION) mbs_fmu_motion(&a->self, v->t, v->s, v->q, v->qd, v->u, a->qdd, a->lambda);
    if (missing & HAS_OUTPUTS) mbs_fmu_outputs(&a->self, v->t, v->s, v->q, v->qd, v->u, a->y);
    if (missing & HAS_ENERGIES) {
        mbs_fmu_energies(&a->self, v->t, v->s, v->q, v->qd, a->energies);
        a->energies[2] = a->energies[0] + a->energies[1];
    }
    if (missing & HAS_RESIDUALS) mbs_fmu_residuals(&a->self, v->t, v->s, v->q, v->qd, a->residual);
    if (missing & HAS_SWITCHES) mbs_fmu_switches(&a->self, v->t, v->s, v->q, v->qd, v->u, a->z);
    if (missing & HAS_SLOPES) {
        mbs_fmu_slopes(&a->self, v->t, v->s, v->q, v->qd, v->u, a->by_q, a->by_qd, a->by_u, a->by_p);
        mbs_fmu_output_slopes(&a->self, v->t, v->s, v->q, v->qd, v->u, a->y_by_q, a->y_by_qd, a->y_by_u);
    }
    a->has |= what;
}

/* Values have changed, but for parameters. */
static void fmu_moved(fmu_instance *a) { a->has &= HAS_MODEL; }

/* Whether the mechanism can have its parameters, which is looked at after they have changed. */
static int parameters_checked(fmu_instance *a, const char *function)
{
    if (!a->v.parameters_are_new) return GOOD;
    static const char *const must[] = {
        "",
        "must be finite",
        "must not be zero",
        "must not be negative",
        "must be positive",
        "must have no negative principal moment",
        "must have no principal moment greater than the sum of the other two",
    };
    const char *quantity = "";
    double value = 0.0;
    const int violation = mbs_fmu_violation(a->v.p, &quantity, &value);
    if (violation != 0)
        return fmu_refuse(a, FAILED, "%s: `%s` %s, it is %.17g", function, quantity, must[violation], value);
    a->v.parameters_are_new = 0;
    return GOOD;
}

static const char *fmu_kind(unsigned vr)
{
    return vr == VR_TIME      ? "the time"
           : vr < VR_DER_Q    ? "a state"
           : vr < VR_U        ? "a derivative of a state"
           : vr < VR_P        ? "an input"
           : vr < VR_Y        ? "a parameter"
           : vr < VR_ENERGY   ? "an output"
           : vr < VR_LAMBDA   ? "an energy"
           : vr < VR_RESIDUAL ? "a multiplier"
           : vr < VR_SWITCH   ? "a residual"
                              : "an event indicator";
}

static unsigned fmu_needed(unsigned vr)
{
    return vr < VR_DER_QD     ? 0u
           : vr < VR_U        ? HAS_MOTION
           : vr < VR_Y        ? 0u
           : vr < VR_ENERGY   ? HAS_OUTPUTS
           : vr < VR_LAMBDA   ? HAS_ENERGIES
           : vr < VR_RESIDUAL ? HAS_MOTION
           : vr < VR_SWITCH   ? HAS_RESIDUALS
                              : HAS_SWITCHES;
}

/* Where a variable is. */
static double *fmu_place(fmu_instance *a, unsigned vr)
{
    if (vr == VR_TIME) return &a->v.t;
    if (vr < VR_QD) return a->v.q + (vr - VR_Q);
    if (vr < VR_DER_Q) return a->v.qd + (vr - VR_QD);
    if (vr < VR_DER_QD) return a->v.qd + (vr - VR_DER_Q);
    if (vr < VR_U) return a->qdd + (vr - VR_DER_QD);
    if (vr < VR_S) return a->v.u + (vr - VR_U);
    if (vr < VR_P) return a->v.s + (vr - VR_S);
    if (vr < VR_Y) return a->v.p + (vr - VR_P);
    if (vr < VR_ENERGY) return a->y + (vr - VR_Y);
    if (vr < VR_LAMBDA) return a->energies + (vr - VR_ENERGY);
    if (vr < VR_RESIDUAL) return a->lambda + (vr - VR_LAMBDA);
    if (vr < VR_SWITCH) return a->residual + (vr - VR_RESIDUAL);
    return a->z + (vr - VR_SWITCH);
}

static int unknown_reference(const fmu_instance *a, const char *function, const unsigned *vr, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VR_END) {
            fmu_refuse(a, FAILED, "%s: there is no variable with the value reference %u", function, vr[i]);
            return 1;
        }
    }
    return 0;
}

static int read_values(fmu_instance *a, const char *function, const unsigned *vr, size_t n, double *value)
{
    if (n > 0 && (vr == NULL || value == NULL)) return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    if (unknown_reference(a, function, vr, n)) return FAILED;
    unsigned what = 0;
    for (size_t i = 0; i < n; i++) what |= fmu_needed(vr[i]);
    fmu_complete(a, what);
    int status = GOOD;
    for (size_t i = 0; i < n; i++) {
        value[i] = *fmu_place(a, vr[i]);
        if (status == GOOD && !isfinite(value[i])) {
            status = fmu_refuse(
                a, DISCARDED, "%s: variable %u, %s, is not finite at this state", function, vr[i], fmu_kind(vr[i]));
        }
    }
    return status;
}

/* In which modes variables of a kind may be set. */
static int fmu_settable(unsigned vr)
{
    if (vr >= VR_Q && vr < VR_DER_Q) return INSTANTIATED | INITIALIZATION;
    if (vr >= VR_U && vr < VR_P) return INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS | STEP;
    if (vr >= VR_P && vr < VR_Y) return INSTANTIATED | INITIALIZATION | EVENT | STEP;
    return 0;
}

/* Sets all of the values or none. */
static int write_values(fmu_instance *a, const char *function, const unsigned *vr, size_t n, const double *value)
{
    if (n > 0 && (vr == NULL || value == NULL)) return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    if (unknown_reference(a, function, vr, n)) return FAILED;
    for (size_t i = 0; i < n; i++) {
        if (!(fmu_settable(vr[i]) & a->v.mode)) {
            return fmu_refuse(
                a, FAILED, "%s: variable %u, %s, cannot be set in this state: %s", function, vr[i], fmu_kind(vr[i]),
                mode_name(a->v.mode));
        }
        if (!isfinite(value[i])) {
            return fmu_refuse(
                a, FAILED, "%s: variable %u, %s, must be finite, not %g", function, vr[i], fmu_kind(vr[i]), value[i]);
        }
    }
    for (size_t i = 0; i < n; i++) {
        *fmu_place(a, vr[i]) = value[i];
        if (vr[i] >= VR_P && vr[i] < VR_Y) {
            a->v.parameters_are_new = 1;
            a->has = 0;
        }
    }
    fmu_moved(a);
    return GOOD;
}

static int states_set(fmu_instance *a, const char *function, const double *x, size_t n)
{
    if (n != 2 * N || x == NULL)
        return fmu_refuse(a, FAILED, "%s: there are %d continuous states, not %u", function, 2 * N, (unsigned)n);
    if (!all_finite(x, 2 * N)) return fmu_refuse(a, DISCARDED, "%s: a state is not finite", function);
    memcpy(a->v.q, x, N * sizeof(double));
    memcpy(a->v.qd, x + N, N * sizeof(double));
    fmu_moved(a);
    return GOOD;
}

static int states_read(const fmu_instance *a, const char *function, double *x, size_t n)
{
    if (n != 2 * N || x == NULL)
        return fmu_refuse(a, FAILED, "%s: there are %d continuous states, not %u", function, 2 * N, (unsigned)n);
    memcpy(x, a->v.q, N * sizeof(double));
    memcpy(x + N, a->v.qd, N * sizeof(double));
    return GOOD;
}

static int derivatives_read(fmu_instance *a, const char *function, double *x, size_t n)
{
    if (n != 2 * N || x == NULL)
        return fmu_refuse(a, FAILED, "%s: there are %d continuous states, not %u", function, 2 * N, (unsigned)n);
    fmu_complete(a, HAS_MOTION);
    memcpy(x, a->v.qd, N * sizeof(double));
    memcpy(x + N, a->qdd, N * sizeof(double));
    if (!all_finite(a->qdd, N))
        return fmu_refuse(a, DISCARDED, "%s: accelerations are not finite at this state", function);
    return GOOD;
}

static int switches_read(fmu_instance *a, const char *function, double *z, size_t n)
{
    if (n != Z || (Z > 0 && z == NULL))
        return fmu_refuse(a, FAILED, "%s: there are %d event indicators, not %u", function, Z, (unsigned)n);
    fmu_complete(a, HAS_SWITCHES);
    for (int i = 0; i < Z; i++) z[i] = a->z[i];
    return GOOD;
}

static int time_set(fmu_instance *a, const char *function, double t)
{
    if (!isfinite(t)) return fmu_refuse(a, FAILED, "%s: the time must be finite, not %g", function, t);
    a->v.t = t;
    fmu_moved(a);
    return GOOD;
}
