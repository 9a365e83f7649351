/* FMI 2.0 over `instance`: what co-simulation needs, and what model exchange has in common with it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fmi2.h"

/* Values that are converted at a time. */
#define SOME 64

const char *const kinds[] = {"Real", "Integer", "Boolean", "Enumeration"};
const bool integers_are_choices = true;
const bool states_are_settable = false;

static void tell(const Instance *instance, Status status, const char *category, const char *message)
{
    char format[2 * MESSAGE]; /* hosts print it, or show it as it is */
    char *end = format;
    for (; *message; *end++ = *message++)
        if (*message == '%') *end++ = '%';
    *end = 0;
    ((fmi2CallbackLogger)instance->callback)(instance->environment, instance->name, (fmi2Status)status, category,
                                             format);
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    fmi2CallbackLogger say = functions ? functions->logger : NULL;
    fmi2ComponentEnvironment environment = functions ? functions->componentEnvironment : NULL;
    const char *fault = NULL;
    Instance *instance;
    (void)resources; (void)visible;
    if (!name || !*name) fault = "the instance needs a name";
    else if (!guid || strcmp(guid, TOKEN)) fault = "the guid must be " TOKEN ", that of modelDescription.xml";
    else if (type != fmi2CoSimulation && type != fmi2ModelExchange)
        fault = "the type must be fmi2CoSimulation or fmi2ModelExchange";
    if (fault) {
        if (say) say(environment, name ? name : "", fmi2Error, "logStatusError", fault);
        return NULL;
    }
    instance = instance_new(name, say ? tell : NULL, environment, (void *)say, logging);
    if (!instance && say) say(environment, name, fmi2Error, "logStatusError", "out of memory");
    if (instance) instance->now.exchange = type == fmi2ModelExchange;
    return instance;
}

void fmi2FreeInstance(fmi2Component handle)
{
    instance_free(INSTANCE);
}

fmi2Status fmi2SetupExperiment(fmi2Component handle, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    NEEDS(INSTANTIATED, "fmi2SetupExperiment");
    (void)tolerance_defined; (void)tolerance; /* the component keeps its own, which is tighter */
    return instance_set_times(INSTANCE, start, stop_defined, stop);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component handle)
{
    NEEDS(INSTANTIATED, "fmi2EnterInitializationMode");
    INSTANCE->now.phase = INITIALIZING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component handle)
{
    Status status;
    NEEDS(INITIALIZING, "fmi2ExitInitializationMode");
    status = instance_initialize(INSTANCE);
    if (status == OK) INSTANCE->now.phase = INSTANCE->now.exchange ? EVENT : STEPPING;
    return status;
}

/* Variables */

fmi2Status fmi2GetReal(fmi2Component handle, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    NEEDS(READABLE, "fmi2GetReal");
    return instance_get(INSTANCE, REAL, vr, count, value);
}

fmi2Status fmi2SetReal(fmi2Component handle, const fmi2ValueReference vr[], size_t count, const fmi2Real value[])
{
    NEEDS(SETTABLE, "fmi2SetReal");
    return instance_set(INSTANCE, REAL, vr, count, value);
}

static Status get_whole(Instance *instance, Kind kind, const fmi2ValueReference vr[], size_t count, int value[])
{
    double some[SOME] = {0.0};
    for (size_t i = 0; i < count; i += SOME) {
        size_t n = count - i < SOME ? count - i : SOME;
        Status status = instance_get(instance, kind, vr ? vr + i : NULL, n, value ? some : NULL);
        if (status != OK) return status;
        for (size_t j = 0; j < n; j++) value[i + j] = (int)instance_whole(some[j], INT32_MIN, INT32_MAX);
    }
    return OK;
}

/* All can be set before any is. */
static Status set_whole(Instance *instance, Kind kind, const fmi2ValueReference vr[], size_t count, const int value[])
{
    double some[SOME];
    for (int set = 0; set < 2; set++)
        for (size_t i = 0; i < count; i += SOME) {
            size_t n = count - i < SOME ? count - i : SOME;
            const fmi2ValueReference *r = vr ? vr + i : NULL;
            const double *v = value ? some : NULL;
            for (size_t j = 0; v && j < n; j++) some[j] = kind == BOOLEAN ? value[i + j] != 0 : value[i + j];
            if ((set ? instance_set(instance, kind, r, n, v) : instance_can_set(instance, kind, r, n, v)) != OK)
                return ERROR;
        }
    return OK;
}

fmi2Status fmi2GetInteger(fmi2Component handle, const fmi2ValueReference vr[], size_t count, fmi2Integer value[])
{
    NEEDS(READABLE, "fmi2GetInteger");
    return get_whole(INSTANCE, INTEGER, vr, count, value);
}

fmi2Status fmi2SetInteger(fmi2Component handle, const fmi2ValueReference vr[], size_t count, const fmi2Integer value[])
{
    NEEDS(SETTABLE, "fmi2SetInteger");
    return set_whole(INSTANCE, INTEGER, vr, count, value);
}

fmi2Status fmi2GetBoolean(fmi2Component handle, const fmi2ValueReference vr[], size_t count, fmi2Boolean value[])
{
    NEEDS(READABLE, "fmi2GetBoolean");
    return get_whole(INSTANCE, BOOLEAN, vr, count, value);
}

fmi2Status fmi2SetBoolean(fmi2Component handle, const fmi2ValueReference vr[], size_t count, const fmi2Boolean value[])
{
    NEEDS(SETTABLE, "fmi2SetBoolean");
    return set_whole(INSTANCE, BOOLEAN, vr, count, value);
}

static Status no_strings(const Instance *instance, size_t count)
{
    return count ? instance_say(instance, ERROR, "this FMU has no variables of type String") : OK;
}

fmi2Status fmi2GetString(fmi2Component handle, const fmi2ValueReference vr[], size_t count, fmi2String value[])
{
    NEEDS(READABLE, "fmi2GetString");
    (void)vr; (void)value;
    return no_strings(INSTANCE, count);
}

fmi2Status fmi2SetString(fmi2Component handle, const fmi2ValueReference vr[], size_t count, const fmi2String value[])
{
    NEEDS(SETTABLE, "fmi2SetString");
    (void)vr; (void)value;
    return no_strings(INSTANCE, count);
}

/* Derivatives by time */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component handle, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    NEEDS(SETTABLE, "fmi2SetRealInputDerivatives");
    if (count && (!vr || !order || !value)) return instance_set(INSTANCE, REAL, NULL, count, NULL);
    for (size_t i = 0; i < count; i++) {
        fmi2ValueReference derivative;
        if (vr[i] < INPUTS_AT || vr[i] >= INPUTS_AT + INPUTS)
            return instance_say(INSTANCE, ERROR, "value reference %u is not of an input", (unsigned)vr[i]);
        if (order[i] < 1 || order[i] > 3)
            return instance_say(INSTANCE, ERROR, "derivative %d of %s: must be 1, 2 or 3", order[i],
                                instance_name(&variables[vr[i]]));
        derivative = vr[i] + (fmi2ValueReference)order[i] * INPUTS;
        if (instance_can_set(INSTANCE, REAL, &derivative, 1, value + i) != OK) return fmi2Error;
    }
    for (size_t i = 0; i < count; i++) {
        fmi2ValueReference derivative = vr[i] + (fmi2ValueReference)order[i] * INPUTS;
        instance_set(INSTANCE, REAL, &derivative, 1, value + i);
    }
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component handle, const fmi2ValueReference vr[], size_t count,
                                        const fmi2Integer order[], fmi2Real value[])
{
    NEEDS(READABLE, "fmi2GetRealOutputDerivatives");
    return instance_output_derivatives(INSTANCE, vr, count, order, value);
}

/* Derivatives by variables */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component handle, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                        fmi2Real sensitivity[])
{
    NEEDS(READABLE, "fmi2GetDirectionalDerivative");
    return instance_directional(INSTANCE, unknown, unknowns, known, knowns, seed, sensitivity);
}

/* Stepping */

fmi2Status fmi2DoStep(fmi2Component handle, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state)
{
    NEEDS(STEPPING, "fmi2DoStep");
    (void)no_set_state;
    if (instance_exceeds_stop(INSTANCE, time, step)) return fmi2Error;
    return instance_step(INSTANCE, time, step);
}

fmi2Status fmi2CancelStep(fmi2Component handle)
{
    if (!handle) return fmi2Error;
    return instance_say(INSTANCE, ERROR, "fmi2CancelStep: steps are never pending");
}

fmi2Status fmi2GetStatus(fmi2Component handle, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind; (void)value;
    if (!handle) return fmi2Error;
    return instance_say(INSTANCE, DISCARD, "fmi2GetStatus: steps are never pending");
}

fmi2Status fmi2GetRealStatus(fmi2Component handle, const fmi2StatusKind kind, fmi2Real *value)
{
    NEEDS(STEPPING | TERMINATED, "fmi2GetRealStatus");
    if (kind != fmi2LastSuccessfulTime || !value)
        return instance_say(INSTANCE, DISCARD, "fmi2GetRealStatus: only fmi2LastSuccessfulTime is known");
    *value = INSTANCE->now.data[T_AT];
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component handle, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind; (void)value;
    if (!handle) return fmi2Error;
    return instance_say(INSTANCE, DISCARD, "fmi2GetIntegerStatus: there is no such status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component handle, const fmi2StatusKind kind, fmi2Boolean *value)
{
    NEEDS(STEPPING | TERMINATED, "fmi2GetBooleanStatus");
    if (kind != fmi2Terminated || !value)
        return instance_say(INSTANCE, DISCARD, "fmi2GetBooleanStatus: only fmi2Terminated is known");
    *value = fmi2False; /* it never ends a run by itself */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component handle, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind; (void)value;
    if (!handle) return fmi2Error;
    return instance_say(INSTANCE, DISCARD, "fmi2GetStringStatus: steps are never pending");
}
