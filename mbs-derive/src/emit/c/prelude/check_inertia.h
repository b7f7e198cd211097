#ifndef MBS_CHECK_INERTIA
#define MBS_CHECK_INERTIA
/* Whether a symmetric matrix, xx, yy, zz, xy, xz, yz, has no negative principal moment, or is the inertia of a body.
   Source: Smith, Eigenvalues of a symmetric 3 x 3 matrix, Communications of the ACM 4:4, 1961. */
MBS_FN int mbs_require_inertia(int condition, MBS_TEXT const char *name, const mbs_real *entries,
                               MBS_TEXT const char **quantity, mbs_real *value)
{
    mbs_real unit = MBS_C(0.0);
    for (int i = 0; i < 6; i++) {
        if (!mbs_is_finite(entries[i])) {
            return mbs_refused(MBS_FINITE, name, entries[i], quantity, value);
        }
        unit = mbs_larger(unit, mbs_abs(entries[i]));
    }
    if (unit == MBS_C(0.0)) {
        return 0;
    }
    const mbs_real xx = entries[0] / unit;
    const mbs_real yy = entries[1] / unit;
    const mbs_real zz = entries[2] / unit;
    const mbs_real xy = entries[3] / unit;
    const mbs_real xz = entries[4] / unit;
    const mbs_real yz = entries[5] / unit;
    const mbs_real mean = (xx + yy + zz) * MBS_C(1.0 / 3.0);
    const mbs_real a = xx - mean;
    const mbs_real b = yy - mean;
    const mbs_real c = zz - mean;
    const mbs_real squares = a * a + b * b + c * c + MBS_C(2.0) * (xy * xy + xz * xz + yz * yz);
    const mbs_real spread = mbs_sqrt(squares * MBS_C(1.0 / 6.0));
    const mbs_real scale = spread == MBS_C(0.0) ? MBS_C(1.0) : spread;
    const mbs_real determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    const mbs_real cosine = determinant / (scale * scale * scale) * MBS_C(0.5);
    const mbs_real one = MBS_C(1.0);
    const mbs_real angle = mbs_acos(cosine < -one ? -one : one < cosine ? one : cosine) * MBS_C(1.0 / 3.0);
    const mbs_real greatest = mean + MBS_C(2.0) * spread * MBS_CALL(cos)(angle);
    const mbs_real least = mean + MBS_C(2.0) * spread * MBS_CALL(cos)(angle + MBS_C(2.0943951023931953));
    const mbs_real middle = MBS_C(3.0) * mean - greatest - least;
    const mbs_real size = mbs_larger(mbs_abs(least), mbs_larger(mbs_abs(middle), mbs_abs(greatest)));
    if (least < MBS_C(-1e-3) * size) {
        return mbs_refused(condition, name, least * unit, quantity, value);
    }
    if (condition == MBS_INERTIA_OF_A_BODY && least + middle < greatest * MBS_C(1.0 - 1e-3)) {
        return mbs_refused(condition, name, (greatest - least - middle) * unit, quantity, value);
    }
    return 0;
}
#endif /* MBS_CHECK_INERTIA */

