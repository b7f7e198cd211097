/*
 * An instance of a mechanism behind the functions of FMI: variables, their derivatives, integration.
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

enum { HAS_MODEL = 1, HAS_MOTION = 2, HAS_OUTPUTS = 4, HAS_ENERGIES = 8, HAS_RESIDUALS = 16, HAS_SWITCHES = 32, HAS_SLOPES = 64, HAS_SIDES = 128 };

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
    const char *category = status == FAILED ? "logStatusError" : status == DISCARDED ? "logStatusDiscard" : "logStatusWarning";
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
        fmu_refuse(a, FAILED, "instantiate: the token is `%s`, that of this FMU is `%s`", token == NULL ? "" : token, MBS_TOKEN);
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

/* --- Evaluation --------------------------------------------------------------------------------------------------- */

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
static void fmu_moved(fmu_instance *a)
{
    a->has &= HAS_MODEL;
}

/* Whether the mechanism can have its parameters, which is looked at after they have changed. */
static int parameters_checked(fmu_instance *a, const char *function)
{
    if (!a->v.parameters_are_new) return GOOD;
    static const char *const must[] = {
        "", "must be finite", "must not be zero", "must not be negative", "must be positive", "must have no negative principal moment",
        "must have no principal moment greater than the sum of the other two",
    };
    const char *quantity = "";
    double value = 0.0;
    const int violation = mbs_fmu_violation(a->v.p, &quantity, &value);
    if (violation != 0) return fmu_refuse(a, FAILED, "%s: `%s` %s, it is %.17g", function, quantity, must[violation], value);
    a->v.parameters_are_new = 0;
    return GOOD;
}

static const char *fmu_kind(unsigned vr)
{
    return vr == VR_TIME        ? "the time"
           : vr < VR_DER_Q      ? "a state"
           : vr < VR_U          ? "a derivative of a state"
           : vr < VR_P          ? "an input"
           : vr < VR_Y          ? "a parameter"
           : vr < VR_ENERGY     ? "an output"
           : vr < VR_LAMBDA     ? "an energy"
           : vr < VR_RESIDUAL   ? "a multiplier"
           : vr < VR_SWITCH     ? "a residual"
                                : "an event indicator";
}

static unsigned fmu_needed(unsigned vr)
{
    return vr < VR_DER_QD       ? 0u
           : vr < VR_U          ? HAS_MOTION
           : vr < VR_Y          ? 0u
           : vr < VR_ENERGY     ? HAS_OUTPUTS
           : vr < VR_LAMBDA     ? HAS_ENERGIES
           : vr < VR_RESIDUAL   ? HAS_MOTION
           : vr < VR_SWITCH     ? HAS_RESIDUALS
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
            status = fmu_refuse(a, DISCARDED, "%s: variable %u, %s, is not finite at this state", function, vr[i], fmu_kind(vr[i]));
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
            return fmu_refuse(a, FAILED, "%s: variable %u, %s, cannot be set in this state: %s", function, vr[i], fmu_kind(vr[i]), mode_name(a->v.mode));
        }
        if (!isfinite(value[i])) {
            return fmu_refuse(a, FAILED, "%s: variable %u, %s, must be finite, not %g", function, vr[i], fmu_kind(vr[i]), value[i]);
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

/* --- States as one vector ------------------------------------------------------------------------------------------ */

static int states_set(fmu_instance *a, const char *function, const double *x, size_t n)
{
    if (n != 2 * N || x == NULL) return fmu_refuse(a, FAILED, "%s: there are %d continuous states, not %u", function, 2 * N, (unsigned)n);
    if (!all_finite(x, 2 * N)) return fmu_refuse(a, DISCARDED, "%s: a state is not finite", function);
    memcpy(a->v.q, x, N * sizeof(double));
    memcpy(a->v.qd, x + N, N * sizeof(double));
    fmu_moved(a);
    return GOOD;
}

static int states_read(const fmu_instance *a, const char *function, double *x, size_t n)
{
    if (n != 2 * N || x == NULL) return fmu_refuse(a, FAILED, "%s: there are %d continuous states, not %u", function, 2 * N, (unsigned)n);
    memcpy(x, a->v.q, N * sizeof(double));
    memcpy(x + N, a->v.qd, N * sizeof(double));
    return GOOD;
}

static int derivatives_read(fmu_instance *a, const char *function, double *x, size_t n)
{
    if (n != 2 * N || x == NULL) return fmu_refuse(a, FAILED, "%s: there are %d continuous states, not %u", function, 2 * N, (unsigned)n);
    fmu_complete(a, HAS_MOTION);
    memcpy(x, a->v.qd, N * sizeof(double));
    memcpy(x + N, a->qdd, N * sizeof(double));
    if (!all_finite(a->qdd, N)) return fmu_refuse(a, DISCARDED, "%s: accelerations are not finite at this state", function);
    return GOOD;
}

static int switches_read(fmu_instance *a, const char *function, double *z, size_t n)
{
    if (n != Z || (Z > 0 && z == NULL)) return fmu_refuse(a, FAILED, "%s: there are %d event indicators, not %u", function, Z, (unsigned)n);
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

/* --- Derivatives by direction -------------------------------------------------------------------------------------- */

static int is_unknown(unsigned vr)
{
    return (vr >= VR_Q && vr < VR_U) || (vr >= VR_Y && vr < VR_ENERGY);
}

/* Outputs are not differentiated by parameters, nothing by signals: the header has no functions that do. */
static int is_differentiable(unsigned unknown, unsigned known)
{
    if (known >= VR_P && known < VR_Y) return unknown < VR_U;
    return (known >= VR_Q && known < VR_DER_Q) || (known >= VR_U && known < VR_S);
}

/* The derivative of one variable by another. */
static double fmu_slope(const fmu_instance *a, unsigned unknown, unsigned known)
{
    if (unknown < VR_DER_Q) return unknown == known ? 1.0 : 0.0;
    if (unknown < VR_DER_QD) return unknown - VR_DER_Q == known - VR_QD ? 1.0 : 0.0;
    const int is_output = unknown >= VR_Y;
    const size_t row = is_output ? unknown - VR_Y : unknown - VR_DER_QD;
    if (known < VR_QD) return (is_output ? a->y_by_q : a->by_q)[row * N + (known - VR_Q)];
    if (known < VR_DER_Q) return (is_output ? a->y_by_qd : a->by_qd)[row * N + (known - VR_QD)];
    if (known < VR_S) return (is_output ? a->y_by_u : a->by_u)[row * M + (known - VR_U)];
    return a->by_p[row * P + (known - VR_P)];
}

/* The product of the Jacobian, or of its transpose, with a seed. */
static int jacobian_product(
    fmu_instance *a, const char *function, int transposed, const unsigned *unknowns, size_t rows, const unsigned *knowns, size_t columns,
    const double *seed, double *result)
{
    if ((rows > 0 && unknowns == NULL) || (columns > 0 && knowns == NULL) || seed == NULL || result == NULL) {
        return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    }
    if (unknown_reference(a, function, unknowns, rows) || unknown_reference(a, function, knowns, columns)) return FAILED;
    if (!all_finite(seed, (int)(transposed ? rows : columns))) return fmu_refuse(a, FAILED, "%s: a seed is not finite", function);
    for (size_t i = 0; i < rows; i++) {
        if (!is_unknown(unknowns[i])) return fmu_refuse(a, FAILED, "%s: variable %u, %s, is no unknown", function, unknowns[i], fmu_kind(unknowns[i]));
        for (size_t j = 0; j < columns; j++) {
            if (!is_differentiable(unknowns[i], knowns[j])) {
                return fmu_refuse(a, FAILED, "%s: there is no derivative of %s by %s (variables %u, %u)", function, fmu_kind(unknowns[i]), fmu_kind(knowns[j]), unknowns[i], knowns[j]);
            }
        }
    }
    fmu_complete(a, HAS_SLOPES);
    for (size_t i = 0; i < (transposed ? columns : rows); i++) result[i] = 0.0;
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            const double entry = fmu_slope(a, unknowns[i], knowns[j]);
            if (transposed) {
                result[j] += entry * seed[i];
            } else {
                result[i] += entry * seed[j];
            }
        }
    }
    if (!all_finite(result, (int)(transposed ? columns : rows))) return fmu_refuse(a, DISCARDED, "%s: a derivative is not finite at this state", function);
    return GOOD;
}

/* --- Constraints --------------------------------------------------------------------------------------------------- */
#if MBS_ROWS > 0

/* W = L D L^T in place of the lower triangle, and 1/D. */
static void fmu_factorized(double *w, double *reciprocal)
{
    for (int k = 0; k < N; k++) {
        for (int i = k; i < N; i++) {
            double sum = w[i * N + k];
            for (int j = 0; j < k; j++) sum -= w[i * N + j] * w[k * N + j] / reciprocal[j];
            if (i == k) {
                reciprocal[k] = 1.0 / sum;
            } else {
                w[i * N + k] = sum * reciprocal[k];
            }
        }
    }
}

/*
 * The least change d in the metric W = M + A^T A of scaled coordinates with A d = -r, by rows made orthogonal one after
 * the other, the longest first; rows that follow from others, or do not take part, are left out. Zero where it cannot be
 * found.
 */
static int least_change(const double *mass, const double *jacobian, const double *r, const int *takes_part, double *d)
{
    double scale[N + 1], w[N * N + 1], reciprocal[N + 1], rows[K * N + 1], target[K + 1], length[K + 1], e[N + 1];
    int done[K + 1];
    for (int i = 0; i < N; i++) {
        double square = mass[i * N + i];
        if (!(square > 0.0)) {
            square = 0.0;
            for (int k = 0; k < K; k++) square += jacobian[k * N + i] * jacobian[k * N + i];
        }
        scale[i] = square > 0.0 ? 1.0 / sqrt(square) : 1.0;
    }
    for (int k = 0; k < K; k++) {
        double square = 0.0;
        for (int i = 0; i < N; i++) {
            rows[k * N + i] = jacobian[k * N + i] * scale[i];
            square += rows[k * N + i] * rows[k * N + i];
        }
        const double unit = square > 0.0 ? 1.0 / sqrt(square) : 0.0;
        for (int i = 0; i < N; i++) rows[k * N + i] *= unit;
        target[k] = -r[k] * unit;
        done[k] = !(unit > 0.0) || (takes_part != NULL && !takes_part[k]);
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            double sum = mass[i * N + j] * scale[i] * scale[j];
            for (int k = 0; k < K; k++) sum += rows[k * N + i] * rows[k * N + j];
            w[i * N + j] = sum;
        }
        e[i] = 0.0;
    }
    fmu_factorized(w, reciprocal);
    for (int k = 0; k < K; k++) {
        double *row = rows + k * N; /* D^(-1/2) L^-1 of the row */
        length[k] = 0.0;
        for (int i = 0; i < N; i++) {
            for (int j = 0; j < i; j++) row[i] -= w[i * N + j] * row[j];
        }
        for (int i = 0; i < N; i++) {
            row[i] *= sqrt(reciprocal[i]);
            length[k] += row[i] * row[i];
        }
        length[k] = sqrt(length[k]);
    }
    for (int turn = 0; turn < K; turn++) {
        int longest = -1;
        double most = 0.0, size = 0.0;
        for (int k = 0; k < K; k++) {
            double square = 0.0;
            for (int i = 0; i < N; i++) square += rows[k * N + i] * rows[k * N + i];
            const double share = done[k] ? 0.0 : sqrt(square) / length[k];
            if (share > most) {
                longest = k;
                most = share;
                size = square;
            }
        }
        if (longest < 0 || most < 1e-10) break;
        done[longest] = 1;
        const double *row = rows + longest * N;
        const double amount = target[longest] / size;
        for (int i = 0; i < N; i++) e[i] += amount * row[i];
        for (int k = 0; k < K; k++) {
            if (done[k]) continue;
            double dot = 0.0;
            for (int i = 0; i < N; i++) dot += rows[k * N + i] * row[i];
            target[k] -= dot * amount;
            for (int i = 0; i < N; i++) rows[k * N + i] -= dot / size * row[i];
        }
    }
    for (int i = 0; i < N; i++) e[i] *= sqrt(reciprocal[i]);
    for (int i = N; i-- > 0;) {
        for (int j = i + 1; j < N; j++) e[i] -= w[j * N + i] * e[j];
    }
    for (int i = 0; i < N; i++) d[i] = e[i] * scale[i];
    return all_finite(d, N);
}

static double fmu_largest(const double *x, int n)
{
    double most = 0.0;
    for (int i = 0; i < n; i++) most = fabs(x[i]) > most || !isfinite(x[i]) ? fabs(x[i]) : most;
    return most;
}

/* Brings coordinates, then velocities, back onto the constraints; zero where they do not close. */
static int fmu_projected(const mbs_fmu_model *self, double t, const double *s, double *q, double *qd)
{
    double mass[N * N + 1], jacobian[K * N + 1], r[K + 1], d[N + 1];
    for (int turn = 0; turn < 20; turn++) {
        mbs_fmu_constraints(self, t, s, q, qd, mass, jacobian, r, NULL);
        if (!least_change(mass, jacobian, r, mbs_fmu_is_holonomic, d)) return 0;
        for (int i = 0; i < N; i++) q[i] += d[i];
        if (fmu_largest(d, N) <= 4.0 * DBL_EPSILON * (1.0 + fmu_largest(q, N))) break;
    }
    mbs_fmu_constraints(self, t, s, q, qd, mass, jacobian, r, NULL);
    for (int k = 0; k < K; k++) {
        if (mbs_fmu_is_holonomic[k] && !(fabs(r[k]) <= 1e-9)) return 0;
    }
    for (int turn = 0; turn < 2; turn++) {
        mbs_fmu_constraints(self, t, s, q, qd, mass, jacobian, NULL, r);
        if (!least_change(mass, jacobian, r, NULL, d)) return 0;
        for (int i = 0; i < N; i++) qd[i] += d[i];
    }
    return 1;
}

/* What is left of the constraints and of their rates. */
static double fmu_openness(fmu_instance *a)
{
    double mass[N * N + 1], jacobian[K * N + 1], r[K + 1], rates[K + 1];
    fmu_complete(a, 0);
    mbs_fmu_constraints(&a->self, a->v.t, a->v.s, a->v.q, a->v.qd, mass, jacobian, r, rates);
    return fmax(fmu_largest(r, K), fmu_largest(rates, K));
}

static int fmu_closed(fmu_instance *a, const char *function)
{
    fmu_complete(a, 0);
    double q[N + 1], qd[N + 1];
    memcpy(q, a->v.q, sizeof q);
    memcpy(qd, a->v.qd, sizeof qd);
    if (!fmu_projected(&a->self, a->v.t, a->v.s, q, qd)) return fmu_refuse(a, FAILED, "%s: no state near this one satisfies the constraints", function);
    memcpy(a->v.q, q, sizeof q);
    memcpy(a->v.qd, qd, sizeof qd);
    fmu_moved(a);
    return GOOD;
}
#endif

/* The constraints may stay open by this much before a state is projected. */
#define MBS_OPEN 1e-9

/* Whether the state has drifted off the constraints, so that it has to be projected. */
static int has_drifted(fmu_instance *a)
{
#if MBS_ROWS > 0
    return !(fmu_openness(a) <= MBS_OPEN);
#else
    (void)a;
    return 0;
#endif
}

/* Brings the state back onto the constraints where it has drifted; `changed` says whether. */
static int brought_back(fmu_instance *a, const char *function, int *changed)
{
    *changed = has_drifted(a);
#if MBS_ROWS > 0
    if (*changed) return fmu_closed(a, function);
#else
    (void)function;
#endif
    return GOOD;
}

/* --- Integration, for co-simulation -------------------------------------------------------------------------------- */

/*
 * Inputs and signals so long after the communication point. Inputs follow the derivatives that were given, or stay; a
 * signal of which no derivatives were given follows its own rate and acceleration.
 */
static void inputs_after(const fmu_values *v, double time, double *u, double *s)
{
    for (int i = 0; i < M + S; i++) {
        double value = i < M ? v->u[i] : v->s[i - M];
        double power = 1.0;
        for (int order = 0; v->has_slopes && order < ORDERS; order++) {
            power *= time / (order + 1);
            value += v->slopes[order][i] * power;
        }
        *(i < M ? u + i : s + (i - M)) = value;
    }
    for (int i = 0; i < C; i++) u[M + i] = v->u[M + i];
    for (int i = 0; i < S; i += 3) {
        int is_given = 0;
        for (int order = 0; v->has_slopes && order < ORDERS; order++) {
            for (int k = 0; k < 3; k++) is_given |= v->slopes[order][M + i + k] < 0.0 || v->slopes[order][M + i + k] > 0.0;
        }
        if (!is_given) {
            s[i] += (v->s[i + 1] + v->s[i + 2] * time / 2.0) * time;
            s[i + 1] += v->s[i + 2] * time;
        }
    }
}

/* The derivatives of the states x at the time t, of a step that begins with the values v. */
static void fmu_flow(const mbs_fmu_model *self, const fmu_values *v, double t, const double *x, double *dx)
{
    double u[M + C + 1], s[S + 1], lambda[K + 1];
    inputs_after(v, t - v->t, u, s);
    memcpy(dx, x + N, N * sizeof(double));
    mbs_fmu_motion(self, t, s, x, x + N, u, dx + N, lambda);
}

static void fmu_sides(const mbs_fmu_model *self, const fmu_values *v, double t, const double *x, double *z)
{
    double u[M + C + 1], s[S + 1];
    inputs_after(v, t - v->t, u, s);
    mbs_fmu_switches(self, t, s, x, x + N, u, z);
}

/*
 * One step from x, with the slope k[0] there, to `end`, with the slope k[6] there; returns the error in units of the
 * tolerance. J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, 1980, table 2 (RK5(4)7M).
 */
static double fmu_stepped(
    const mbs_fmu_model *self, const fmu_values *v, double t, double h, const double *x, double k[7][2 * N + 1], double *end)
{
    static const double nodes[7] = {0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0};
    static const double weights[7][6] = {
        {0.0},
        {1.0 / 5.0},
        {3.0 / 40.0, 9.0 / 40.0},
        {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
        {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
        {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
        {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0},
    };
    static const double errors[7] = {
        71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0,
    };
    for (int stage = 1; stage < 7; stage++) {
        for (int i = 0; i < 2 * N; i++) {
            double sum = 0.0;
            for (int j = 0; j < stage; j++) sum += weights[stage][j] * k[j][i];
            end[i] = x[i] + h * sum;
        }
        fmu_flow(self, v, t + nodes[stage] * h, end, k[stage]);
    }
    double sum = 0.0;
    for (int i = 0; i < 2 * N; i++) {
        double error = 0.0;
        for (int j = 0; j < 7; j++) error += errors[j] * k[j][i];
        const double size = v->tolerance * (0.01 + fmax(fabs(x[i]), fabs(end[i])));
        sum += (h * error / size) * (h * error / size);
    }
    return all_finite(end, 2 * N) && all_finite(k[6], 2 * N) ? sqrt(sum / (2 * N)) : HUGE_VAL;
}

static int same_sides(const double *before, const double *after)
{
    for (int i = 0; i < Z; i++) {
        if ((before[i] > 0.0) != (after[i] > 0.0)) return 0;
    }
    return 1;
}

/*
 * A short straight step over a change of conditions that steps do not reach, because the equations have no value behind
 * it: sqrt(x) of a branch that is taken for x > 0. Zero where no condition changes there.
 */
static int stepped_over(const mbs_fmu_model *self, fmu_values *v, double *t, double h, double *x, double *slopes, double *z)
{
    double end[2 * N + 1], z_end[Z + 1];
    for (int i = 0; i < 2 * N; i++) end[i] = x[i] + h * slopes[i];
    fmu_sides(self, v, *t + h, end, z_end);
    if (same_sides(z, z_end)) return 0;
    for (int i = 0; i < C; i++) v->u[M + i] = z_end[i] < 0.0 ? -1.0 : 1.0;
    fmu_flow(self, v, *t + h, end, slopes);
    if (!all_finite(slopes, 2 * N)) return 0;
    *t += h;
    memcpy(x, end, 2 * N * sizeof(double));
    memcpy(z, z_end, Z * sizeof(double));
    return 1;
}

/* Integrates from the values to the end time; nothing has changed where that does not succeed. */
static int fmu_integrated(fmu_instance *a, const char *function, double t_end)
{
    fmu_complete(a, 0);
    fmu_moved(a);
    const mbs_fmu_model *self = &a->self;
    fmu_values *v = &a->v;
    double x[2 * N + 1], end[2 * N + 1], k[7][2 * N + 1], z[Z + 1], z_end[Z + 1];
    memcpy(x, v->q, N * sizeof(double));
    memcpy(x + N, v->qd, N * sizeof(double));
    double t = v->t;
    const double whole = t_end - t;
    double h = v->step > 0.0 ? v->step : whole / 100.0;
    double least = 16.0 * DBL_EPSILON * fmax(fabs(t), fabs(t_end));
    fmu_flow(self, v, t, x, k[0]);
    if (!all_finite(k[0], 2 * N)) return fmu_refuse(a, DISCARDED, "%s: accelerations are not finite at t = %.17g", function, t);
    fmu_sides(self, v, t, x, z);
    for (long step = 0; t < t_end; step++) {
        if (step == 1000000L) return fmu_refuse(a, DISCARDED, "%s: a million steps do not reach the end time", function);
        /* The last step is no crumb. */
        const double left = t_end - t;
        const int is_last = h >= left * (1.0 - 1e-9);
        double try_h = is_last ? left : h > left / 2.0 ? left / 2.0 : h;
        const double error = fmu_stepped(self, v, t, try_h, x, k, end);
        const double factor = error > 0.0 ? 0.9 * pow(error, -0.2) : 5.0;
        if (!(error <= 1.0)) {
            h = try_h * fmax(0.2, fmin(0.9, factor));
            if (h > least) continue;
            if (stepped_over(self, v, &t, fmin(4.0 * least, left), x, k[0], z)) {
                h = whole / 100.0;
                continue;
            }
            return fmu_refuse(a, DISCARDED, "%s: the step is too small at t = %.17g: the motion has no derivative there", function, t);
        }
        if (try_h >= h || factor < 1.0) h = try_h * fmin(5.0, factor);
        double t_new = is_last ? t_end : t + try_h;
        fmu_sides(self, v, t_new, end, z_end);
        const int is_event = !same_sides(z, z_end);
        if (is_event) {
            /* The step ends where the first condition changes. */
            double before = 0.0, behind = try_h;
            const double near = fmax(least, 4.0 * DBL_EPSILON * try_h);
            while (behind - before > near) {
                const double middle = before + (behind - before) / 2.0;
                fmu_stepped(self, v, t, middle, x, k, end);
                fmu_sides(self, v, t + middle, end, z_end);
                if (same_sides(z, z_end)) {
                    before = middle;
                } else {
                    behind = middle;
                }
            }
            fmu_stepped(self, v, t, behind, x, k, end);
            if (behind < try_h) t_new = t + behind;
            fmu_sides(self, v, t_new, end, z_end);
        }
        t = t_new;
#if MBS_ROWS > 0
        double u[M + C + 1], s[S + 1];
        inputs_after(v, t - v->t, u, s);
        if (!fmu_projected(self, t, s, end, end + N)) return fmu_refuse(a, DISCARDED, "%s: no state near the motion's satisfies the constraints at t = %.17g", function, t);
        fmu_sides(self, v, t, end, z_end);
#endif
        if (is_event || K > 0) {
            for (int i = 0; i < C; i++) v->u[M + i] = z_end[i] < 0.0 ? -1.0 : 1.0;
            fmu_flow(self, v, t, end, k[6]);
            if (!all_finite(k[6], 2 * N)) return fmu_refuse(a, DISCARDED, "%s: accelerations are not finite at t = %.17g", function, t);
        }
        memcpy(x, end, 2 * N * sizeof(double));
        memcpy(k[0], k[6], 2 * N * sizeof(double));
        memcpy(z, z_end, Z * sizeof(double));
        least = 16.0 * DBL_EPSILON * fmax(fabs(t), fabs(t_end));
    }
    double u[M + C + 1], s[S + 1];
    inputs_after(v, t_end - v->t, u, s);
    memcpy(a->v.u, u, M * sizeof(double));
    memcpy(a->v.s, s, S * sizeof(double));
    memset(a->v.slopes, 0, sizeof a->v.slopes);
    a->v.has_slopes = 0;
    memcpy(a->v.q, x, N * sizeof(double));
    memcpy(a->v.qd, x + N, N * sizeof(double));
    a->v.step = h;
    a->v.t = t_end;
    fmu_moved(a);
    return GOOD;
}

/* A step of co-simulation. */
static int communication_step(fmu_instance *a, const char *function, double t, double h)
{
    if (!isfinite(t) || !isfinite(h) || !(h > 0.0)) {
        return fmu_refuse(a, FAILED, "%s: a step needs a finite time and a positive length, not %g and %g", function, t, h);
    }
    const double rounding = 1e-9 * (h + fabs(t));
    if (!(fabs(t - a->v.t) <= rounding)) {
        return fmu_refuse(a, FAILED, "%s: the communication point is t = %.17g, the FMU is at t = %.17g", function, t, a->v.t);
    }
    const int status = parameters_checked(a, function);
    return status == GOOD ? fmu_integrated(a, function, t + h) : status;
}

/* Leaves initialization, whichever way the mechanism is to move. */
static int fmu_initialized(fmu_instance *a, const char *function, int next)
{
    int status = parameters_checked(a, function);
    if (status != GOOD) return status;
    if (a->v.is_co_simulation) {
        int changed = 0;
        status = brought_back(a, function, &changed);
        if (status != GOOD) return status;
        if (changed) status = fmu_refuse(a, WARNED, "%s: the first state does not satisfy the constraints; the motion starts from the nearest that does", function);
    }
    a->v.mode = next;
    return status;
}

/* Events have been dealt with: conditions stay as they are now. */
static int fmu_continued(fmu_instance *a, const char *function)
{
    const int status = parameters_checked(a, function);
    if (status != GOOD) return status;
    fmu_complete(a, 0);
    a->v.mode = CONTINUOUS;
    return GOOD;
}

/* Events are dealt with: conditions are looked at. */
static int fmu_interrupted(fmu_instance *a)
{
    a->v.mode = EVENT;
    fmu_moved(a);
    return GOOD;
}

static int tolerance_set(fmu_instance *a, const char *function, double tolerance)
{
    if (!isfinite(tolerance) || !(tolerance > 0.0)) return fmu_refuse(a, FAILED, "%s: the tolerance must be positive, not %g", function, tolerance);
    a->v.tolerance = fmax(tolerance, 1e-14);
    return GOOD;
}

/* --- FMU states ---------------------------------------------------------------------------------------------------- */

static int state_saved(const fmu_instance *a, const char *function, void **state)
{
    if (state == NULL) return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    if (*state == NULL) *state = malloc(sizeof(fmu_values));
    if (*state == NULL) return fmu_refuse(a, FAILED, "%s: no memory", function);
    memcpy(*state, &a->v, sizeof(fmu_values));
    return GOOD;
}

static int state_restored(fmu_instance *a, const char *function, const void *state)
{
    if (state == NULL) return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    memcpy(&a->v, state, sizeof(fmu_values));
    a->has = 0;
    return GOOD;
}

/* Serialized are the token and the values. */
enum { SERIALIZED = sizeof(MBS_TOKEN) + sizeof(fmu_values) };

static int state_serialized(const fmu_instance *a, const char *function, const void *state, void *bytes, size_t size)
{
    if (state == NULL || bytes == NULL) return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    if (size < SERIALIZED) return fmu_refuse(a, FAILED, "%s: %u bytes are too few", function, (unsigned)size);
    memcpy(bytes, MBS_TOKEN, sizeof(MBS_TOKEN));
    memcpy((char *)bytes + sizeof(MBS_TOKEN), state, sizeof(fmu_values));
    return GOOD;
}

/* Bytes that are none of this FMU's states are refused. */
static int state_deserialized(const fmu_instance *a, const char *function, const void *bytes, size_t size, void **state)
{
    if (bytes == NULL || state == NULL) return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    if (size != SERIALIZED || memcmp(bytes, MBS_TOKEN, sizeof(MBS_TOKEN)) != 0) {
        return fmu_refuse(a, FAILED, "%s: these bytes are no state of this FMU", function);
    }
    fmu_values v;
    memcpy(&v, (const char *)bytes + sizeof(MBS_TOKEN), sizeof(fmu_values));
    const int finite = isfinite(v.t) && all_finite(v.q, N) && all_finite(v.qd, N) && all_finite(v.u, M) && all_finite(v.s, S)
                       && all_finite(v.p, P) && all_finite(v.slopes[0], ORDERS * (M + S + 1)) && isfinite(v.step) && isfinite(v.tolerance);
    const int is_mode = v.mode == INSTANTIATED || v.mode == INITIALIZATION || v.mode == EVENT || v.mode == CONTINUOUS || v.mode == STEP || v.mode == TERMINATED;
    if (!finite || !is_mode || v.is_co_simulation != a->v.is_co_simulation) {
        return fmu_refuse(a, FAILED, "%s: these bytes are no state of this FMU", function);
    }
    v.parameters_are_new = 1;
    if (*state == NULL) *state = malloc(sizeof(fmu_values));
    if (*state == NULL) return fmu_refuse(a, FAILED, "%s: no memory", function);
    memcpy(*state, &v, sizeof(fmu_values));
    return GOOD;
}
