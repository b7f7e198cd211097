/* A master for the pendulum of the tests, FMI 2.0: what is right, and what is wrong and has to be refused. */
#include "fmi2.c"
#include "master.h"

static void logged(
    fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String message,
    ...)
{
    (void)environment;
    (void)status;
    char text[600];
    va_list rest;
    va_start(rest, message);
    vsnprintf(text, sizeof text, message, rest);
    va_end(rest);
    CHECK(strncmp(category, "logStatus", 9) == 0 && strcmp(name, "a") == 0);
    heard(text);
}

static fmi2Component made(fmi2Type type, const char *token)
{
    const fmi2CallbackFunctions callbacks = {logged, NULL, NULL, NULL, NULL};
    return fmi2Instantiate("a", type, token, NULL, &callbacks, fmi2False, fmi2False);
}

static double get(fmi2Component a, fmi2ValueReference vr)
{
    double value = 0.0;
    CHECK(fmi2GetReal(a, &vr, 1, &value) == fmi2OK);
    return value;
}

static fmi2Status set(fmi2Component a, fmi2ValueReference vr, double value) { return fmi2SetReal(a, &vr, 1, &value); }

static void begin(fmi2Component a)
{
    CHECK(fmi2SetupExperiment(a, fmi2True, 1e-12, 0.0, fmi2False, 0.0) == fmi2OK);
    CHECK(fmi2EnterInitializationMode(a) == fmi2OK && fmi2ExitInitializationMode(a) == fmi2OK);
}

static void co_simulation(void)
{
    fmi2Component a = made(fmi2CoSimulation, MBS_TOKEN);
    CHECK(a != NULL);
    begin(a);
    CHECK(set(a, TAU, 2.0) == fmi2OK);
    for (int i = 0; i < 30; i++) CHECK(fmi2DoStep(a, i / 10.0, 0.1, fmi2True) == fmi2OK);
    double rate, last = 0.0;
    const double theta = reference(3.0, 2.0, &rate);
    CHECK(near(get(a, THETA), theta, 1e-9) && near(get(a, RATE), rate, 1e-9));
    CHECK(fmi2GetRealStatus(a, fmi2LastSuccessfulTime, &last) == fmi2OK && near(last, 3.0, 1e-15));
    /* A torque that cancels that of gravity and friction for a moment grows by a slope: the step goes along. */
    CHECK(fmi2Reset(a) == fmi2OK);
    begin(a);
    const fmi2ValueReference tau = TAU;
    const fmi2Integer order = 1, four = 4;
    const double slope = 7.0, nan = NAN;
    CHECK(fmi2SetRealInputDerivatives(a, &tau, 1, &four, &slope) == fmi2Error);
    CHECK(fmi2SetRealInputDerivatives(a, &tau, 1, &order, &nan) == fmi2Error);
    CHECK(fmi2SetRealInputDerivatives(a, &tau, 1, &order, &slope) == fmi2OK);
    CHECK(fmi2DoStep(a, 0.0, 0.2, fmi2True) == fmi2OK && near(get(a, TAU), 1.4, 1e-14));
    /* Work of the torque is the energy that is there, less friction's: theta' is small, so by a power series
       theta''(0) = -5 sin 1; the term of the slope is 7 t^3 / 72, that of friction is taken off by a run without. */
    const double with = get(a, THETA);
    CHECK(fmi2Reset(a) == fmi2OK);
    begin(a);
    CHECK(fmi2DoStep(a, 0.0, 0.2, fmi2True) == fmi2OK);
    CHECK(near(with - get(a, THETA), 7.0 * 0.008 / 72.0, 1e-5) && fabs(with - get(a, THETA)) > 5e-4);
    fmi2FreeInstance(a);
}

static void model_exchange(void)
{
    fmi2Component a = made(fmi2ModelExchange, MBS_TOKEN);
    begin(a);
    fmi2EventInfo info;
    fmi2Boolean enter = 1, terminate = 1;
    double x[2] = {0.4, -0.3}, dx[2], nominal[2];
    CHECK(fmi2NewDiscreteStates(a, &info) == fmi2OK && !info.newDiscreteStatesNeeded && !info.nextEventTimeDefined);
    CHECK(fmi2EnterContinuousTimeMode(a) == fmi2OK && fmi2SetTime(a, 0.1) == fmi2OK && set(a, TAU, 0.7) == fmi2OK);
    CHECK(fmi2SetContinuousStates(a, x, 2) == fmi2OK && fmi2GetDerivatives(a, dx, 2) == fmi2OK);
    CHECK(dx[0] == -0.3 && near(dx[1], acceleration(0.4, -0.3, 0.7), 1e-15));
    CHECK(fmi2CompletedIntegratorStep(a, fmi2True, &enter, &terminate) == fmi2OK && !enter && !terminate);
    CHECK(fmi2GetNominalsOfContinuousStates(a, nominal, 2) == fmi2OK && nominal[1] == 1.0);
    CHECK(fmi2GetEventIndicators(a, NULL, 0) == fmi2OK && fmi2GetEventIndicators(a, dx, 1) == fmi2Error);
    const fmi2ValueReference unknown = DER_RATE, knowns[2] = {THETA, RATE};
    const double seed[2] = {1.0, 2.0};
    CHECK(fmi2GetDirectionalDerivative(a, &unknown, 1, knowns, 2, seed, dx) == fmi2OK);
    CHECK(near(dx[0], -5.0 * cos(0.4) - 0.5 / 12.0, 1e-14));
    CHECK(fmi2GetDirectionalDerivative(a, knowns, 2, &unknown, 1, seed, dx) == fmi2Error);
    CHECK(fmi2DoStep(a, 0.1, 0.1, fmi2True) == fmi2Error && fmi2NewDiscreteStates(a, &info) == fmi2Error);
    CHECK(fmi2EnterEventMode(a) == fmi2OK && fmi2Terminate(a) == fmi2OK && fmi2Terminate(a) == fmi2Error);
    fmi2FreeInstance(a);
}

static void refused(void)
{
    messages = 0;
    CHECK(made(fmi2CoSimulation, "{another}") == NULL && messages == 1 && made((fmi2Type)7, MBS_TOKEN) == NULL);
    CHECK(
        fmi2Instantiate("a", fmi2CoSimulation, MBS_TOKEN, NULL, NULL, 0, 0) == NULL &&
        fmi2DoStep(NULL, 0, 1, 1) == fmi2Error);
    fmi2Component a = made(fmi2CoSimulation, MBS_TOKEN);
    CHECK(fmi2DoStep(a, 0.0, 0.1, fmi2True) == fmi2Error && fmi2ExitInitializationMode(a) == fmi2Error);
    CHECK(fmi2SetupExperiment(a, fmi2True, -1.0, 5.0, fmi2False, 0.0) == fmi2Error && get(a, TIME) == 0.0);
    CHECK(fmi2SetupExperiment(a, fmi2False, 0.0, NAN, fmi2False, 0.0) == fmi2Error);
    CHECK(set(a, END, 1.0) == fmi2Error && set(a, TAU, INFINITY) == fmi2Error && set(a, DER_RATE, 1.0) == fmi2Error);
    CHECK(
        set(a, MASS, -1.0) == fmi2OK && fmi2EnterInitializationMode(a) == fmi2Error &&
        strstr(last_message, "`m`") != NULL);
    CHECK(fmi2Reset(a) == fmi2OK && get(a, MASS) == 3.0);
    const fmi2ValueReference tau = TAU;
    fmi2Integer integer = 0;
    CHECK(fmi2GetInteger(a, &tau, 1, &integer) == fmi2Error && fmi2CancelStep(a) == fmi2Error);
    begin(a);
    CHECK(set(a, MASS, -2.0) == fmi2OK && fmi2DoStep(a, 0.0, 0.1, fmi2True) == fmi2Error && get(a, TIME) == 0.0);
    CHECK(set(a, MASS, 2.0) == fmi2OK && fmi2DoStep(a, 0.0, 0.1, fmi2True) == fmi2OK);
    fmi2FreeInstance(a);
}

int main(void)
{
    co_simulation();
    model_exchange();
    refused();
    printf("good\n");
    return 0;
}
