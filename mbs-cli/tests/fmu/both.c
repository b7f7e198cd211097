/*
 * A master for any mechanism, FMI 3.0. both KIND T_END DT SUBSTEPS: integrates by co-simulation (KIND 0) or by a
 * classical Runge-Kutta method that ends its steps at events (KIND 1), and prints time and states. KIND 2: two steps of
 * co-simulation, between which parameter SUBSTEPS becomes 1.2 times what it was; then a new instance makes the second.
 */
#include "fmi3.c"

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            exit(1); \
        } \
    } while (0)

static void logged(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment;
    printf("%d %s %s\n", (int)status, category, message);
}

static void put(fmi3Instance a, double t)
{
    double x[2 * N];
    CHECK(fmi3GetContinuousStates(a, x, 2 * N) == fmi3OK);
    printf("%.17g", t);
    for (int i = 0; i < 2 * N; i++) printf(",%.17g", x[i]);
    printf("\n");
}

static void put_outputs(fmi3Instance a, double t)
{
    printf("%.17g", t);
    for (fmi3ValueReference vr = VR_Q; vr < VR_DER_Q; vr++) {
        double value;
        CHECK(fmi3GetFloat64(a, &vr, 1, &value, 1) == fmi3OK);
        printf(",%.17g", value);
    }
    printf("\n");
}

static void slopes(fmi3Instance a, double t, const double *x, double *dx)
{
    CHECK(fmi3SetTime(a, t) == fmi3OK && fmi3SetContinuousStates(a, x, 2 * N) == fmi3OK);
    CHECK(fmi3GetContinuousStateDerivatives(a, dx, 2 * N) == fmi3OK);
}

static void runge_kutta(fmi3Instance a, double t, double h, const double *x, double *end, double *z)
{
    static const double part[4] = {0.0, 0.5, 0.5, 1.0};
    double k[4][2 * N];
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 2 * N; i++) end[i] = x[i] + (stage > 0 ? h * part[stage] * k[stage - 1][i] : 0.0);
        slopes(a, t + part[stage] * h, end, k[stage]);
    }
    for (int i = 0; i < 2 * N; i++) end[i] = x[i] + h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    CHECK(fmi3SetTime(a, t + h) == fmi3OK && fmi3SetContinuousStates(a, end, 2 * N) == fmi3OK);
    CHECK(fmi3GetEventIndicators(a, z, Z) == fmi3OK);
}

static void update(fmi3Instance a)
{
    bool again, terminate, nominals, changed, next;
    double time;
    CHECK(
        fmi3UpdateDiscreteStates(a, &again, &terminate, &nominals, &changed, &next, &time) == fmi3OK && !again &&
        !terminate);
    CHECK(fmi3EnterContinuousTimeMode(a) == fmi3OK);
}

static void exchange(double t_end, double dt, int substeps)
{
    fmi3Instance a = fmi3InstantiateModelExchange("a", MBS_TOKEN, NULL, false, false, NULL, logged);
    double x[2 * N], end[2 * N], z[Z + 1], z_end[Z + 1];
    CHECK(a != NULL && fmi3EnterInitializationMode(a, false, 0.0, 0.0, false, 0.0) == fmi3OK);
    CHECK(fmi3ExitInitializationMode(a) == fmi3OK);
    update(a);
    put(a, 0.0);
    const int rows = (int)(t_end / dt + 0.5);
    int events = 0;
    for (int row = 0; row < rows; row++) {
        double t = row * dt;
        const double goal = (row + 1) * dt;
        while (goal - t > 1e-13) {
            double h = fmin(dt / substeps, goal - t);
            CHECK(fmi3GetContinuousStates(a, x, 2 * N) == fmi3OK && fmi3GetEventIndicators(a, z, Z) == fmi3OK);
            runge_kutta(a, t, h, x, end, z_end);
            int is_event = !same_sides(z, z_end);
            if (is_event) {
                double before = 0.0;
                while (h - before > 1e-14) {
                    const double middle = (before + h) / 2;
                    runge_kutta(a, t, middle, x, end, z_end);
                    if (same_sides(z, z_end)) {
                        before = middle;
                    } else {
                        h = middle;
                    }
                }
                runge_kutta(a, t, h, x, end, z_end);
                events++;
            }
            t += h;
            bool event_mode, terminate;
            CHECK(fmi3CompletedIntegratorStep(a, true, &event_mode, &terminate) == fmi3OK && !terminate);
            if (is_event || event_mode) {
                CHECK(fmi3EnterEventMode(a) == fmi3OK);
                update(a);
            }
        }
        put(a, goal);
    }
    printf("events %d\n", events);
    fmi3FreeInstance(a);
}

static void simulate(double t_end, double dt)
{
    fmi3Instance a =
        fmi3InstantiateCoSimulation("a", MBS_TOKEN, NULL, false, false, false, false, NULL, 0, NULL, logged, NULL);
    CHECK(a != NULL && fmi3EnterInitializationMode(a, true, 1e-13, 0.0, false, 0.0) == fmi3OK);
    CHECK(fmi3ExitInitializationMode(a) == fmi3OK);
    put_outputs(a, 0.0);
    const int rows = (int)(t_end / dt + 0.5);
    for (int row = 0; row < rows; row++) {
        bool event, terminate, early;
        double last;
        CHECK(fmi3DoStep(a, row * dt, dt, true, &event, &terminate, &early, &last) == fmi3OK);
        put_outputs(a, (row + 1) * dt);
    }
    fmi3FreeInstance(a);
}

static fmi3Instance begun(double t, const double *x, fmi3ValueReference tuned, double value)
{
    fmi3Instance a =
        fmi3InstantiateCoSimulation("a", MBS_TOKEN, NULL, false, false, false, false, NULL, 0, NULL, logged, NULL);
    CHECK(a != NULL);
    for (fmi3ValueReference vr = VR_Q; x != NULL && vr < VR_DER_Q; vr++)
        CHECK(fmi3SetFloat64(a, &vr, 1, x + (vr - VR_Q), 1) == fmi3OK);
    if (x != NULL) CHECK(fmi3SetFloat64(a, &tuned, 1, &value, 1) == fmi3OK);
    CHECK(fmi3EnterInitializationMode(a, true, 1e-12, t, false, 0.0) == fmi3OK);
    CHECK(fmi3ExitInitializationMode(a) <= fmi3Warning);
    return a;
}

static void stepped(fmi3Instance a, double t, double dt)
{
    bool event, terminate, early;
    double last;
    CHECK(fmi3DoStep(a, t, dt, true, &event, &terminate, &early, &last) == fmi3OK);
}

static void tune(double dt, int parameter)
{
    const fmi3ValueReference tuned = (fmi3ValueReference)(VR_P + parameter);
    double x[2 * N], value;
    fmi3Instance a = begun(0.0, NULL, 0, 0.0);
    CHECK(fmi3GetFloat64(a, &tuned, 1, &value, 1) == fmi3OK);
    value *= 1.2;
    stepped(a, 0.0, dt);
    for (fmi3ValueReference vr = VR_Q; vr < VR_DER_Q; vr++)
        CHECK(fmi3GetFloat64(a, &vr, 1, x + (vr - VR_Q), 1) == fmi3OK);
    CHECK(fmi3SetFloat64(a, &tuned, 1, &value, 1) == fmi3OK);
    fmi3Instance b = begun(dt, x, tuned, value);
    stepped(a, dt, dt);
    stepped(b, dt, dt);
    put_outputs(a, 2.0 * dt);
    put_outputs(b, 2.0 * dt);
    fmi3FreeInstance(a);
    fmi3FreeInstance(b);
}

int main(int count, char **given)
{
    CHECK(count == 5);
    if (atoi(given[1]) == 0) {
        simulate(atof(given[2]), atof(given[3]));
    } else if (atoi(given[1]) == 2) {
        tune(atof(given[3]), atoi(given[4]));
    } else {
        exchange(atof(given[2]), atof(given[3]), atoi(given[4]));
    }
    return 0;
}
