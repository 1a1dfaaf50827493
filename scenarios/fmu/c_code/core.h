/* Car of foreride as plain C: state, integration in ticks of 1 ms and outputs, the same for FMI 2.0 and 3.0.
 *
 * model.h, generated, gives the equations (foreride_tick, foreride_signals, foreride_rest), the sizes of their
 * vectors and the start values of the inputs. A variable's value reference is its index: inputs, then outputs.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined __GNUC__ /* generated code: what it does not need is no fault */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#define CASADI_SYMBOL_EXPORT static
#include "model.h"
#if defined __GNUC__
#pragma GCC diagnostic pop
#endif

#define TICKS_PER_SECOND 1000.0

typedef struct {
    double time;
    double x[N_STATES];
    double u[N_INPUTS];
    double height[N_WHEELS]; /* of the road under the wheels, where the last step ended */
} State;

typedef struct {
    State state;
    double y[N_OUTPUTS];
    int started; /* whether initialization is over */
    int known;   /* whether y belongs to the state */
} Car;

static void reset_car(Car *car) {
    static const double start[N_INPUTS] = START_VALUES;
    memset(car, 0, sizeof *car);
    memcpy(car->state.u, start, sizeof start);
}

static void stand(Car *car) {
    double w[1 + REST_W];
    casadi_int iw[1 + REST_IW];
    const double *arg[1 + REST_ARG] = {car->state.u};
    double *res[2 + REST_RES] = {car->state.x, car->state.height};
    foreride_rest(arg, res, iw, w, 0);
}

static void start_car(Car *car) {
    stand(car);
    car->started = 1;
    car->known = 0;
}

static const double *outputs(Car *car) {
    double w[1 + SIGNALS_W];
    casadi_int iw[1 + SIGNALS_IW];
    const double *arg[3 + SIGNALS_ARG] = {car->state.x, car->state.u, car->state.height};
    double *res[1 + SIGNALS_RES] = {car->y};
    if (!car->started) stand(car);
    if (!car->known) foreride_signals(arg, res, iw, w, 0);
    car->known = 1;
    return car->y;
}

static double value_of(Car *car, size_t reference) {
    if (reference < N_INPUTS) return car->state.u[reference];
    return reference < N_INPUTS + N_OUTPUTS ? outputs(car)[reference - N_INPUTS] : car->state.time;
}

static int set_value(Car *car, size_t reference, double value) {
    if (reference >= N_INPUTS) return 0;
    car->state.u[reference] = value;
    car->known = 0;
    return 1;
}

/* Advances by a communication step; NULL, or the reason why it cannot. */
static const char *advance(Car *car, double step) {
    double w[1 + TICK_W], since, next[N_STATES];
    casadi_int iw[1 + TICK_IW];
    const double *arg[3 + TICK_ARG] = {car->state.x, car->state.u, &since};
    double *res[2 + TICK_RES] = {next, car->state.height};
    const double ticks = floor(step * TICKS_PER_SECOND + 0.5);
    double tick;
    int i, part;
    if (!(ticks >= 1.0 && ticks < 1e9) || fabs(step * TICKS_PER_SECOND - ticks) > 1e-6 * ticks)
        return "communication step must be a multiple of 0.001 s";
    for (tick = 0.0; tick < ticks; tick += 1.0) {
        since = tick / TICKS_PER_SECOND;
        for (part = 0; part < N_PARTS; part++) {
            foreride_tick(arg, res, iw, w, 0);
            memcpy(car->state.x, next, sizeof next);
        }
    }
    car->state.time += step;
    car->known = 0;
    for (i = 0; i < N_STATES; i++)
        if (!isfinite(car->state.x[i])) return "the car diverged: too stiff or too light for steps of 1 ms";
    return NULL;
}
