#ifndef MBS_LDLT
#define MBS_LDLT
/* M = L D L^T in place of the lower triangle of an n by n matrix, and 1/D. No pivoting: M is positive definite. */
MBS_FN void mbs_ldlt(int n, mbs_real *m, mbs_real *reciprocals)
{
    for (int k = 0; k < n; k++) {
        reciprocals[k] = MBS_C(1.0) / m[k * n + k];
        for (int i = k + 1; i < n; i++) {
            const mbs_real u = m[i * n + k];
            for (int j = k + 1; j <= i; j++) {
                /* Column k of L has replaced what was above row i. */
                const mbs_real l = j < i ? m[j * n + k] : u * reciprocals[k];
                m[i * n + j] = m[i * n + j] - u * l;
            }
            m[i * n + k] = u * reciprocals[k];
        }
    }
}

/* X of M X = B in place of B, rows of this many columns. */
MBS_FN void mbs_ldlt_solve(int n, int columns, const mbs_real *m, const mbs_real *reciprocals, mbs_real *b)
{
    for (int c = 0; c < columns; c++) {
        for (int k = 0; k < n; k++) {
            for (int i = k + 1; i < n; i++) {
                b[i * columns + c] = b[i * columns + c] - m[i * n + k] * b[k * columns + c];
            }
        }
        for (int i = n; i-- > 0;) {
            mbs_real x = b[i * columns + c] * reciprocals[i];
            for (int k = i + 1; k < n; k++) {
                x = x - m[k * n + i] * b[k * columns + c];
            }
            b[i * columns + c] = x;
        }
    }
}
#endif /* MBS_LDLT */

