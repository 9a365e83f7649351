/* FMI 3.0 over `instance`: life and variables of an instance; see fmi3_step.c for co-simulation, fmi3_exchange.c for
   model exchange, fmi3_absent.c for what no component has. */
#include "fmi3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Values that are converted at a time. */
#define SOME 64

const char *const kinds[] = {"Float64", "Int32", "Boolean", "Enumeration"};
const bool integers_are_choices = false;
const bool states_are_settable = true;

static void tell(const Instance *instance, Status status, const char *category, const char *message)
{
    ((fmi3LogMessageCallback)instance->callback)(instance->environment, (fmi3Status)status, category, message);
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

/* Life */

static void *refused(fmi3InstanceEnvironment environment, fmi3LogMessageCallback say, const char *why)
{
    if (say) say(environment, fmi3Error, "logStatusError", why);
    return NULL;
}

static Session *new_instance(fmi3String name, fmi3String token, fmi3Boolean logging,
                             fmi3InstanceEnvironment environment, fmi3LogMessageCallback say)
{
    Session *made;
    if (!name || !*name) return refused(environment, say, "the instance needs a name");
    if (!token || strcmp(token, TOKEN))
        return refused(environment, say, "the instantiationToken must be " TOKEN ", that of modelDescription.xml");
    made = calloc(1, sizeof *made);
    if (made) made->instance = instance_new(name, say ? tell : NULL, environment, (void *)say, logging);
    if (made && made->instance) return made;
    free(made);
    return refused(environment, say, "out of memory");
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback say)
{
    Session *made = new_instance(name, token, logging, environment, say);
    (void)resources; (void)visible;
    if (made) made->instance->now.exchange = true;
    return made;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference required[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback say,
                                         fmi3IntermediateUpdateCallback update)
{
    Session *made = new_instance(name, token, logging, environment, say);
    (void)resources; (void)visible;
    if (!made) return NULL;
    made->event_mode = event_mode;
    made->early_return = early_return;
    made->update = update;
    for (size_t i = 0; i < count; i++) {
        const Variable *variable = required ? instance_variable(required[i]) : NULL;
        if (!variable || !variable->elements || variable->kind != REAL) {
            instance_say(made->instance, ERROR, "requiredIntermediateVariables: %s is not continuous",
                         variable ? instance_name(variable) : "what is not known");
            fmi3FreeInstance(made);
            return NULL;
        }
        if (!update || required[i] < INPUTS_AT || required[i] >= INPUTS_AT + INPUTS) continue;
        for (uint32_t j = 0; j < variable->elements; j++) made->given[required[i] - INPUTS_AT + j] = true;
        made->gives = true;
    }
    return made;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback say,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)update; (void)lock; (void)unlock;
    return refused(environment, say,
                   "scheduled execution: this FMU has no clocks; it is for co-simulation and model exchange");
}

void fmi3FreeInstance(fmi3Instance handle)
{
    if (!handle || INSTANCE->now.phase == INTERMEDIATE) return; /* in a step: it is still needed */
    instance_free(INSTANCE);
    free(handle);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop)
{
    NEEDS(INSTANTIATED, "fmi3EnterInitializationMode");
    (void)tolerance_defined; (void)tolerance; /* the component keeps its own, which is tighter */
    if (instance_set_times(INSTANCE, start, stop_defined, stop) != OK) return fmi3Error;
    INSTANCE->now.phase = INITIALIZING;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance handle)
{
    Status status;
    NEEDS(INITIALIZING, "fmi3ExitInitializationMode");
    status = instance_initialize(INSTANCE);
    if (status == OK) INSTANCE->now.phase = INSTANCE->now.exchange || SESSION->event_mode ? EVENT : STEPPING;
    return status;
}

fmi3Status fmi3EnterEventMode(fmi3Instance handle)
{
    NEEDS_THAT(INSTANCE->now.exchange || SESSION->event_mode, STEPPING | CONTINUOUS | EVENT, "fmi3EnterEventMode",
               "where fmi3InstantiateCoSimulation was told that event mode is not used");
    if (INSTANCE->now.phase == STEPPING && !INSTANCE->now.outputs_stale)
        instance_continue_inputs(INSTANCE); /* unless the host has set them */
    INSTANCE->now.phase = EVENT;
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance handle, fmi3Boolean *again, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals_changed, fmi3Boolean *states_changed,
                                    fmi3Boolean *next_defined, fmi3Float64 *next)
{
    Status status;
    NEEDS(EVENT, "fmi3UpdateDiscreteStates");
    if (!again || !terminate || !nominals_changed || !states_changed || !next_defined || !next)
        return instance_say(INSTANCE, ERROR, "fmi3UpdateDiscreteStates: no place for what it tells");
    status = instance_events(INSTANCE, states_changed, next);
    *again = *terminate = *nominals_changed = false;
    *next_defined = isfinite(*next);
    if (!*next_defined) *next = 0.0;
    return status;
}

/* Variables */

/* In a call from within a step the host sets those inputs that it said it would, and nothing else. */
static bool may_set(const Session *one, const char *call, const Elements *some)
{
    if (one->instance->now.phase != INTERMEDIATE) return true;
    if (!one->setting) {
        instance_say(one->instance, ERROR, "%s: inputs are not requested in this intermediate update", call);
        return false;
    }
    for (size_t i = 0; some->references && i < some->count; i++) {
        uint32_t at = some->references[i];
        if (at >= INPUTS_AT && at < INPUTS_AT + INPUTS && one->given[at - INPUTS_AT]) continue;
        instance_say(one->instance, ERROR, "%s: value reference %u is no input among the requiredIntermediateVariables",
                     call, (unsigned)at);
        return false;
    }
    return true;
}

/* Whether a call may be answered, which is to be followed by free(some->made); says why not. */

static bool to_set(const Session *one, const char *call, Elements *some, const uint32_t vr[], size_t count, size_t size)
{
    if (!elements_of(some, one->instance, call, vr, count, size, false)) return false;
    if (may_set(one, call, some)) return true;
    free(some->made);
    return false;
}

static bool to_get(const Session *one, const char *call, Elements *some, const uint32_t vr[], size_t count, size_t size)
{
    if (one->instance->now.phase != INTERMEDIATE || one->getting)
        return elements_of(some, one->instance, call, vr, count, size, true);
    instance_say(one->instance, ERROR, "%s: values cannot be read in this intermediate update", call);
    return false;
}

/* After `to_get`, and after values were got or not. Tools that know no arrays read all variables in one call, and take
   an error for zeros. */
static Status got(const Session *one, const char *call, Elements *some, Status status)
{
    free(some->made);
    if (status != OK || !some->missing) return status;
    return instance_say(one->instance, WARNING,
                        "%s: as many values as variables: of arrays the first elements, without %zu others", call,
                        some->missing);
}

fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, fmi3Float64 values[],
                          size_t size)
{
    Elements some;
    Status status;
    NEEDS(READABLE, "fmi3GetFloat64");
    if (!to_get(SESSION, "fmi3GetFloat64", &some, vr, count, size)) return fmi3Error;
    status = instance_get(INSTANCE, REAL, some.references, some.count, values);
    return got(SESSION, "fmi3GetFloat64", &some, status);
}

fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, const fmi3Float64 values[],
                          size_t size)
{
    Elements some;
    Status status;
    NEEDS(SETTABLE, "fmi3SetFloat64");
    if (!to_set(SESSION, "fmi3SetFloat64", &some, vr, count, size)) return fmi3Error;
    status = instance_set(INSTANCE, REAL, some.references, some.count, values);
    free(some.made);
    return status;
}

/* Whole numbers are doubles in the memory. Choices are of type Enumeration, and 64 bits wide. All can be set before
   any is. */
#define WHOLE(Type, KIND, LOW, HIGH)                                                                                   \
    fmi3Status fmi3Get##Type(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, fmi3##Type values[],    \
                             size_t size)                                                                              \
    {                                                                                                                  \
        Elements all;                                                                                                  \
        Status status = OK;                                                                                            \
        NEEDS(READABLE, "fmi3Get" #Type);                                                                              \
        if (!to_get(SESSION, "fmi3Get" #Type, &all, vr, count, size)) return fmi3Error;                                \
        for (size_t i = 0; i < all.count && status == OK; i += SOME) {                                                 \
            double some[SOME];                                                                                         \
            size_t n = all.count - i < SOME ? all.count - i : SOME;                                                    \
            const uint32_t *r = all.references ? all.references + i : NULL;                                            \
            status = instance_get(INSTANCE, KIND, r, n, values ? some : NULL);                                         \
            for (size_t j = 0; j < n && status == OK; j++)                                                             \
                values[i + j] = (fmi3##Type)instance_whole(some[j], LOW, HIGH);                                        \
        }                                                                                                              \
        return got(SESSION, "fmi3Get" #Type, &all, status);                                                            \
    }                                                                                                                  \
    fmi3Status fmi3Set##Type(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,                         \
                             const fmi3##Type values[], size_t size)                                                   \
    {                                                                                                                  \
        Elements all;                                                                                                  \
        Status status = OK;                                                                                            \
        NEEDS(SETTABLE, "fmi3Set" #Type);                                                                              \
        if (!to_set(SESSION, "fmi3Set" #Type, &all, vr, count, size)) return fmi3Error;                                \
        for (int set = 0; set < 2; set++)                                                                              \
            for (size_t i = 0; i < all.count && status == OK; i += SOME) {                                             \
                double some[SOME];                                                                                     \
                size_t n = all.count - i < SOME ? all.count - i : SOME;                                                \
                const uint32_t *r = all.references ? all.references + i : NULL;                                        \
                const double *v = values ? some : NULL;                                                                \
                for (size_t j = 0; v && j < n; j++) some[j] = (double)values[i + j];                                   \
                status = set ? instance_set(INSTANCE, KIND, r, n, v) : instance_can_set(INSTANCE, KIND, r, n, v);      \
            }                                                                                                          \
        free(all.made);                                                                                                \
        return status;                                                                                                 \
    }

WHOLE(Int32, INTEGER, INT32_MIN, INT32_MAX)
WHOLE(Int64, ENUMERATION, INT64_MIN, INT64_MAX)
WHOLE(Boolean, BOOLEAN, 0, 1)
