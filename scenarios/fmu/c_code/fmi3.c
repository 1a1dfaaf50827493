/* FMI 3.0 co-simulation of the car in core.h. */
#include "core.h"
#include "fmi3Functions.h"

typedef struct {
    Car car;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Instance;

#define CAR (&((Instance *)c)->car)
#define REFERENCES fmi3Instance c, const fmi3ValueReference vr[], size_t n

static fmi3Status failed(fmi3Instance c, const char *reason) {
    const Instance *instance = c;
    if (instance->log) instance->log(instance->environment, fmi3Error, "logStatusError", reason);
    return fmi3Error;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference vr[], size_t n,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    Instance *instance;
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)vr, (void)update;
    if (n || !token || strcmp(token, GUID) != 0) return NULL;
    instance = calloc(1, sizeof *instance);
    if (!instance) return NULL;
    instance->environment = environment;
    instance->log = log;
    reset_car(&instance->car);
    return instance;
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
    (void)update, (void)lock, (void)unlock;
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean td, fmi3Float64 t, fmi3Float64 start,
                                       fmi3Boolean sd, fmi3Float64 stop) {
    (void)td, (void)t, (void)sd, (void)stop;
    CAR->state.time = start;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { start_car(CAR); return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3Reset(fmi3Instance c) { reset_car(CAR); return fmi3OK; }

fmi3Status fmi3GetFloat64(REFERENCES, fmi3Float64 values[], size_t count) {
    size_t i;
    if (count != n) return failed(c, "one value per variable expected");
    for (i = 0; i < n; i++) {
        if (vr[i] > N_INPUTS + N_OUTPUTS) return failed(c, "no such variable");
        values[i] = value_of(CAR, vr[i]);
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(REFERENCES, const fmi3Float64 values[], size_t count) {
    size_t i;
    if (count != n) return failed(c, "one value per variable expected");
    for (i = 0; i < n; i++)
        if (!set_value(CAR, vr[i], values[i])) return failed(c, "only inputs can be set");
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    if (!*state) *state = malloc(sizeof(Car));
    if (!*state) return failed(c, "no memory");
    memcpy(*state, CAR, sizeof(Car));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    memcpy(CAR, state, sizeof(Car));
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Car);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    if (size < sizeof(Car)) return failed(c, "no room for the state");
    memcpy(bytes, state, sizeof(Car));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    if (size != sizeof(Car)) return failed(c, "not a state of this FMU");
    if (!*state) *state = malloc(sizeof(Car));
    if (!*state) return failed(c, "no memory");
    memcpy(*state, bytes, sizeof(Car));
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 now, fmi3Float64 step, fmi3Boolean no_set_state_prior,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    const char *reason = advance(CAR, step);
    (void)now, (void)no_set_state_prior;
    *event = *terminate = *early = fmi3False;
    *last = CAR->state.time;
    return reason ? failed(c, reason) : fmi3OK;
}

/* There are no variables of other types, and none of the other interfaces. */
#define NONE(NAME, ...) \
    fmi3Status NAME(REFERENCES, __VA_ARGS__ values[], size_t count) { \
        (void)vr, (void)values, (void)count; \
        return n ? failed(c, "no such variable") : fmi3OK; \
    }
#define NO_TYPE(TYPE) NONE(fmi3Get##TYPE, fmi3##TYPE) NONE(fmi3Set##TYPE, const fmi3##TYPE)
NO_TYPE(Float32)
NO_TYPE(Int8)
NO_TYPE(UInt8)
NO_TYPE(Int16)
NO_TYPE(UInt16)
NO_TYPE(Int32)
NO_TYPE(UInt32)
NO_TYPE(Int64)
NO_TYPE(UInt64)
NO_TYPE(Boolean)
NO_TYPE(String)

/* The unused parameters of these need no names in C23 alone: hence the pragma. */
#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#define UNSUPPORTED(NAME, ...) \
    fmi3Status NAME(__VA_ARGS__) { return failed(c, #NAME " is not supported"); }
#define I fmi3Instance c
#define B fmi3Boolean *
#define OUT fmi3Float64 values[], size_t count
UNSUPPORTED(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t count)
UNSUPPORTED(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t count)
UNSUPPORTED(fmi3GetClock, REFERENCES, fmi3Clock values[])
UNSUPPORTED(fmi3SetClock, REFERENCES, const fmi3Clock values[])
UNSUPPORTED(fmi3GetNumberOfVariableDependencies, I, fmi3ValueReference vr, size_t *n)
UNSUPPORTED(fmi3GetVariableDependencies, I, fmi3ValueReference vr, size_t of[], fmi3ValueReference on[],
            size_t elements[], fmi3DependencyKind kinds[], size_t n)
UNSUPPORTED(fmi3GetDirectionalDerivative, REFERENCES, const fmi3ValueReference known[], size_t n_known,
            const fmi3Float64 seed[], size_t n_seed, OUT)
UNSUPPORTED(fmi3GetAdjointDerivative, REFERENCES, const fmi3ValueReference known[], size_t n_known,
            const fmi3Float64 seed[], size_t n_seed, OUT)
UNSUPPORTED(fmi3EnterConfigurationMode, I)
UNSUPPORTED(fmi3ExitConfigurationMode, I)
UNSUPPORTED(fmi3EnterEventMode, I)
UNSUPPORTED(fmi3EnterStepMode, I)
UNSUPPORTED(fmi3EnterContinuousTimeMode, I)
UNSUPPORTED(fmi3EvaluateDiscreteStates, I)
UNSUPPORTED(fmi3UpdateDiscreteStates, I, B update, B terminate, B nominals, B states, B defined, fmi3Float64 *next)
UNSUPPORTED(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
UNSUPPORTED(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
            fmi3IntervalQualifier qualifiers[])
UNSUPPORTED(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
UNSUPPORTED(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
UNSUPPORTED(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
UNSUPPORTED(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
UNSUPPORTED(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
UNSUPPORTED(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
UNSUPPORTED(fmi3CompletedIntegratorStep, I, fmi3Boolean no_set_state_prior, B enter_event_mode, B terminate)
UNSUPPORTED(fmi3SetTime, I, fmi3Float64 time)
UNSUPPORTED(fmi3SetContinuousStates, I, const fmi3Float64 values[], size_t count)
UNSUPPORTED(fmi3GetContinuousStateDerivatives, I, OUT)
UNSUPPORTED(fmi3GetEventIndicators, I, OUT)
UNSUPPORTED(fmi3GetContinuousStates, I, OUT)
UNSUPPORTED(fmi3GetNominalsOfContinuousStates, I, OUT)
UNSUPPORTED(fmi3GetNumberOfEventIndicators, I, size_t *count)
UNSUPPORTED(fmi3GetNumberOfContinuousStates, I, size_t *count)
UNSUPPORTED(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], OUT)
UNSUPPORTED(fmi3ActivateModelPartition, I, fmi3ValueReference clock, fmi3Float64 time)
