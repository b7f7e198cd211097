/* What both masters share: checks that end the program, and what the pendulum of the tests does by the textbook. */
#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("%s:%d: %s\nlast message: %s\n", __FILE__, __LINE__, #condition, last_message); \
            exit(1); \
        } \
    } while (0)

static char last_message[600];
static int messages;

static void heard(const char *message)
{
    messages++;
    snprintf(last_message, sizeof last_message, "%s", message);
}

static int near(double a, double b, double bound) { return fabs(a - b) <= bound * (1.0 + fabs(b)); }

/* m l^2 theta'' = tau - b theta' - m g l sin theta, with the parameters that the mechanism declares. */
static double acceleration(double theta, double rate, double tau)
{
    return (tau - 0.25 * rate - 60.0 * sin(theta)) / 12.0;
}

/* Value references, in the order of modelDescription.xml. */
enum {
    TIME,
    THETA,
    RATE,
    DER_THETA,
    DER_RATE,
    TAU,
    MASS,
    LENGTH,
    GRAVITY,
    FRICTION,
    HEIGHT,
    KINETIC,
    POTENTIAL,
    ENERGY,
    END
};

/* Angle and rate after a time from one radian at rest, by a classical Runge-Kutta method with small steps. */
static double reference(double seconds, double tau, double *rate)
{
    double theta = 1.0;
    *rate = 0.0;
    const int steps = 20000;
    const double h = seconds / steps;
    for (int i = 0; i < steps; i++) {
        const double a = acceleration(theta, *rate, tau);
        const double b = acceleration(theta + h / 2 * *rate, *rate + h / 2 * a, tau);
        const double c = acceleration(theta + h / 2 * *rate + h * h / 4 * a, *rate + h / 2 * b, tau);
        const double d = acceleration(theta + h * *rate + h * h / 2 * b, *rate + h * c, tau);
        theta += h * *rate + h * h / 6 * (a + b + c);
        *rate += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return theta;
}
