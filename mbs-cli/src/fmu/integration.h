/* Integration, for co-simulation, and the modes around it. */

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
            for (int k = 0; k < 3; k++)
                is_given |= v->slopes[order][M + i + k] < 0.0 || v->slopes[order][M + i + k] > 0.0;
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
    const mbs_fmu_model *self, const fmu_values *v, double t, double h, const double *x, double k[7][2 * N + 1],
    double *end)
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
static int stepped_over(
    const mbs_fmu_model *self, fmu_values *v, double *t, double h, double *x, double *slopes, double *z)
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

/* Sides are compared at least at so many places of a communication step. */
enum { PLACES = 50 };

/*
 * The state after a share of a step from x, with the slope k[0] there, to `end`, with the slope k[6] there: coordinates
 * by Hermite's polynomial of degree 5, which has the values and both derivatives at the ends, velocities by its slope.
 */
static void fmu_between(double h, double share, const double *x, double k[7][2 * N + 1], const double *end, double *at)
{
    for (int i = 0; i < N; i++) {
        const double first = h * x[N + i], second = h * h * k[0][N + i];
        /* What the value and its derivatives gain over a parabola. */
        const double gain = end[i] - x[i] - first - second / 2.0;
        const double by_first = h * (end[N + i] - x[N + i]) - second;
        const double by_second = h * h * (k[6][N + i] - k[0][N + i]) / 2.0;
        const double cubic = 10.0 * gain - 4.0 * by_first + by_second;
        const double quartic = -15.0 * gain + 7.0 * by_first - 2.0 * by_second;
        const double quintic = 6.0 * gain - 3.0 * by_first + by_second;
        const double square = share * share;
        at[i] = x[i] + share * first + square * (second / 2.0 + share * (cubic + share * (quartic + share * quintic)));
        at[N + i] = x[N + i] + share * h * k[0][N + i] +
                    square * (3.0 * cubic + share * (4.0 * quartic + share * 5.0 * quintic)) / h;
    }
}

/*
 * Ends a step from x, with the sides z there, where the first condition changes, as far as `places` equal parts of it
 * tell; returns its length.
 */
static double fmu_shortened(
    const mbs_fmu_model *self, const fmu_values *v, double t, double h, int places, double least, const double *x,
    const double *z, double k[7][2 * N + 1], double *end, double *z_end)
{
    double at[2 * N + 1];
    int place = 1;
    for (; place < places; place++) {
        const double share = (double)place / places;
        fmu_between(h, share, x, k, end, at);
        fmu_sides(self, v, t + share * h, at, z_end);
        if (!same_sides(z, z_end)) break;
    }
    double before = h * (place - 1) / places, behind = place < places ? h * place / places : h;
    if (behind < h) fmu_stepped(self, v, t, behind, x, k, end);
    fmu_sides(self, v, t + behind, end, z_end);
    if (same_sides(z, z_end)) return behind;
    const double near = fmax(least, 4.0 * DBL_EPSILON * h);
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
    fmu_sides(self, v, t + behind, end, z_end);
    return behind;
}

/* After so many events within a millionth of a communication step it is refused. */
enum { CROWD = 1000 };

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
    if (!all_finite(k[0], 2 * N))
        return fmu_refuse(a, DISCARDED, "%s: accelerations are not finite at t = %.17g", function, t);
    fmu_sides(self, v, t, x, z);
    double crowd_from = t;
    int crowded = 0;
    for (long step = 0; t < t_end; step++) {
        if (step == 1000000L)
            return fmu_refuse(
                a, DISCARDED,
                "%s: a million steps do not lead from t = %.17g to the end time, as of friction that jumps at rest",
                function, t);
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
            return fmu_refuse(
                a, DISCARDED, "%s: the step is too small at t = %.17g: the motion has no derivative there", function,
                t);
        }
        if (try_h >= h || factor < 1.0) h = try_h * fmin(5.0, factor);
        const int places = Z > 0 ? (int)ceil(PLACES * try_h / whole) : 1;
        const double made = fmu_shortened(self, v, t, try_h, places, least, x, z, k, end, z_end);
        const int is_event = !same_sides(z, z_end);
        t = made < try_h || !is_last ? t + made : t_end;
        if (is_event && t - crowd_from > 1e-6 * whole) {
            crowd_from = t;
            crowded = 0;
        }
        if (is_event && ++crowded == CROWD)
            return fmu_refuse(
                a, DISCARDED, "%s: a condition changes without end at t = %.17g, as of friction that jumps at rest",
                function, t);
#if MBS_ROWS > 0
        double u[M + C + 1], s[S + 1];
        inputs_after(v, t - v->t, u, s);
        if (!fmu_projected(self, t, s, end, end + N))
            return fmu_refuse(
                a, DISCARDED, "%s: no state near the motion's satisfies the constraints at t = %.17g", function, t);
        fmu_sides(self, v, t, end, z_end);
#endif
        if (is_event || K > 0) {
            for (int i = 0; i < C; i++) v->u[M + i] = z_end[i] < 0.0 ? -1.0 : 1.0;
            fmu_flow(self, v, t, end, k[6]);
        }
        if (!all_finite(k[6], 2 * N))
            return fmu_refuse(a, DISCARDED, "%s: accelerations are not finite at t = %.17g", function, t);
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
        return fmu_refuse(
            a, FAILED, "%s: a step needs a finite time and a positive length, not %g and %g", function, t, h);
    }
    /* Environments add up their steps or multiply them. */
    const double rounding = 1e-9 * h + 16.0 * DBL_EPSILON * fabs(t);
    if (!(fabs(t - a->v.t) <= rounding)) {
        return fmu_refuse(
            a, FAILED, "%s: the communication point is t = %.17g, the FMU is at t = %.17g", function, t, a->v.t);
    }
    const fmu_values before = a->v;
    int changed;
    int status = parameters_checked(a, function);
    /* Parameters and signals that have been set since the last step may have opened the constraints. */
    if (status == GOOD) status = brought_back(a, function, &changed);
    if (status == GOOD) status = fmu_integrated(a, function, t + h);
    if (status != GOOD) {
        a->v = before;
        fmu_moved(a);
    }
    return status;
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
        if (changed)
            status = fmu_refuse(
                a, WARNED,
                "%s: the first state does not satisfy the constraints; the motion starts from the nearest that does",
                function);
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
#if MBS_ROWS > 0
    if (fmu_independent(a, function) != GOOD) return FAILED;
#endif
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
    if (!isfinite(tolerance) || !(tolerance > 0.0))
        return fmu_refuse(a, FAILED, "%s: the tolerance must be positive, not %g", function, tolerance);
    /* With larger ones every step is good enough. */
    a->v.tolerance = fmin(fmax(tolerance, 1e-14), 1e-2);
    return GOOD;
}
