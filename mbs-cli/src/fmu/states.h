/* FMU states. */

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
    if (((const fmu_values *)state)->is_co_simulation != a->v.is_co_simulation) {
        return fmu_refuse(a, FAILED, "%s: the state is of the other kind of FMU than this instance", function);
    }
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
    const int finite = isfinite(v.t) && all_finite(v.q, N) && all_finite(v.qd, N) && all_finite(v.u, M) &&
                       all_finite(v.s, S) && all_finite(v.p, P) && all_finite(v.slopes[0], ORDERS * (M + S + 1)) &&
                       isfinite(v.step) && isfinite(v.tolerance);
    const int is_mode = v.mode == INSTANTIATED || v.mode == INITIALIZATION || v.mode == EVENT || v.mode == CONTINUOUS ||
                        v.mode == STEP || v.mode == TERMINATED;
    if (!finite || !is_mode || v.is_co_simulation != a->v.is_co_simulation) {
        return fmu_refuse(a, FAILED, "%s: these bytes are no state of this FMU", function);
    }
    v.parameters_are_new = 1;
    if (*state == NULL) *state = malloc(sizeof(fmu_values));
    if (*state == NULL) return fmu_refuse(a, FAILED, "%s: no memory", function);
    memcpy(*state, &v, sizeof(fmu_values));
    return GOOD;
}
