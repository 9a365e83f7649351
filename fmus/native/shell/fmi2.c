/* FMI 2.0 over `unit`: what co-simulation needs, and what model exchange has in common with it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fmi2.h"

/* Values that are converted at a time. */
#define SOME 64

const char *const kinds[] = {"Real", "Integer", "Boolean", "Enumeration"};
const bool integers_are_choices = true;

static void tell(const Unit *unit, Status status, const char *category, const char *message)
{
    char format[2 * MESSAGE]; /* hosts print it, or show it as it is */
    char *end = format;
    for (; *message; *end++ = *message++)
        if (*message == '%') *end++ = '%';
    *end = 0;
    ((fmi2CallbackLogger)unit->callback)(unit->environment, unit->name, (fmi2Status)status, category, format);
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    if (!c) return fmi2Error;
    (void)count, (void)categories; /* all of them */
    UNIT->logging = on;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    fmi2CallbackLogger say = functions ? functions->logger : NULL;
    fmi2ComponentEnvironment environment = functions ? functions->componentEnvironment : NULL;
    const char *fault = NULL;
    Unit *unit;
    (void)resources, (void)visible;
    if (!name || !*name) fault = "the instance needs a name";
    else if (!guid || strcmp(guid, TOKEN)) fault = "the guid must be " TOKEN ", that of modelDescription.xml";
    else if (type != fmi2CoSimulation && type != fmi2ModelExchange)
        fault = "the type must be fmi2CoSimulation or fmi2ModelExchange";
    if (fault) {
        if (say) say(environment, name ? name : "", fmi2Error, "logStatusError", fault);
        return NULL;
    }
    unit = unit_new(name, say ? tell : NULL, environment, (void *)say, logging);
    if (!unit && say) say(environment, name, fmi2Error, "logStatusError", "out of memory");
    if (unit) unit->now.exchange = type == fmi2ModelExchange;
    return unit;
}

void fmi2FreeInstance(fmi2Component c)
{
    unit_free(UNIT);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    NEEDS(INSTANTIATED, "fmi2SetupExperiment");
    (void)tolerance_defined, (void)tolerance; /* the component keeps its own, which is tighter */
    return unit_set_times(UNIT, start, stop_defined, stop);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    NEEDS(INSTANTIATED, "fmi2EnterInitializationMode");
    UNIT->now.phase = INITIALIZING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Status status;
    NEEDS(INITIALIZING, "fmi2ExitInitializationMode");
    status = unit_initialize(UNIT);
    if (status == OK) UNIT->now.phase = UNIT->now.exchange ? EVENT : STEPPING;
    return status;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    NEEDS(MOVING, "fmi2Terminate");
    UNIT->now.phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    NEEDS(ANY, "fmi2Reset");
    unit_reset(UNIT);
    return fmi2OK;
}

/* Variables */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    NEEDS(READABLE, "fmi2GetReal");
    return unit_get(UNIT, REAL, vr, count, value);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[])
{
    NEEDS(SETTABLE, "fmi2SetReal");
    return unit_set(UNIT, REAL, vr, count, value);
}

static Status get_whole(Unit *unit, Kind kind, const fmi2ValueReference vr[], size_t count, int value[])
{
    double some[SOME];
    for (size_t i = 0; i < count; i += SOME) {
        size_t n = count - i < SOME ? count - i : SOME;
        Status status = unit_get(unit, kind, vr ? vr + i : NULL, n, value ? some : NULL);
        if (status != OK) return status;
        for (size_t j = 0; j < n; j++) value[i + j] = (int)unit_whole(some[j], INT32_MIN, INT32_MAX);
    }
    return OK;
}

/* All can be set before any is. */
static Status set_whole(Unit *unit, Kind kind, const fmi2ValueReference vr[], size_t count, const int value[])
{
    double some[SOME];
    for (int set = 0; set < 2; set++)
        for (size_t i = 0; i < count; i += SOME) {
            size_t n = count - i < SOME ? count - i : SOME;
            const fmi2ValueReference *r = vr ? vr + i : NULL;
            const double *v = value ? some : NULL;
            for (size_t j = 0; v && j < n; j++) some[j] = kind == BOOLEAN ? value[i + j] != 0 : value[i + j];
            if ((set ? unit_set(unit, kind, r, n, v) : unit_can_set(unit, kind, r, n, v)) != OK) return ERROR;
        }
    return OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Integer value[])
{
    NEEDS(READABLE, "fmi2GetInteger");
    return get_whole(UNIT, INTEGER, vr, count, value);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Integer value[])
{
    NEEDS(SETTABLE, "fmi2SetInteger");
    return set_whole(UNIT, INTEGER, vr, count, value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Boolean value[])
{
    NEEDS(READABLE, "fmi2GetBoolean");
    return get_whole(UNIT, BOOLEAN, vr, count, value);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Boolean value[])
{
    NEEDS(SETTABLE, "fmi2SetBoolean");
    return set_whole(UNIT, BOOLEAN, vr, count, value);
}

static Status no_strings(const Unit *unit, size_t count)
{
    return count ? unit_say(unit, ERROR, "this FMU has no variables of type String") : OK;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2String value[])
{
    NEEDS(READABLE, "fmi2GetString");
    (void)vr, (void)value;
    return no_strings(UNIT, count);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2String value[])
{
    NEEDS(SETTABLE, "fmi2SetString");
    (void)vr, (void)value;
    return no_strings(UNIT, count);
}

/* Derivatives by time */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    NEEDS(SETTABLE, "fmi2SetRealInputDerivatives");
    if (count && (!vr || !order || !value)) return unit_set(UNIT, REAL, NULL, count, NULL);
    for (size_t i = 0; i < count; i++) {
        fmi2ValueReference derivative;
        if (vr[i] < INPUTS_AT || vr[i] >= INPUTS_AT + INPUTS)
            return unit_say(UNIT, ERROR, "value reference %u is not of an input", (unsigned)vr[i]);
        if (order[i] < 1 || order[i] > 3)
            return unit_say(UNIT, ERROR, "derivative %d of %s: must be 1, 2 or 3", order[i],
                            unit_name(&variables[vr[i]]));
        derivative = vr[i] + (fmi2ValueReference)order[i] * INPUTS;
        if (unit_can_set(UNIT, REAL, &derivative, 1, value + i) != OK) return fmi2Error;
    }
    for (size_t i = 0; i < count; i++) {
        fmi2ValueReference derivative = vr[i] + (fmi2ValueReference)order[i] * INPUTS;
        unit_set(UNIT, REAL, &derivative, 1, value + i);
    }
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                        const fmi2Integer order[], fmi2Real value[])
{
    NEEDS(READABLE, "fmi2GetRealOutputDerivatives");
    return unit_output_derivatives(UNIT, vr, count, order, value);
}

/* Saved states */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    NEEDS(ANY, "fmi2GetFMUstate");
    return unit_keep(UNIT, state);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    NEEDS(ANY, "fmi2SetFMUstate");
    return unit_put_back(UNIT, state);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    NEEDS(ANY, "fmi2FreeFMUstate");
    return unit_forget(state);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    NEEDS(ANY, "fmi2SerializedFMUstateSize");
    return unit_kept_size(UNIT, state, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    NEEDS(ANY, "fmi2SerializeFMUstate");
    return unit_kept_to_bytes(UNIT, state, bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    NEEDS(ANY, "fmi2DeSerializeFMUstate");
    return unit_kept_from_bytes(UNIT, bytes, size, state);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                        fmi2Real sensitivity[])
{
    NEEDS(READABLE, "fmi2GetDirectionalDerivative");
    return unit_directional(UNIT, unknown, unknowns, known, knowns, seed, sensitivity);
}

/* Stepping */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state)
{
    NEEDS(STEPPING, "fmi2DoStep");
    (void)no_set_state;
    if (unit_goes_too_far(UNIT, time, step)) return fmi2Error;
    return unit_step(UNIT, time, step);
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    if (!c) return fmi2Error;
    return unit_say(UNIT, ERROR, "fmi2CancelStep: steps are never pending");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    if (!c) return fmi2Error;
    return unit_say(UNIT, DISCARD, "fmi2GetStatus: steps are never pending");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    NEEDS(STEPPING | TERMINATED, "fmi2GetRealStatus");
    if (kind != fmi2LastSuccessfulTime || !value)
        return unit_say(UNIT, DISCARD, "fmi2GetRealStatus: only fmi2LastSuccessfulTime is known");
    *value = UNIT->now.data[T_AT];
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    if (!c) return fmi2Error;
    return unit_say(UNIT, DISCARD, "fmi2GetIntegerStatus: there is no such status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    NEEDS(STEPPING | TERMINATED, "fmi2GetBooleanStatus");
    if (kind != fmi2Terminated || !value)
        return unit_say(UNIT, DISCARD, "fmi2GetBooleanStatus: only fmi2Terminated is known");
    *value = fmi2False; /* it never ends a run by itself */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    if (!c) return fmi2Error;
    return unit_say(UNIT, DISCARD, "fmi2GetStringStatus: steps are never pending");
}
