#ifndef MBS_SPLINE
#define MBS_SPLINE
/* A derivative of a piecewise polynomial: a row has its origin, then coefficients from the constant on. */
MBS_FN mbs_real mbs_spline(
    int count, MBS_TEXT const mbs_real *places, int columns, MBS_TEXT const mbs_real *rows, int order, mbs_real x)
{
    int first = 0;
    int last = count;
    while (first < last) {
        const int middle = first + (last - first) / 2;
        if (x < places[middle]) {
            last = middle;
        } else {
            first = middle + 1;
        }
    }
    MBS_TEXT const mbs_real *row = rows + first * columns;
    const mbs_real s = x - row[0];
    mbs_real sum = s * MBS_C(0.0);
    for (int power = columns - 2; power >= order; power--) {
        int factor = 1;
        for (int k = power + 1 - order; k <= power; k++) {
            factor *= k;
        }
        sum = (mbs_real)factor * row[1 + power] + s * sum;
    }
    return sum;
}
#endif /* MBS_SPLINE */

