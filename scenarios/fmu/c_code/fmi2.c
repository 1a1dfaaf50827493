/* FMI 2.0 co-simulation of the car in core.h. */
#include "core.h"
#include "fmi2Functions.h"

typedef struct {
    Car car;
    char *name;
    fmi2CallbackFunctions callbacks;
} Instance;

#define CAR (&((Instance *)c)->car)

static fmi2Status failed(fmi2Component c, const char *reason) {
    const Instance *instance = c;
    if (instance->callbacks.logger)
        instance->callbacks.logger(
            instance->callbacks.componentEnvironment, instance->name, fmi2Error, "logStatusError", "%s", reason);
    return fmi2Error;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    Instance *instance;
    (void)resources, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || !guid || strcmp(guid, GUID) != 0) return NULL;
    instance = calloc(1, sizeof *instance);
    if (!instance) return NULL;
    instance->name = calloc(strlen(name) + 1, 1);
    if (!instance->name) return free(instance), NULL;
    strcpy(instance->name, name);
    if (callbacks) instance->callbacks = *callbacks;
    reset_car(&instance->car);
    return instance;
}

void fmi2FreeInstance(fmi2Component c) {
    if (!c) return;
    free(((Instance *)c)->name);
    free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean td, fmi2Real t, fmi2Real start, fmi2Boolean sd, fmi2Real s) {
    (void)td, (void)t, (void)sd, (void)s;
    CAR->state.time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { start_car(CAR); return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { reset_car(CAR); return fmi2OK; }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    size_t i;
    for (i = 0; i < n; i++) {
        if (vr[i] >= N_INPUTS + N_OUTPUTS) return failed(c, "no such variable");
        value[i] = value_of(CAR, vr[i]);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    size_t i;
    for (i = 0; i < n; i++)
        if (!set_value(CAR, vr[i], value[i])) return failed(c, "only inputs can be set");
    return fmi2OK;
}

/* There are no variables of other types. */
#define NONE(NAME, ...) \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, __VA_ARGS__ value[]) { \
        (void)vr, (void)value; \
        return n ? failed(c, "no such variable") : fmi2OK; \
    }
NONE(fmi2GetInteger, fmi2Integer)
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetInteger, const fmi2Integer)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2SetString, const fmi2String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (!*state) *state = malloc(sizeof(Car));
    if (!*state) return failed(c, "no memory");
    memcpy(*state, CAR, sizeof(Car));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(CAR, state, sizeof(Car));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Car);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (size < sizeof(Car)) return failed(c, "no room for the state");
    memcpy(bytes, state, sizeof(Car));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    if (size != sizeof(Car)) return failed(c, "not a state of this FMU");
    if (!*state) *state = malloc(sizeof(Car));
    if (!*state) return failed(c, "no memory");
    memcpy(*state, bytes, sizeof(Car));
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                        const fmi2ValueReference k[], size_t nk, const fmi2Real d[], fmi2Real v[]) {
    (void)u, (void)nu, (void)k, (void)nk, (void)d, (void)v;
    return failed(c, "directional derivatives are not given");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    (void)vr, (void)n, (void)order, (void)value;
    return failed(c, "input derivatives are inputs of their own");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)n, (void)order, (void)value;
    return failed(c, "output derivatives are not given");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean no_set_state_prior) {
    const char *reason = advance(CAR, step);
    (void)now, (void)no_set_state_prior;
    return reason ? failed(c, reason) : fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return failed(c, "no step is pending"); }

#define STATUS(NAME, TYPE) \
    fmi2Status NAME(fmi2Component c, const fmi2StatusKind kind, TYPE *value) { \
        (void)c, (void)kind, (void)value; \
        return fmi2Discard; \
    }
STATUS(fmi2GetStatus, fmi2Status)
STATUS(fmi2GetIntegerStatus, fmi2Integer)
STATUS(fmi2GetBooleanStatus, fmi2Boolean)
STATUS(fmi2GetStringStatus, fmi2String)

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = CAR->state.time;
    return fmi2OK;
}
