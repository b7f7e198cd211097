#ifndef MBS_SOLUTION
#define MBS_SOLUTION
/* q'', scaled, of the scaled right side. */
MBS_FN void mbs_motion(const mbs_system *s)
{
    const int n = s->n;
    const int r = s->rank;
    const int count = n - r;
    mbs_real *q = s->column;
    mbs_real *rest = s->rest;
    for (int p = 0; p < r; p++) {
        q[p] = s->target[s->rows[p]];
        for (int i = 0; i < p; i++) {
            q[p] = q[p] - s->basis[p * n + i] * q[i];
        }
    }
    for (int p = r; p-- > 0;) {
        for (int i = p + 1; i < r; i++) {
            q[p] = q[p] - s->basis[p * n + i] * q[i];
        }
        q[p] = q[p] * s->reciprocals[p];
    }
    for (int i = 0; i < n; i++) {
        rest[i] = s->force[s->columns[i]];
    }
    for (int p = 0; p < r; p++) {
        for (int i = 0; i < n; i++) {
            rest[i] = rest[i] - s->ordered[p * n + i] * q[p];
        }
    }
    for (int p = 0; p < r; p++) {
        for (int i = r; i < n; i++) {
            rest[i] = rest[i] - s->basis[p * n + i] * rest[p];
        }
    }
    for (int i = 0; i < count; i++) {
        q[r + i] = rest[r + i];
        for (int j = 0; j < i; j++) {
            q[r + i] = q[r + i] - s->inertia[i * n + j] * q[r + j];
        }
    }
    for (int i = count; i-- > 0;) {
        q[r + i] = q[r + i] * s->compliance[i];
        for (int j = i + 1; j < count; j++) {
            q[r + i] = q[r + i] - s->inertia[j * n + i] * q[r + j];
        }
    }
    for (int p = 0; p < r; p++) {
        for (int i = r; i < n; i++) {
            q[p] = q[p] - s->basis[p * n + i] * q[i];
        }
    }
    for (int i = 0; i < n; i++) {
        s->motion[s->columns[i]] = q[i];
    }
}

/* How large the terms of a row are, scaled: of its target and of A q'', and where the row is small in its vector, those
   of the others in it. */
MBS_FN mbs_real mbs_terms(const mbs_system *s, int row)
{
    mbs_real sum = MBS_C(0.0);
    for (int i = 0; i < s->n; i++) {
        sum = sum + mbs_abs(s->slopes[row * s->n + i]) * mbs_abs(s->motion[i]);
    }
    return s->sizes[row] + sum;
}

MBS_FN mbs_real mbs_size(const mbs_system *s, int row)
{
    mbs_real size = mbs_terms(s, row);
    if (!(mbs_largest(s->slopes + row * s->n, s->n) < MBS_C(1.0))) {
        return size;
    }
    for (int k = 0; k < s->k; k++) {
        if (k != row && s->vectors[k] == s->vectors[row]) {
            size = mbs_larger(size, mbs_scaled(mbs_terms(s, k), s->row_scales[k] - s->row_scales[row]));
        }
    }
    return size;
}

/* Whether the rows that depend on others ask for what those give, to rounding. */
MBS_FN int mbs_agrees(const mbs_system *s)
{
    const int n = s->n;
    const int r = s->rank;
    for (int k = r; k < s->k; k++) {
        mbs_real rest = s->target[s->rows[k]];
        mbs_real size = mbs_size(s, s->rows[k]);
        for (int p = 0; p < r; p++) {
            const mbs_real factor = s->basis[k * n + p];
            rest = rest - factor * s->target[s->rows[p]];
            size = size + mbs_abs(factor) * mbs_size(s, s->rows[p]);
        }
        mbs_real allowed = size * MBS_C(mbs_agreement());
        for (int i = r; i < n; i++) {
            allowed = allowed + mbs_abs(s->basis[k * n + i]) * mbs_abs(s->motion[s->columns[i]]);
        }
        if (!(mbs_abs(rest) < allowed) && !(rest == MBS_C(0.0))) {
            return 0;
        }
    }
    return 1;
}

/* Multipliers, scaled: of least norm where rows depend on others. */
MBS_FN void mbs_multipliers(const mbs_system *s)
{
    const int n = s->n;
    const int r = s->rank;
    const int rows = s->k;
    mbs_real *l = s->given;
    for (int p = 0; p < r; p++) {
        const int i = s->columns[p];
        l[p] = -s->force[i];
        for (int j = 0; j < n; j++) {
            l[p] = l[p] + s->mass[i * n + j] * s->motion[j];
        }
    }
    for (int p = 0; p < r; p++) {
        l[p] = l[p] * s->reciprocals[p];
        for (int i = p + 1; i < r; i++) {
            l[i] = l[i] - s->basis[p * n + i] * l[p];
        }
    }
    for (int p = r; p-- > 0;) {
        for (int k = p + 1; k < r; k++) {
            l[p] = l[p] - s->basis[k * n + p] * l[k];
        }
    }
    for (int k = r; k < rows; k++) {
        l[k] = MBS_C(0.0);
        for (int p = 0; p < r; p++) {
            l[k] = l[k] + s->basis[k * n + p] * l[p];
        }
        for (int i = r; i < k; i++) {
            l[k] = l[k] - s->gram[k * rows + i] * l[i];
        }
    }
    for (int k = rows; k-- > r;) {
        l[k] = l[k] / s->gram[k * rows + k];
        for (int i = k + 1; i < rows; i++) {
            l[k] = l[k] - s->gram[i * rows + k] * l[i];
        }
    }
    for (int p = 0; p < r; p++) {
        for (int k = r; k < rows; k++) {
            l[p] = l[p] - s->basis[k * n + p] * l[k];
        }
    }
    for (int k = 0; k < rows; k++) {
        s->multipliers[s->rows[k]] = l[k];
    }
}

MBS_FN void mbs_right_side(const mbs_system *s, int count, int column, const mbs_real *force, const mbs_real *target)
{
    for (int i = 0; i < s->n; i++) {
        s->force[i] = mbs_scaled(force[i * count + column], -s->column_scales[i] - s->mass_scale);
    }
    for (int k = 0; k < s->k; k++) {
        s->target[k] = mbs_scaled(target[k * count + column], -s->row_scales[k]);
    }
}

/* Of each row the greatest terms, scaled, that its targets may be the rest of, in the motion and in all columns. */
MBS_FN void mbs_greatest_sizes(
    const mbs_system *s, int count, const mbs_real *force, const mbs_real *target, const mbs_real *qdd,
    const mbs_real *scales)
{
    for (int k = 0; k < s->k; k++) {
        s->greatest[k] = MBS_C(0.0);
    }
    if (!qdd) {
        return;
    }
    for (int i = 0; i < s->n; i++) {
        s->motion[i] = mbs_scaled(qdd[i], s->column_scales[i]);
    }
    mbs_real fastest = mbs_largest(s->motion, s->n);
    for (int j = 0; j < count; j++) {
        const mbs_real scale = mbs_abs(scales[j]);
        mbs_right_side(s, count, j, force, target);
        mbs_motion(s);
        fastest = mbs_larger(fastest, mbs_largest(s->motion, s->n) * scale);
        for (int k = 0; k < s->k; k++) {
            s->greatest[k] = mbs_larger(s->greatest[k], mbs_abs(s->target[k]) * scale);
        }
    }
    for (int k = 0; k < s->k; k++) {
        if (MBS_C(0.0) < mbs_largest(s->slopes + k * s->n, s->n)) {
            s->greatest[k] = mbs_larger(s->greatest[k], fastest);
        }
    }
}

/* One column of accelerations and multipliers; 0 where rows contradict each other, or something is not finite. */
MBS_FN int mbs_solve_column(const mbs_system *s, mbs_real scale)
{
    mbs_motion(s);
    for (int k = 0; k < s->k; k++) {
        s->sizes[k] = mbs_abs(s->target[k]);
        if (s->rank < s->k && MBS_C(0.0) < scale) {
            s->sizes[k] = mbs_larger(s->sizes[k], s->greatest[k] / scale);
        }
    }
    if (!mbs_agrees(s)) {
        return 0;
    }
    mbs_multipliers(s);
    int is_finite = 1;
    for (int i = 0; i < s->n; i++) {
        s->motion[i] = mbs_scaled(s->motion[i], -s->column_scales[i]);
        is_finite = is_finite && mbs_is_finite(s->motion[i]);
    }
    for (int k = 0; k < s->k; k++) {
        s->multipliers[k] = mbs_scaled(s->multipliers[k], s->mass_scale - s->row_scales[k]);
        is_finite = is_finite && mbs_is_finite(s->multipliers[k]);
    }
    return is_finite;
}

/* Accelerations, and multipliers unless they are null, for `count` right sides; of a motion `qdd` of which they are
   derivatives by what is as large as `scales`, or of none where both are null. `s` has n, k and vectors. NaN where a
   motion that A leaves has no inertia, where rows contradict each other, and where something is not finite. */
MBS_FN void mbs_constrained(
    mbs_system *s, const mbs_real *m, const mbs_real *a, int count, const mbs_real *force, const mbs_real *target,
    const mbs_real *qdd, const mbs_real *scales, mbs_real *accelerations, mbs_real *multipliers, mbs_real *reals,
    int *ints, mbs_long *longs)
{
    int is_solved = mbs_system_of(s, m, a, reals, ints, longs);
    if (is_solved) {
        mbs_eliminate(s);
        mbs_reduce(s);
        is_solved = mbs_factorize_inertia(s);
    }
    for (int i = 0; qdd && i < s->n; i++) {
        is_solved = is_solved && mbs_is_finite(qdd[i]);
    }
    if (is_solved) {
        mbs_relate_redundant_rows(s);
        if (s->rank < s->k) {
            mbs_greatest_sizes(s, count, force, target, qdd, scales);
        }
    }
    for (int j = 0; j < count; j++) {
        int is_good = is_solved;
        if (is_solved) {
            mbs_right_side(s, count, j, force, target);
            is_good = mbs_solve_column(s, scales ? mbs_abs(scales[j]) : MBS_C(0.0));
        }
        for (int i = 0; i < s->n; i++) {
            accelerations[i * count + j] = is_good ? s->motion[i] : MBS_C(NAN);
        }
        for (int k = 0; multipliers && k < s->k; k++) {
            multipliers[k * count + j] = is_good ? s->multipliers[k] : MBS_C(NAN);
        }
    }
}

/* How large coordinates and speeds are by which accelerations are differentiated: the largest of one kind, one of kind
   0; 0 for inputs. */
MBS_FN void mbs_state_sizes(
    int n, int count, const int *kinds, const mbs_real *q, const mbs_real *qd, mbs_real *sizes)
{
    for (int column = 0; column < count; column++) {
        sizes[column] = MBS_C(0.0);
        if (column < n && kinds[column] == 0) {
            sizes[column] = MBS_C(1.0);
            continue;
        }
        const mbs_real *values = column < n ? q : qd;
        for (int i = 0; i < n && column < 2 * n; i++) {
            if (kinds[i] == kinds[column < n ? column : column - n]) {
                sizes[column] = mbs_larger(sizes[column], mbs_abs(values[i]));
            }
        }
    }
}
#endif /* MBS_SOLUTION */

