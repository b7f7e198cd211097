/* The way back onto constraints. */

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
 * The least change d in the metric W = M + A^T A of scaled coordinates with A d = -r, by rows made orthogonal one
 * after the other, the longest first; rows that follow from others, or do not take part, are left out. The first one
 * that follows from others, or K, is `dependent`. Zero where the change cannot be found.
 */
static int least_change(
    const double *mass, const double *jacobian, const double *r, const int *takes_part, double *d, int *dependent)
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
    *dependent = 0;
    while (*dependent < K && done[*dependent]) ++*dependent;
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
    int dependent;
    for (int turn = 0; turn < 20; turn++) {
        mbs_fmu_constraints(self, t, s, q, qd, mass, jacobian, r, NULL);
        if (!least_change(mass, jacobian, r, mbs_fmu_is_holonomic, d, &dependent)) return 0;
        for (int i = 0; i < N; i++) q[i] += d[i];
        if (fmu_largest(d, N) <= 4.0 * DBL_EPSILON * (1.0 + fmu_largest(q, N))) break;
    }
    mbs_fmu_constraints(self, t, s, q, qd, mass, jacobian, r, NULL);
    for (int k = 0; k < K; k++) {
        if (mbs_fmu_is_holonomic[k] && !(fabs(r[k]) <= 1e-9)) return 0;
    }
    for (int turn = 0; turn < 2; turn++) {
        mbs_fmu_constraints(self, t, s, q, qd, mass, jacobian, NULL, r);
        if (!least_change(mass, jacobian, r, NULL, d, &dependent)) return 0;
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

/*
 * Refuses rows that depend on others: integrators of model exchange leave the constraints, by little, and there such
 * rows hold what they hold no more when all are closed. Co-simulation stays on them.
 */
static int fmu_independent(fmu_instance *a, const char *function)
{
    double mass[N * N + 1], jacobian[K * N + 1], r[K + 1], d[N + 1];
    int dependent = K;
    mbs_fmu_constraints(&a->self, a->v.t, a->v.s, a->v.q, a->v.qd, mass, jacobian, r, NULL);
    if (!least_change(mass, jacobian, r, NULL, d, &dependent) || dependent == K) return GOOD;
    return fmu_refuse(
        a, FAILED, "%s: constraint `%s` depends on the others: use co-simulation, or leave it out", function,
        mbs_fmu_rows[dependent]);
}

static int fmu_closed(fmu_instance *a, const char *function)
{
    fmu_complete(a, 0);
    double q[N + 1], qd[N + 1];
    memcpy(q, a->v.q, sizeof q);
    memcpy(qd, a->v.qd, sizeof qd);
    if (!fmu_projected(&a->self, a->v.t, a->v.s, q, qd))
        return fmu_refuse(a, FAILED, "%s: no state near this one satisfies the constraints", function);
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
