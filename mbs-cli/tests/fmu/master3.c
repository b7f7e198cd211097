/* A master for the pendulum of the tests, FMI 3.0: what is right, and what is wrong and has to be refused. */
#include "fmi3.c"
#include "master.h"

static void logged(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment;
    (void)status;
    CHECK(strncmp(category, "logStatus", 9) == 0);
    heard(message);
}

static fmi3Instance stepping(void)
{
    return fmi3InstantiateCoSimulation("a", MBS_TOKEN, NULL, false, false, false, false, NULL, 0, NULL, logged, NULL);
}

static fmi3Instance exchanging(void)
{
    return fmi3InstantiateModelExchange("a", MBS_TOKEN, NULL, false, false, NULL, logged);
}

static double get(fmi3Instance a, fmi3ValueReference vr)
{
    double value = 0.0;
    CHECK(fmi3GetFloat64(a, &vr, 1, &value, 1) == fmi3OK);
    return value;
}

static fmi3Status set(fmi3Instance a, fmi3ValueReference vr, double value)
{
    return fmi3SetFloat64(a, &vr, 1, &value, 1);
}

static fmi3Status step(fmi3Instance a, double t, double h)
{
    bool event, terminate, early;
    double last;
    return fmi3DoStep(a, t, h, true, &event, &terminate, &early, &last);
}

static void begin(fmi3Instance a)
{
    CHECK(fmi3EnterInitializationMode(a, true, 1e-12, 0.0, false, 0.0) == fmi3OK);
    CHECK(fmi3ExitInitializationMode(a) == fmi3OK);
}

static void co_simulation(void)
{
    fmi3Instance a = stepping();
    CHECK(a != NULL && set(a, TAU, 2.0) == fmi3OK);
    begin(a);
    for (int i = 0; i < 30; i++) CHECK(step(a, i / 10.0, 0.1) == fmi3OK);
    double rate;
    const double theta = reference(3.0, 2.0, &rate);
    CHECK(near(get(a, THETA), theta, 1e-9) && near(get(a, RATE), rate, 1e-9) && near(get(a, TIME), 3.0, 1e-15));
    CHECK(near(get(a, HEIGHT), 2.0 * (1.0 - cos(theta)), 1e-9));
    CHECK(near(get(a, KINETIC), 6.0 * rate * rate, 1e-8) && near(get(a, POTENTIAL), 60.0 * (1.0 - cos(theta)), 1e-8));
    CHECK(near(get(a, DER_THETA), rate, 1e-9) && near(get(a, DER_RATE), acceleration(theta, rate, 2.0), 1e-8));
    CHECK(fmi3Terminate(a) == fmi3OK && step(a, 3.0, 0.1) == fmi3Error);
    /* As if nothing had been. */
    CHECK(fmi3Reset(a) == fmi3OK && get(a, THETA) == 1.0 && get(a, TAU) == 0.0 && get(a, TIME) == 0.0);
    begin(a);
    CHECK(step(a, 0.0, 0.5) == fmi3OK);
    CHECK(near(get(a, THETA), reference(0.5, 0.0, &rate), 1e-9));
    fmi3FreeInstance(a);
}

static void model_exchange(void)
{
    fmi3Instance a = exchanging();
    begin(a);
    bool again, terminate, nominals, changed, next;
    double time, x[2], dx[2], k[4][2];
    size_t n = 0;
    CHECK(
        fmi3UpdateDiscreteStates(a, &again, &terminate, &nominals, &changed, &next, &time) == fmi3OK && !again &&
        !changed);
    CHECK(fmi3EnterContinuousTimeMode(a) == fmi3OK);
    CHECK(fmi3GetNumberOfContinuousStates(a, &n) == fmi3OK && n == 2);
    CHECK(fmi3GetNumberOfEventIndicators(a, &n) == fmi3OK && n == 0);
    CHECK(fmi3GetContinuousStates(a, x, 2) == fmi3OK && x[0] == 1.0 && x[1] == 0.0);
    const double h = 1e-3;
    for (int i = 0; i < 1000; i++) {
        static const double part[4] = {0.0, 0.5, 0.5, 1.0};
        for (int stage = 0; stage < 4; stage++) {
            double y[2];
            for (int j = 0; j < 2; j++) y[j] = x[j] + (stage > 0 ? h * part[stage] * k[stage - 1][j] : 0.0);
            CHECK(fmi3SetTime(a, (i + part[stage]) * h) == fmi3OK && fmi3SetContinuousStates(a, y, 2) == fmi3OK);
            CHECK(fmi3GetContinuousStateDerivatives(a, k[stage], 2) == fmi3OK);
        }
        for (int j = 0; j < 2; j++) x[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
    }
    double rate;
    CHECK(near(x[0], reference(1.0, 0.0, &rate), 1e-9) && near(x[1], rate, 1e-9));
    /* Derivatives by the textbook: of the acceleration, of the output. */
    CHECK(fmi3SetContinuousStates(a, x, 2) == fmi3OK);
    const fmi3ValueReference unknowns[3] = {DER_THETA, DER_RATE, HEIGHT}, knowns[3] = {THETA, RATE, TAU};
    const double seed[3] = {0.3, -0.7, 1.1}, dual[3] = {0.5, 2.0, -1.0};
    double found[3], adjoint[3];
    CHECK(fmi3GetDirectionalDerivative(a, unknowns, 3, knowns, 3, seed, 3, found, 3) == fmi3OK);
    CHECK(
        near(found[0], -0.7, 1e-15) && near(found[1], -5.0 * cos(x[0]) * 0.3 + 0.25 / 12.0 * 0.7 + 1.1 / 12.0, 1e-14));
    CHECK(near(found[2], 2.0 * sin(x[0]) * 0.3, 1e-14));
    CHECK(fmi3GetAdjointDerivative(a, unknowns, 3, knowns, 3, dual, 3, adjoint, 3) == fmi3OK);
    CHECK(near(adjoint[0], -10.0 * cos(x[0]) - 2.0 * sin(x[0]), 1e-14) && near(adjoint[1], 0.5 - 0.5 / 12.0, 1e-14));
    CHECK(near(adjoint[2], 2.0 / 12.0, 1e-14));
    const fmi3ValueReference mass = MASS;
    CHECK(fmi3GetDirectionalDerivative(a, unknowns + 1, 1, &mass, 1, seed, 1, found, 1) == fmi3OK);
    CHECK(near(found[0], 0.3 * 0.25 * x[1] / 36.0, 1e-13));
    CHECK(fmi3GetDirectionalDerivative(a, unknowns + 2, 1, &mass, 1, seed, 1, found, 1) == fmi3Error);
    CHECK(
        fmi3GetContinuousStateDerivatives(a, dx, 1) == fmi3Error &&
        strstr(last_message, "2 continuous states") != NULL);
    x[1] = NAN;
    CHECK(fmi3SetContinuousStates(a, x, 2) == fmi3Discard && isfinite(get(a, RATE)));
    CHECK(fmi3SetTime(a, INFINITY) == fmi3Error && set(a, MASS, 2.0) == fmi3Error && step(a, 0.0, 1.0) == fmi3Error);
    CHECK(fmi3EnterEventMode(a) == fmi3OK && set(a, MASS, 2.0) == fmi3OK && fmi3EnterContinuousTimeMode(a) == fmi3OK);
    fmi3FreeInstance(a);
}

static void refused(void)
{
    messages = 0;
    CHECK(fmi3InstantiateModelExchange("a", "{another}", NULL, false, false, NULL, logged) == NULL && messages == 1);
    CHECK(
        strstr(last_message, "{another}") != NULL &&
        fmi3InstantiateModelExchange("a", NULL, NULL, false, false, NULL, NULL) == NULL);
    CHECK(step(NULL, 0.0, 1.0) == fmi3Error && fmi3Terminate(NULL) == fmi3Error);
    fmi3FreeInstance(NULL);

    fmi3Instance a = stepping();
    CHECK(step(a, 0.0, 0.1) == fmi3Error && strstr(last_message, "instantiated") != NULL);
    CHECK(fmi3ExitInitializationMode(a) == fmi3Error && fmi3EnterContinuousTimeMode(a) == fmi3Error);
    CHECK(set(a, END, 1.0) == fmi3Error && strstr(last_message, "value reference 14") != NULL);
    CHECK(set(a, 4294967295u, 1.0) == fmi3Error && set(a, TIME, 1.0) == fmi3Error && set(a, HEIGHT, 1.0) == fmi3Error);
    CHECK(set(a, TAU, NAN) == fmi3Error && strstr(last_message, "finite") != NULL && get(a, TAU) == 0.0);
    /* All or nothing. */
    const fmi3ValueReference two[2] = {TAU, END};
    const double fives[2] = {5.0, 5.0};
    CHECK(fmi3SetFloat64(a, two, 2, fives, 2) == fmi3Error && get(a, TAU) == 0.0);
    CHECK(fmi3SetFloat64(a, two, 1, fives, 2) == fmi3Error && fmi3SetFloat64(a, NULL, 1, fives, 1) == fmi3Error);
    fmi3Int32 integer = 0;
    CHECK(fmi3SetInt32(a, two, 1, &integer, 1) == fmi3Error && fmi3SetInt32(a, two, 0, &integer, 0) == fmi3OK);
    /* A mechanism that there is not. */
    CHECK(set(a, MASS, -1.0) == fmi3OK && fmi3EnterInitializationMode(a, false, 0.0, 0.0, false, 0.0) == fmi3Error);
    CHECK(strstr(last_message, "`m` must not be negative") != NULL);
    CHECK(set(a, MASS, 3.0) == fmi3OK && fmi3EnterInitializationMode(a, false, 0.0, 0.0, true, -1.0) == fmi3Error);
    CHECK(fmi3EnterInitializationMode(a, true, NAN, 0.0, false, 0.0) == fmi3Error);
    CHECK(
        fmi3EnterInitializationMode(a, true, 1e-3, NAN, false, 0.0) == fmi3Error &&
        ((fmu_instance *)a)->v.tolerance == MBS_TOLERANCE);
    begin(a);
    CHECK(set(a, THETA, 0.0) == fmi3Error && step(a, 0.5, 0.1) == fmi3Error && step(a, 0.0, 0.0) == fmi3Error);
    CHECK(step(a, 0.0, NAN) == fmi3Error && step(a, 0.0, -1.0) == fmi3Error && get(a, THETA) == 1.0);
    CHECK(
        fmi3EnterEventMode(a) == fmi3Error && fmi3EnterInitializationMode(a, false, 0.0, 0.0, false, 0.0) == fmi3Error);
    fmi3FreeInstance(a);
    /* At large times, too, the point is the one at which the FMU is. */
    const double late = 1.7e9;
    a = stepping();
    CHECK(fmi3EnterInitializationMode(a, false, 0.0, late, false, 0.0) == fmi3OK);
    CHECK(fmi3ExitInitializationMode(a) == fmi3OK && step(a, late, 0.01) == fmi3OK);
    CHECK(step(a, late, 0.01) == fmi3Error && step(a, late - 1.0, 0.01) == fmi3Error);
    CHECK(get(a, TIME) == late + 0.01 && step(a, late + 0.01, 0.01) == fmi3OK);
    fmi3FreeInstance(a);
}

static void tolerances(void)
{
    static const double asked[3] = {1e-2, 1.0, 1e300};
    double theta[3];
    for (int i = 0; i < 3; i++) {
        fmi3Instance a = stepping();
        CHECK(fmi3EnterInitializationMode(a, true, asked[i], 0.0, false, 0.0) == fmi3OK);
        CHECK(fmi3ExitInitializationMode(a) == fmi3OK && step(a, 0.0, 3.0) == fmi3OK);
        theta[i] = get(a, THETA);
        fmi3FreeInstance(a);
    }
    double rate;
    CHECK(near(theta[0], reference(3.0, 0.0, &rate), 1e-2) && theta[1] == theta[0] && theta[2] == theta[0]);
}

static void states(void)
{
    fmi3Instance a = stepping(), b = stepping();
    begin(a);
    begin(b);
    CHECK(set(a, TAU, 3.0) == fmi3OK && step(a, 0.0, 0.4) == fmi3OK);
    fmi3FMUState state = NULL, read = NULL;
    size_t size = 0;
    CHECK(fmi3GetFMUState(a, &state) == fmi3OK && step(a, 0.4, 0.7) == fmi3OK);
    const double theta = get(a, THETA);
    CHECK(
        fmi3SetFMUState(a, state) == fmi3OK && get(a, TIME) == 0.4 && step(a, 0.4, 0.7) == fmi3OK &&
        get(a, THETA) == theta);
    CHECK(fmi3SerializedFMUStateSize(a, state, &size) == fmi3OK);
    fmi3Byte *bytes = (fmi3Byte *)malloc(size);
    CHECK(bytes != NULL && fmi3SerializeFMUState(a, state, bytes, size) == fmi3OK);
    CHECK(fmi3SerializeFMUState(a, state, bytes, size - 1) == fmi3Error);
    CHECK(fmi3DeserializeFMUState(b, bytes, size - 1, &read) == fmi3Error && read == NULL);
    CHECK(fmi3DeserializeFMUState(b, bytes, size, &read) == fmi3OK && fmi3SetFMUState(b, read) == fmi3OK);
    CHECK(step(b, 0.4, 0.7) == fmi3OK && get(b, THETA) == theta);
    bytes[0] ^= 1;
    CHECK(fmi3DeserializeFMUState(b, bytes, size, &read) == fmi3Error);
    bytes[0] ^= 1;
    memset(bytes + sizeof(MBS_TOKEN), 0xff, sizeof(double)); /* NaN */
    CHECK(fmi3DeserializeFMUState(b, bytes, size, &read) == fmi3Error);
    fmi3Instance other = exchanging();
    CHECK(fmi3SetFMUState(other, state) == fmi3Error && fmi3Reset(other) == fmi3OK);
    begin(other);
    CHECK(step(other, 0.0, 0.1) == fmi3Error);
    fmi3FreeInstance(other);
    CHECK(fmi3SetFMUState(b, NULL) == fmi3Error && fmi3FreeFMUState(a, &state) == fmi3OK && state == NULL);
    CHECK(fmi3FreeFMUState(b, &read) == fmi3OK && fmi3FreeFMUState(b, &read) == fmi3OK);
    free(bytes);
    fmi3FreeInstance(a);
    fmi3FreeInstance(b);
}

static void many(void)
{
    enum { COUNT = 500 };
    static fmi3Instance all[COUNT];
    for (int i = 0; i < COUNT; i++) {
        all[i] = stepping();
        CHECK(all[i] != NULL && set(all[i], TAU, i % 3) == fmi3OK);
        begin(all[i]);
    }
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < COUNT; i++) CHECK(step(all[i], k * 0.25, 0.25) == fmi3OK);
    }
    for (int i = 0; i < COUNT; i++) {
        CHECK(get(all[i], THETA) == get(all[i % 3], THETA));
        CHECK(i < 1 || i > 2 || get(all[i], THETA) != get(all[0], THETA));
    }
    for (int i = 0; i < COUNT; i++) fmi3FreeInstance(all[i]);
}

int main(void)
{
    co_simulation();
    model_exchange();
    refused();
    tolerances();
    states();
    many();
    printf("good\n");
    return 0;
}
