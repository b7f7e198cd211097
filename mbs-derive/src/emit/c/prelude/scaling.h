#ifndef MBS_SCALING
#define MBS_SCALING
/* Powers of two that bring M and A to order one, and which coordinate each row of A is solved for: the operations of
   mbs-runtime, dynamics/scaling.rs, which says why and where they come from. */

/* Twice an exponent: of an entry that is zero; farther than any; of a coordinate without inertia; of what is rounding
   beside another entry of its vector. */
#define MBS_ABSENT (-((mbs_long)1 << 59))
#define MBS_UNREACHABLE ((mbs_long)1 << 58)
#define MBS_WEIGHTLESS ((mbs_long)1 << 32)
#define MBS_FADED 46

/* Numbers that n coordinates and k rows need in the memory of mbs_constrained. */
#define MBS_REALS(n, k) (3 * (n) * (n) + 2 * (n) * (k) + (k) * (k) + 6 * (n) + 6 * (k))
#define MBS_INTS(n, k) (5 * (n) + 3 * (k))
#define MBS_LONGS(n, k) ((n) * (k) + 4 * (n) + 2 * (k))

/* A system and its factors; matrices are arrays of rows. */
typedef struct mbs_system {
    int n, k, rank;
    /* The vector that each row is of. */
    const int *vectors;
    /* Exponents of the scales, of M, of coordinates, of rows, of rows beside their vectors; the row that takes each
       coordinate, or -1. */
    int mass_scale;
    int *column_scales, *row_scales, *small, *taken;
    /* Rows and columns in the order of the pivots. */
    int *rows, *columns;
    mbs_real *mass, *ordered, *slopes, *basis, *reciprocals, *inertia, *compliance, *gram;
    /* To work in. */
    mbs_real *column, *weights, *motion, *force, *target, *sizes, *greatest, *multipliers, *rest, *given;
    int *before, *visited;
    mbs_long *masses, *exponents, *lengths, *distance, *u, *v, *bases;
} mbs_system;

MBS_FN int mbs_is_present(mbs_long size) { return size > -MBS_UNREACHABLE; }

/* The exponent of a number that is not zero; of a subnormal one that of the smallest normal one. */
MBS_FN int mbs_exponent(mbs_real x)
{
    const int exponent = MBS_CALL(ilogb)(x);
    return exponent < -1022 ? -1022 : exponent;
}

MBS_FN mbs_long mbs_doubled(mbs_real x) { return x == MBS_C(0.0) ? MBS_ABSENT : (mbs_long)mbs_exponent(x); }

MBS_FN mbs_real mbs_power(int exponent) { return MBS_CALL(ldexp)(MBS_C(1.0), exponent); }

/* 2^exponent x, exactly where the result is a normal number. */
MBS_FN mbs_real mbs_scaled(mbs_real x, int exponent)
{
    while (exponent > 100 || exponent < -100) {
        const int part = exponent > 0 ? 100 : -100;
        x = x * mbs_power(part);
        exponent -= part;
    }
    return x * mbs_power(exponent);
}

/* Assigns one more row to a coordinate, along a shortest path. */
MBS_FN void mbs_assign(const mbs_system *s, int start)
{
    const int n = s->n;
    int row = start;
    int last = -1;
    mbs_long so_far = 0;
    for (int i = 0; i < n; i++) {
        s->distance[i] = MBS_UNREACHABLE;
        s->before[i] = -1;
        s->visited[i] = 0;
    }
    while (row >= 0) {
        int next = -1;
        mbs_long least = MBS_UNREACHABLE;
        for (int i = 0; i < n; i++) {
            if (s->visited[i]) {
                continue;
            }
            const mbs_long mass = mbs_is_present(s->masses[i]) ? s->masses[i] : -MBS_WEIGHTLESS;
            const mbs_long through = so_far - (2 * s->exponents[row * n + i] - mass) - s->u[row] - s->v[i];
            if (through < s->distance[i]) {
                s->distance[i] = through;
                s->before[i] = last;
            }
            if (s->distance[i] < least) {
                next = i;
                least = s->distance[i];
            }
        }
        if (next < 0) {
            return; /* the row depends on the others */
        }
        s->visited[next] = 1;
        so_far = least;
        last = next;
        row = s->taken[next];
    }
    for (int i = 0; i < n; i++) {
        if (s->visited[i] && i != last) {
            s->v[i] -= so_far - s->distance[i];
            if (s->taken[i] >= 0) {
                s->u[s->taken[i]] += so_far - s->distance[i];
            }
        }
    }
    s->u[start] += so_far;
    for (; s->before[last] >= 0; last = s->before[last]) {
        s->taken[last] = s->taken[s->before[last]];
    }
    s->taken[last] = start;
}

/* The row that takes each coordinate: the assignment of greatest product. */
MBS_FN void mbs_assignment(const mbs_system *s)
{
    const int n = s->n;
    for (int i = 0; i < n; i++) {
        s->taken[i] = -1;
        s->v[i] = 0;
    }
    for (int row = 0; row < s->k; row++) {
        int nearest = -1;
        mbs_long greatest = -MBS_UNREACHABLE;
        s->u[row] = 0;
        for (int i = 0; i < n; i++) {
            const mbs_long mass = mbs_is_present(s->masses[i]) ? s->masses[i] : -MBS_WEIGHTLESS;
            const mbs_long value = 2 * s->exponents[row * n + i] - mass + s->v[i];
            if (value > greatest) {
                nearest = i;
                greatest = value;
            }
        }
        if (nearest < 0) {
            continue;
        }
        s->u[row] = -greatest;
        if (s->taken[nearest] < 0) {
            s->taken[nearest] = row;
        } else {
            mbs_assign(s, row);
        }
    }
}

/* The least sizes, none below its own, at which no entry of a row is greater than the one taken. */
MBS_FN void mbs_raise(const mbs_system *s)
{
    const int n = s->n;
    for (int k = 0; k < s->k; k++) {
        s->bases[k] = MBS_ABSENT;
    }
    for (int i = 0; i < n; i++) {
        if (s->taken[i] >= 0) {
            s->bases[s->taken[i]] = s->lengths[i] - 2 * s->exponents[s->taken[i] * n + i];
        }
    }
    int changed = 1;
    for (int round = 0; round <= s->k && changed; round++) {
        changed = 0;
        for (int i = 0; i < n; i++) {
            const int row = s->taken[i];
            mbs_long bound = MBS_ABSENT;
            for (int k = 0; k < s->k; k++) {
                const mbs_long other = s->bases[k] + 2 * s->exponents[k * n + i];
                bound = other > bound ? other : bound;
            }
            if (row >= 0 && mbs_is_present(bound) && bound > s->lengths[i]) {
                s->lengths[i] = bound;
                s->bases[row] = bound - 2 * s->exponents[row * n + i];
                changed = 1;
            }
        }
    }
}

MBS_FN int mbs_is_massless(const mbs_system *s, int i) { return s->taken[i] >= 0 && !mbs_is_present(s->masses[i]); }

/* The greatest sizes of coordinates without inertia at which no entry of their rows is greater than the one taken. */
MBS_FN void mbs_relax(const mbs_system *s)
{
    int changed = 1;
    for (int round = 0; round <= s->k && changed; round++) {
        changed = 0;
        for (int i = 0; i < s->n; i++) {
            if (!mbs_is_massless(s, i)) {
                continue;
            }
            const mbs_long *row = s->exponents + s->taken[i] * s->n;
            int is_bounded = 0;
            mbs_long least = 0;
            for (int j = 0; j < s->n; j++) {
                if (j != i && mbs_is_present(row[j]) && mbs_is_present(s->lengths[j])) {
                    const mbs_long bound = 2 * (row[i] - row[j]) + s->lengths[j];
                    least = is_bounded && least < bound ? least : bound;
                    is_bounded = 1;
                }
            }
            if (is_bounded && (!mbs_is_present(s->lengths[i]) || least < s->lengths[i])) {
                s->lengths[i] = least;
                changed = 1;
            }
        }
    }
}

/* The least size of a coordinate at which it is in no row greater than what that has taken; 0 where it is in none. */
MBS_FN mbs_long mbs_lower_bound(const mbs_system *s, int coordinate)
{
    mbs_long greatest = MBS_ABSENT;
    for (int i = 0; i < s->n; i++) {
        if (i == coordinate || s->taken[i] < 0) {
            continue;
        }
        const mbs_long *row = s->exponents + s->taken[i] * s->n;
        const mbs_long size = s->lengths[i] + 2 * (row[coordinate] - row[i]);
        if (mbs_is_present(size) && size > greatest) {
            greatest = size;
        }
    }
    return mbs_is_present(greatest) ? greatest : 0;
}

/* Twice the exponents of the sizes of the coordinates' inertia. */
MBS_FN void mbs_lengths(const mbs_system *s)
{
    const int n = s->n;
    int are_present = 1;
    for (int i = 0; i < n; i++) {
        s->lengths[i] = s->masses[i];
        are_present = are_present && mbs_is_present(s->masses[i]);
    }
    mbs_raise(s);
    if (are_present) {
        return;
    }
    for (int i = 0; i < n; i++) {
        if (mbs_is_massless(s, i)) {
            s->lengths[i] = MBS_ABSENT;
        }
    }
    mbs_relax(s);
    /* Rows in which nothing has inertia. */
    for (int i = 0; i < n; i++) {
        if (mbs_is_massless(s, i) && !mbs_is_present(s->lengths[i])) {
            s->lengths[i] = mbs_lower_bound(s, i);
            mbs_relax(s);
        }
    }
    for (int i = 0; i < n; i++) {
        s->distance[i] = mbs_is_present(s->lengths[i]) ? s->lengths[i] : mbs_lower_bound(s, i);
    }
    for (int i = 0; i < n; i++) {
        s->lengths[i] = s->distance[i];
    }
}

/* The scale of a row, and how much less its own greatest entry is. */
MBS_FN void mbs_row_scale(const mbs_system *s, int row)
{
    mbs_long own = MBS_ABSENT;
    mbs_long moved = MBS_ABSENT;
    mbs_long all = MBS_ABSENT;
    for (int i = 0; i < s->n; i++) {
        const mbs_long scale = s->column_scales[i];
        const mbs_long slope = s->exponents[row * s->n + i];
        mbs_long greatest = MBS_ABSENT;
        for (int k = 0; k < s->k; k++) {
            const mbs_long other = s->exponents[k * s->n + i];
            greatest = s->vectors[k] == s->vectors[row] && other > greatest ? other : greatest;
        }
        greatest -= scale;
        all = greatest > all ? greatest : all;
        if (mbs_is_present(slope)) {
            own = slope - scale > own ? slope - scale : own;
            moved = greatest > moved ? greatest : moved;
        }
    }
    mbs_long size = mbs_is_present(moved) ? moved : all;
    size = mbs_is_present(size) ? size : 0;
    own = mbs_is_present(own) ? own : size - MBS_FADED;
    s->row_scales[row] = (int)size;
    s->small[row] = (int)(size - own);
}

/* The scales of a finite system. */
MBS_FN void mbs_find_scales(mbs_system *s, const mbs_real *m, const mbs_real *a)
{
    const int n = s->n;
    for (int i = 0; i < n; i++) {
        s->masses[i] = mbs_doubled(m[i * n + i]);
    }
    for (int k = 0; k < s->k * n; k++) {
        s->exponents[k] = mbs_doubled(a[k]);
    }
    /* Entries that are rounding beside another of their vector in the same coordinate say nothing. */
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < s->k; k++) {
            for (int l = 0; l < s->k; l++) {
                if (s->vectors[l] == s->vectors[k] && s->exponents[k * n + i] < s->exponents[l * n + i] - MBS_FADED) {
                    s->exponents[k * n + i] = MBS_ABSENT;
                }
            }
        }
    }
    mbs_assignment(s);
    mbs_lengths(s);
    mbs_long reference = 0;
    for (int i = n; i-- > 0;) {
        reference = mbs_is_present(s->masses[i]) ? s->masses[i] : reference;
    }
    for (int i = 0; i < n; i++) {
        const mbs_long twice = s->lengths[i] - reference;
        s->column_scales[i] = (int)((twice - (twice & 1)) / 2);
    }
    for (int k = 0; k < s->k; k++) {
        mbs_row_scale(s, k);
    }
    s->mass_scale = (int)reference;
}
#endif /* MBS_SCALING */

