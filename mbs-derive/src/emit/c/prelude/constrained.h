#ifndef MBS_CONSTRAINED
#define MBS_CONSTRAINED
/* M q'' - A^T l = f, A q'' = c in a basis of the null space of A that is chosen at run time: the operations of
   mbs-runtime, dynamics/null_space.rs, which says why and where they come from. */

MBS_FN void mbs_swap(mbs_real *a, mbs_real *b)
{
    const mbs_real first = *a;
    *a = *b;
    *b = first;
}

MBS_FN void mbs_swap_ints(int *a, int *b)
{
    const int first = *a;
    *a = *b;
    *b = first;
}

/* The greatest |x|. */
MBS_FN mbs_real mbs_largest(const mbs_real *x, int count)
{
    mbs_real largest = MBS_C(0.0);
    for (int i = 0; i < count; i++) {
        largest = mbs_larger(largest, mbs_abs(x[i]));
    }
    return largest;
}

/* The square root of the rounding error, from above. */
MBS_FN mbs_real mbs_agreement(void)
{
    return sizeof(mbs_real) == 4 ? MBS_C(4.8828125e-4) : MBS_C(1.4901161193847656e-8);
}

/* A row of which no more than this is left depends on others. */
MBS_FN mbs_real mbs_least_slope(int small)
{
    const mbs_real least = mbs_agreement() * MBS_C(1e-2);
    return small == 0 ? least : mbs_larger(mbs_scaled(least, -small), MBS_C(16.0 * MBS_ROUNDING));
}

MBS_FN mbs_real *mbs_take(mbs_real **memory, int count)
{
    mbs_real *taken = *memory;
    *memory += count;
    return taken;
}

MBS_FN int *mbs_take_ints(int **memory, int count)
{
    int *taken = *memory;
    *memory += count;
    return taken;
}

MBS_FN mbs_long *mbs_take_longs(mbs_long **memory, int count)
{
    mbs_long *taken = *memory;
    *memory += count;
    return taken;
}

/* A system of M, of which the lower triangle is read, and A, in their scales; 0 where something is not finite. */
MBS_FN int mbs_system_of(
    mbs_system *s, const mbs_real *m, const mbs_real *a, mbs_real *reals, int *ints, mbs_long *longs)
{
    const int n = s->n;
    const int k = s->k;
    s->rank = 0;
    s->mass = mbs_take(&reals, n * n);
    s->ordered = mbs_take(&reals, n * n);
    s->inertia = mbs_take(&reals, n * n);
    s->slopes = mbs_take(&reals, k * n);
    s->basis = mbs_take(&reals, k * n);
    s->gram = mbs_take(&reals, k * k);
    s->compliance = mbs_take(&reals, n);
    s->column = mbs_take(&reals, n);
    s->weights = mbs_take(&reals, n);
    s->motion = mbs_take(&reals, n);
    s->force = mbs_take(&reals, n);
    s->rest = mbs_take(&reals, n);
    s->reciprocals = mbs_take(&reals, k);
    s->target = mbs_take(&reals, k);
    s->sizes = mbs_take(&reals, k);
    s->given = mbs_take(&reals, k);
    s->greatest = mbs_take(&reals, k);
    s->multipliers = mbs_take(&reals, k);
    s->column_scales = mbs_take_ints(&ints, n);
    s->taken = mbs_take_ints(&ints, n);
    s->columns = mbs_take_ints(&ints, n);
    s->before = mbs_take_ints(&ints, n);
    s->visited = mbs_take_ints(&ints, n);
    s->row_scales = mbs_take_ints(&ints, k);
    s->small = mbs_take_ints(&ints, k);
    s->rows = mbs_take_ints(&ints, k);
    s->exponents = mbs_take_longs(&longs, k * n);
    s->masses = mbs_take_longs(&longs, n);
    s->lengths = mbs_take_longs(&longs, n);
    s->distance = mbs_take_longs(&longs, n);
    s->v = mbs_take_longs(&longs, n);
    s->u = mbs_take_longs(&longs, k);
    s->bases = mbs_take_longs(&longs, k);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            if (!mbs_is_finite(m[i * n + j])) {
                return 0;
            }
        }
    }
    for (int i = 0; i < k * n; i++) {
        if (!mbs_is_finite(a[i])) {
            return 0;
        }
    }
    mbs_find_scales(s, m, a);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            const int scale = -s->column_scales[i] - s->column_scales[j] - s->mass_scale;
            s->mass[i * n + j] = mbs_scaled(m[i * n + j], scale);
            s->mass[j * n + i] = s->mass[i * n + j];
        }
        s->columns[i] = i;
    }
    for (int row = 0; row < k; row++) {
        for (int i = 0; i < n; i++) {
            s->basis[row * n + i] = mbs_scaled(a[row * n + i], -s->column_scales[i] - s->row_scales[row]);
            s->slopes[row * n + i] = s->basis[row * n + i];
        }
        s->rows[row] = row;
    }
    return 1;
}

/* By which power of two a pivot adds to other entries at most; 0 where it adds nothing. */
MBS_FN int mbs_growth(const mbs_system *s, int row, int column, int *growth)
{
    const int n = s->n;
    mbs_real along = MBS_C(0.0);
    mbs_real across = MBS_C(0.0);
    for (int i = s->rank; i < n; i++) {
        along = i == column ? along : mbs_larger(along, mbs_abs(s->basis[row * n + i]));
    }
    for (int k = s->rank; k < s->k; k++) {
        across = k == row ? across : mbs_larger(across, mbs_abs(s->basis[k * n + column]));
    }
    if (along == MBS_C(0.0) || across == MBS_C(0.0)) {
        return 0;
    }
    *growth = mbs_exponent(along) + mbs_exponent(across) - mbs_exponent(s->basis[row * n + column]);
    return 1;
}

/* The largest entry of the rows and columns that are left, the first of equal ones; entries that their rows have taken
   are as good while they are no less than half of it, of those the one that changes the others least. 0 where what is
   left is rounding. */
MBS_FN int mbs_pivot(const mbs_system *s, int *pivot_row, int *pivot_column)
{
    const int n = s->n;
    const int p = s->rank;
    mbs_real largest = MBS_C(0.0);
    *pivot_row = -1;
    for (int k = p; k < s->k; k++) {
        const mbs_real greatest = mbs_largest(s->basis + k * n + p, n - p);
        if (mbs_least_slope(s->small[s->rows[k]]) < greatest && largest < greatest) {
            largest = greatest;
            *pivot_row = k;
        }
    }
    if (*pivot_row < 0) {
        return 0;
    }
    *pivot_column = p;
    while (mbs_abs(s->basis[*pivot_row * n + *pivot_column]) < largest) {
        *pivot_column += 1;
    }
    const mbs_real enough = largest * MBS_C(0.5);
    int is_found = 0;
    int least = 0;
    for (int k = p; k < s->k; k++) {
        const mbs_real greatest = mbs_largest(s->basis + k * n + p, n - p);
        for (int i = p; i < n; i++) {
            const int is_taken = s->taken[s->columns[i]] == s->rows[k];
            if (!is_taken || !(mbs_least_slope(s->small[s->rows[k]]) < greatest) ||
                mbs_abs(s->basis[k * n + i]) < enough) {
                continue;
            }
            int growth = 0;
            const int grows = mbs_growth(s, k, i, &growth);
            if (!grows || !is_found || growth < least) {
                *pivot_row = k;
                *pivot_column = i;
                least = growth;
                is_found = 1;
            }
            if (!grows) {
                return 1;
            }
        }
    }
    return 1;
}

/* A = L U with complete pivoting, until what is left is rounding. */
MBS_FN void mbs_eliminate(mbs_system *s)
{
    const int n = s->n;
    int row = 0;
    int column = 0;
    while (s->rank < s->k && s->rank < n && mbs_pivot(s, &row, &column)) {
        const int p = s->rank;
        for (int i = 0; i < n; i++) {
            mbs_swap(s->basis + p * n + i, s->basis + row * n + i);
        }
        mbs_swap_ints(s->rows + p, s->rows + row);
        for (int k = 0; k < s->k; k++) {
            mbs_swap(s->basis + k * n + p, s->basis + k * n + column);
        }
        mbs_swap_ints(s->columns + p, s->columns + column);
        const mbs_real reciprocal = MBS_C(1.0) / s->basis[p * n + p];
        s->reciprocals[p] = reciprocal;
        for (int k = p + 1; k < s->k; k++) {
            const mbs_real factor = s->basis[k * n + p] * reciprocal;
            s->basis[k * n + p] = factor;
            for (int j = p + 1; j < n; j++) {
                s->basis[k * n + j] = s->basis[k * n + j] - factor * s->basis[p * n + j];
            }
        }
        s->rank = p + 1;
    }
}

/* W = U1^-1 U2, then S; how large the terms of its diagonal are. */
MBS_FN void mbs_reduce(mbs_system *s)
{
    const int n = s->n;
    const int r = s->rank;
    const mbs_real *w = s->basis;
    for (int p = r; p-- > 0;) {
        mbs_real *row = s->basis + p * n;
        for (int j = r; j < n; j++) {
            for (int i = p + 1; i < r; i++) {
                row[j] = row[j] - row[i] * w[i * n + j];
            }
            row[j] = row[j] * s->reciprocals[p];
        }
    }
    mbs_real *m = s->ordered;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            m[i * n + j] = s->mass[s->columns[i] * n + s->columns[j]];
        }
    }
    for (int j = 0; j < n - r; j++) {
        for (int p = 0; p < r; p++) {
            s->column[p] = m[(r + j) * n + p];
        }
        for (int i = 0; i < r; i++) {
            for (int p = 0; p < r; p++) {
                s->column[p] = s->column[p] - m[i * n + p] * w[i * n + r + j];
            }
        }
        for (int i = j; i < n - r; i++) {
            mbs_real entry = m[(r + i) * n + r + j];
            for (int p = 0; p < r; p++) {
                entry = entry - m[(r + i) * n + p] * w[p * n + r + j];
            }
            for (int p = 0; p < r; p++) {
                entry = entry - w[p * n + r + i] * s->column[p];
            }
            s->inertia[i * n + j] = entry;
        }
    }
    for (int i = 0; i < n - r; i++) {
        mbs_real sum = mbs_abs(m[(r + i) * n + r + i]);
        for (int p = 0; p < r; p++) {
            sum = sum + w[p * n + r + i] * w[p * n + r + i] * mbs_abs(m[p * n + p]);
        }
        s->weights[i] = MBS_C(1.0) / (sum * MBS_C(r + 1));
    }
}

/* Exchanges two independent coordinates, p <= i, in S, of which the first p are factorized. */
MBS_FN void mbs_exchange(mbs_system *s, int p, int i)
{
    const int n = s->n;
    const int r = s->rank;
    if (p == i) {
        return;
    }
    for (int other = 0; other < n - r; other++) {
        if (other < p) {
            mbs_swap(s->inertia + p * n + other, s->inertia + i * n + other);
        } else if (other != p && other != i) {
            mbs_swap(s->inertia + other * n + p, other < i ? s->inertia + i * n + other : s->inertia + other * n + i);
        }
    }
    mbs_swap(s->inertia + p * n + p, s->inertia + i * n + i);
    mbs_swap_ints(s->columns + r + p, s->columns + r + i);
    for (int k = 0; k < s->k; k++) {
        mbs_swap(s->basis + k * n + r + p, s->basis + k * n + r + i);
    }
    for (int k = 0; k < r; k++) {
        mbs_swap(s->ordered + k * n + r + p, s->ordered + k * n + r + i);
    }
    mbs_swap(s->weights + p, s->weights + i);
}

/* S = L D L^T; 0 where only rounding is left of a pivot. */
MBS_FN int mbs_factorize_inertia(mbs_system *s)
{
    const int n = s->n;
    const int count = n - s->rank;
    const mbs_real rounding = MBS_C(16.0 * n * MBS_ROUNDING);
    for (int p = 0; p < count; p++) {
        int pivot = p;
        mbs_real best = s->inertia[p * n + p] * s->weights[p];
        for (int i = p + 1; i < count; i++) {
            const mbs_real share = s->inertia[i * n + i] * s->weights[i];
            if (best < share) {
                pivot = i;
                best = share;
            }
        }
        if (!(rounding < best)) {
            return 0;
        }
        mbs_exchange(s, p, pivot);
        s->compliance[p] = MBS_C(1.0) / s->inertia[p * n + p];
        for (int i = p + 1; i < count; i++) {
            s->column[i] = s->inertia[i * n + p] * s->compliance[p];
        }
        for (int i = p + 1; i < count; i++) {
            const mbs_real u = s->inertia[i * n + p];
            for (int j = p + 1; j <= i; j++) {
                s->inertia[i * n + j] = s->inertia[i * n + j] - u * s->column[j];
            }
            s->inertia[i * n + p] = s->column[i];
        }
    }
    return 1;
}

/* G = L2 L1^-1 in the place of L2, the rows of L that are no pivots; 1 + G G^T, factorized. */
MBS_FN void mbs_relate_redundant_rows(mbs_system *s)
{
    const int n = s->n;
    const int r = s->rank;
    const int rows = s->k;
    for (int k = r; k < rows; k++) {
        for (int p = r; p-- > 0;) {
            for (int i = p + 1; i < r; i++) {
                s->basis[k * n + p] = s->basis[k * n + p] - s->basis[k * n + i] * s->basis[i * n + p];
            }
        }
    }
    for (int k = r; k < rows; k++) {
        for (int l = r; l <= k; l++) {
            mbs_real sum = k == l ? MBS_C(1.0) : MBS_C(0.0);
            for (int p = 0; p < r; p++) {
                sum = sum + s->basis[k * n + p] * s->basis[l * n + p];
            }
            for (int i = r; i < l; i++) {
                sum = sum - s->gram[k * rows + i] * s->gram[l * rows + i] * s->gram[i * rows + i];
            }
            s->gram[k * rows + l] = k == l ? sum : sum / s->gram[l * rows + l];
        }
    }
}
#endif /* MBS_CONSTRAINED */

