/* Sine and cosine of the library, or from +, - and * alone, as mbs-runtime's `Scalar::sin_cos_all` computes them, which
   says where they come from: the same bits everywhere, errors below 0.85 ulp. Of float it is always the library. */
#ifdef MBS_LIBRARY_TRIGONOMETRY
MBS_FN mbs_real mbs_sin(mbs_real x) { return MBS_CALL(sin)(x); }
MBS_FN mbs_real mbs_cos(mbs_real x) { return MBS_CALL(cos)(x); }
MBS_FN void mbs_sin_cos(mbs_real x, mbs_real *sine, mbs_real *cosine)
{
    *sine = mbs_sin(x);
    *cosine = mbs_cos(x);
}
#else
/* Up to 1e5: x = k pi/2 + y - e, with pi/2 in three parts; the summand rounds to an integer, whose last bits those of
   `shifted` are: an odd one swaps, the next one changes signs. */
#define MBS_REACH 1e5
MBS_FN void mbs_sin_cos_near(mbs_real x, mbs_real *sine, mbs_real *cosine)
{
    const mbs_real shifted = x * 0.6366197723675814 + 6755399441055744.0;
    const mbs_real k = shifted - 6755399441055744.0;
    const mbs_real r = x - k * 1.5707963267341256;
    const mbs_real w = k * 6.077100506303966e-11;
    const mbs_real h = r - w;
    const mbs_real t = k * 2.0222662487959506e-21 - ((r - h) - w);
    const mbs_real y = h - t;
    const mbs_real e = t - (h - y);
    const mbs_real z = y * y;
    const mbs_real z2 = z * z;
    const mbs_real p = ((-0.1666666666666663 + z * 0.00833333333332184) +
                        z2 * (-0.00019841269829358541 + z * 2.7557313538526334e-6)) +
                       (z2 * z2) * (-2.5050734392422683e-8 + z * 1.5895433544930663e-10);
    const mbs_real q = ((0.041666666666666595 + z * -0.001388888888887334) +
                        z2 * (2.4801587288999616e-5 + z * -2.755731421606095e-7)) +
                       (z2 * z2) * (2.087570523233725e-9 + z * -1.1358739381498488e-11);
    const mbs_real halved = 0.5 * z;
    const mbs_real one = 1.0 - halved;
    const mbs_bits s = mbs_to_bits(y - (e * one - (z * y) * p));
    const mbs_bits c = mbs_to_bits(one + (((1.0 - one) - halved) + ((z * z) * q + y * e)));
    const mbs_bits n = mbs_to_bits(shifted);
    const mbs_bits swapped = (s ^ c) & (0 - (n & 1));
    *sine = mbs_from_bits(s ^ swapped ^ ((n & 2) << 62));
    *cosine = mbs_from_bits(c ^ swapped ^ (((n + 1) & 2) << 62));
}

MBS_FN void mbs_sin_cos(mbs_real x, mbs_real *sine, mbs_real *cosine)
{
    if (mbs_abs(x) <= MBS_REACH) {
        mbs_sin_cos_near(x, sine, cosine);
    } else {
        *sine = sin(x);
        *cosine = cos(x);
    }
}

MBS_FN mbs_real mbs_sin(mbs_real x)
{
    mbs_real sine, cosine;
    mbs_sin_cos(x, &sine, &cosine);
    return sine;
}

MBS_FN mbs_real mbs_cos(mbs_real x)
{
    mbs_real sine, cosine;
    mbs_sin_cos(x, &sine, &cosine);
    return cosine;
}
#endif
#endif /* MBS_PRELUDE */
