#include "instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernels.h"

/* A step must begin where the last one ended. Masters add up time in different ways, and a million additions
   lose about 1e-10 of it; what is left over is far below any step that makes sense. */
#define TIME_SLACK 1e-9
#define STEP_SLACK 1e-6

#define CALL(kernel, ...) kernel_##kernel(&(int64_t){0}, &(void *){NULL}, __VA_ARGS__)

/* Life */

Instance *instance_new(const char *name, Logger logger, void *environment, void *callback, bool logging)
{
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance) return NULL;
    instance->name = malloc(strlen(name) + 1);
    if (!instance->name) {
        free(instance);
        return NULL;
    }
    strcpy(instance->name, name);
    instance->logger = logger;
    instance->environment = environment;
    instance->callback = callback;
    instance->logging = logging;
    instance_reset(instance);
    return instance;
}

void instance_free(Instance *instance)
{
    if (instance) free(instance->name);
    free(instance);
}

void instance_reset(Instance *instance)
{
    const bool exchange = instance->now.exchange;
    memset(&instance->now, 0, sizeof instance->now);
    instance->now.exchange = exchange;
    memcpy(instance->now.data, beginning, sizeof beginning);
    /* Tables that kernels keep in their scratch say themselves what they are for; no result depends on them. */
    memset(instance->work, 0, sizeof instance->work);
    instance->now.phase = INSTANTIATED;
    instance->now.outputs_stale = instance->now.energies_stale = instance->now.rates_stale = true;
    instance->now.parameters_unchecked = true;
    instance->stop = INFINITY;
}

/* Messages */

Status instance_say(const Instance *instance, Status status, const char *format, ...)
{
    static const char *const categories[] = {"logAll", "logStatusWarning", "logStatusDiscard", "logStatusError",
                                             "logStatusFatal"};
    char message[MESSAGE];
    va_list arguments;
    if (!instance->logger || (status < DISCARD && !instance->logging)) return status;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    instance->logger(instance, status, categories[status], message);
    return status;
}

bool instance_may(const Instance *instance, int phases, const char *call)
{
    static const char *const names[] = {
        "instantiation", "initialisation",        "stepping", "an event", "continuous time",
        "termination",   "an intermediate update"};
    int now = 0;
    if (instance->now.phase & phases) return true;
    while (!(instance->now.phase >> now & 1)) now++;
    instance_say(instance, ERROR, "%s: not allowed %s %s", call, now == 0 || now == 5 ? "after" : "during", names[now]);
    return false;
}

/* Ranges */

static bool allowed(const Variable *variable, double value)
{
    if (!isfinite(value) || value < variable->low || value > variable->high) return false;
    if (variable->kind != REAL && value != floor(value)) return false;
    return !(variable->positive && value <= 0.0);
}

/* Found by passing all before it: they are read in messages only. */
static const char *text(size_t number)
{
    const char *found = texts;
    while (number--) found += strlen(found) + 1;
    return found;
}

const char *instance_name(const Variable *variable)
{
    return text(2 * (size_t)(variable - variables));
}

/* Adds the faults of `count` values to the message; false if there are none. */
static bool faults(const Variable *variable, const double *values, int count, char *message, size_t size)
{
    size_t used = strlen(message);
    bool any = false;
    for (int i = 0; i < count; i++) {
        if (allowed(&variable[i], values[i]) || used >= size) continue;
        used +=
            (size_t)snprintf(message + used, size - used, "%s%s = %g%s", used ? "; " : "", instance_name(&variable[i]),
                             values[i], text(2 * (size_t)(&variable[i] - variables) + 1));
        any = true;
    }
    return any;
}

static bool parameters_wrong(const Instance *instance, char *message, size_t size)
{
    return faults(variables, instance->now.data, PARAMETERS, message, size) ||
           instance_unmet(instance, requirements, message, size);
}

bool instance_refuses_parameters(Instance *instance, Status status)
{
    char message[1024] = "";
    if (!instance->now.parameters_unchecked) return false;
    if (parameters_wrong(instance, message, sizeof message)) {
        instance_say(instance, status, "%s", message);
        return true;
    }
    instance->now.parameters_unchecked = false;
    return false;
}

/* Motion */

/* The state as its start values say. */
static void begin(Instance *instance)
{
    double *data = instance->now.data;
    for (int i = 0; i < STARTED; i++) data[X_AT + started[i]] = data[STARTS_AT + i];
}

static bool start_wrong(Instance *instance, char *message, size_t size)
{
    begin(instance);
    return faults(variables + STARTS_AT, instance->now.data + STARTS_AT, STARTED, message, size) ||
           instance_unmet(instance, start_requirements, message, size);
}

/* Outputs of the values that are set, at the present time. */
static void refresh(Instance *instance)
{
    double *data = instance->now.data;
    if (instance->now.phase & (INSTANTIATED | INITIALIZING)) begin(instance);
    memcpy(data + U_AT, data + INPUTS_AT, INPUTS * sizeof *data);
    data[S_AT] = 0.0;
    CALL(output, data[T_AT], data + X_AT, data + U_AT, data, data + OUTPUTS_AT);
    instance->now.outputs_stale = false;
    instance->now.energies_stale = instance->now.rates_stale = true;
}

Status instance_initialize(Instance *instance)
{
    char message[1024] = "";
    if (parameters_wrong(instance, message, sizeof message) || start_wrong(instance, message, sizeof message))
        return instance_say(instance, ERROR, "%s", message);
    refresh(instance);
    instance->now.parameters_unchecked = false;
    return OK;
}

void instance_continue_inputs(Instance *instance)
{
    State *now = &instance->now;
    double s = now->data[S_AT];
    for (int i = 0; i < INPUTS; i++) {
        double *U = now->data + INPUTS_AT + i;
        U[0] = now->data[U_AT + i];
        U[INPUTS] += s * (U[2 * INPUTS] + s * U[3 * INPUTS] / 2.0);
        U[2 * INPUTS] += s * U[3 * INPUTS];
    }
    now->data[S_AT] = 0.0;
}

static Status refused(Instance *instance, int status, double time, double step)
{
    const double *data = instance->now.data;
    char message[1024] = "";
    for (int end = 0; end < 2; end++) {
        double u[INPUTS + 1] = {0.0}, s = end ? step : 0.0;
        const double *U = data + INPUTS_AT;
        for (int i = 0; i < INPUTS; i++)
            u[i] = U[i] + s * (U[INPUTS + i] + s * (U[2 * INPUTS + i] / 2.0 + s * U[3 * INPUTS + i] / 6.0));
        if (faults(variables + INPUTS_AT, u, INPUTS, message, sizeof message)) break;
    }
    return instance_say(instance, DISCARD, "step from t = %.9g s by %g s: %s%s%s", time, step,
                        status > 0 && status < FAILURES ? failures[status] : "it cannot be made", *message ? "; " : "",
                        message);
}

Status instance_step(Instance *instance, double time, double step)
{
    double *data = instance->now.data, t = data[T_AT], u[INPUTS + 1], y[OUTPUTS + 1];
    int64_t status = 0;
    if (!(step >= 0.0 && step < INFINITY))
        return instance_say(instance, DISCARD, "step size = %g s: must be finite, and not negative", step);
    if (!(fabs(time - t) <= TIME_SLACK * (1.0 + fabs(t)) + STEP_SLACK * step) || isinf(time + step))
        return instance_say(
            instance, DISCARD,
            "step from t = %.12g s by %g s: must begin at %.12g s, where the state is, and end at a time", time, step,
            t);
    if (instance_refuses_parameters(instance, DISCARD)) return DISCARD;
    kernel_step(&status, &(void *){NULL}, time, step, data + X_AT, data + INPUTS_AT, data, nominal, instance->work, u,
                y);
    if (status) return refused(instance, (int)status, time, step);
    memcpy(data + U_AT, u, INPUTS * sizeof *u);
    memcpy(data + OUTPUTS_AT, y, OUTPUTS * sizeof *y);
    data[T_AT] = time + step;
    data[S_AT] = step;
    instance->now.outputs_stale = false;
    instance->now.energies_stale = instance->now.rates_stale = true;
    return OK;
}

/* Variables */

const Variable *instance_variable(uint32_t reference)
{
    if (reference < VARIABLES + STATES) return &variables[reference];
    if (reference >= DX_AT && reference < GUARDS_AT) return &variables[VARIABLES + reference - DX_AT];
    if (reference == T_AT) return &variables[VARIABLES + STATES];
    if (reference >= GUARDS_AT && reference < GUARDS_AT + GUARDS)
        return &variables[VARIABLES + STATES + 1 + reference - GUARDS_AT];
    return NULL;
}

static bool passes(Kind kind, Kind variable)
{
    return kind == variable || (integers_are_choices && kind == INTEGER && variable == ENUMERATION);
}

/* Whether the references are of variables of that kind. */
static bool known(const Instance *instance, Kind kind, const uint32_t *references, size_t count, const void *values)
{
    if (count && (!references || !values)) {
        instance_say(instance, ERROR, "no place for %zu values", count);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        const Variable *variable = instance_variable(references[i]);
        if (!variable) {
            instance_say(instance, ERROR, "there is no value reference %u", (unsigned)references[i]);
            return false;
        }
        if (!passes(kind, variable->kind)) {
            instance_say(instance, ERROR, "%s is not of type %s but %s", instance_name(variable), kinds[kind],
                         kinds[variable->kind]);
            return false;
        }
    }
    return true;
}

/* States of model exchange are given by the host, one by one too (FMI 3.0.2, 3.2.1). */
static bool is_given_state(const Instance *instance, uint32_t reference)
{
    if (!states_are_settable || !(instance->now.phase & CONTINUOUS)) return false;
    for (int i = 0; i < CONTINUOUS_STATES; i++)
        if (reference == (uint32_t)(X_AT + continuous[i])) return true;
    return false;
}

static bool settable(const Instance *instance, uint32_t reference, double value)
{
    const Variable *variable = instance_variable(reference);
    bool calculated = variable->causality == OUTPUT || variable->causality == LOCAL;
    if (calculated && !is_given_state(instance, reference))
        instance_say(instance, ERROR, "%s is calculated: it cannot be set", instance_name(variable));
    else if (variable->fixed && !calculated && !(instance->now.phase & (INSTANTIATED | INITIALIZING)))
        instance_say(instance, ERROR, "%s is fixed: it cannot be set after initialisation", instance_name(variable));
    else if (!isfinite(value)) instance_say(instance, ERROR, "%s = %g: must be finite", instance_name(variable), value);
    else return true;
    return false;
}

Status instance_can_set(const Instance *instance, Kind kind, const uint32_t *references, size_t count,
                        const double *values)
{
    if (!known(instance, kind, references, count, values)) return ERROR;
    for (size_t i = 0; i < count; i++)
        if (!settable(instance, references[i], values[i])) return ERROR;
    return OK;
}

Status instance_set(Instance *instance, Kind kind, const uint32_t *references, size_t count, const double *values)
{
    if (instance_can_set(instance, kind, references, count, values) != OK) return ERROR;
    for (size_t i = 0; i < count; i++) {
        instance->now.data[references[i]] = values[i];
        if (references[i] < INPUTS_AT) instance->now.parameters_unchecked = true;
    }
    instance->now.outputs_stale = true;
    return OK;
}

void instance_ready(Instance *instance, uint32_t highest)
{
    State *now = &instance->now;
    double *data = now->data;
    if (highest < OUTPUTS_AT) return;
    if (now->outputs_stale) refresh(instance);
    if (highest >= ENERGIES_AT && now->energies_stale) {
        CALL(energy, data[T_AT], data + X_AT, data + U_AT, data, data + ENERGIES_AT);
        now->energies_stale = false;
    }
    if (highest >= RATES_AT && now->rates_stale) {
        CALL(slopes, data + INPUTS_AT, data[S_AT], instance->slopes);
        CALL(rates, data[T_AT], data + X_AT, data + U_AT, instance->slopes, data, instance->rates_work,
             instance->all_rates);
        for (int i = 0; i < RATED; i++) data[RATES_AT + i] = instance->all_rates[rated[i]];
        now->rates_stale = false;
    }
}

static bool all_finite(const double *values, int count)
{
    while (count && isfinite(values[count - 1])) count--;
    return !count;
}

/* The states, each moved into its range. A law that has no value for trial states of a host's solver goes on as at the
   limit: then a solver that ignores DISCARD comes back, too. */
static const double *move_inside(const Instance *instance, double *x)
{
    for (int i = 0; i < STATES; i++) {
        const Variable *state = &variables[X_AT + i];
        double least = state->positive ? fmax(state->low, DBL_EPSILON * nominal[i]) : state->low;
        x[i] = fmin(fmax(instance->now.data[X_AT + i], least), state->high);
    }
    return x;
}

void instance_all_derivatives(Instance *instance, double *dx)
{
    double x[STATES + 1] = {0};
    const double *data = instance->now.data;
    instance_ready(instance, OUTPUTS_AT);
    CALL(derivative, data[T_AT], data + X_AT, data + U_AT, data, dx);
    if (!all_finite(dx, STATES)) CALL(derivative, data[T_AT], move_inside(instance, x), data + U_AT, data, dx);
}

Status instance_undefined(const Instance *instance, uint32_t reference, double value)
{
    char message[1024] = "";
    faults(variables + X_AT, instance->now.data + X_AT, STATES, message, sizeof message);
    faults(variables + INPUTS_AT, instance->now.data + INPUTS_AT, INPUTS, message, sizeof message);
    return instance_say(instance, DISCARD, "%s%s = %g at t = %.9g s: must be finite; %s",
                        reference < GUARDS_AT ? "derivative of " : "", instance_name(instance_variable(reference)),
                        value, instance->now.data[T_AT],
                        *message ? message : "its law has no value for these states and inputs");
}

void instance_indicators(Instance *instance, double *g)
{
#if GUARDS
    const double *data = instance->now.data;
    instance_ready(instance, OUTPUTS_AT);
    double x[STATES + 1] = {0};
    CALL(guards, data[T_AT], data + X_AT, data + U_AT, data, g);
    if (!all_finite(g, GUARDS)) CALL(guards, data[T_AT], move_inside(instance, x), data + U_AT, data, g);
#else
    (void)instance; (void)g;
#endif
}

Status instance_get(Instance *instance, Kind kind, const uint32_t *references, size_t count, double *values)
{
    uint32_t highest = 0, stale = 0;
    if (!known(instance, kind, references, count, values)) return ERROR;
    for (size_t i = 0; i < count; i++) {
        uint32_t computed = references[i] < X_AT ? references[i] : OUTPUTS_AT; /* states go with the outputs */
        if (references[i] > highest) highest = references[i];
        if (computed > stale) stale = computed;
    }
    instance_ready(instance, stale);
    if (highest >= DX_AT) instance_all_derivatives(instance, instance->dx);
    if (highest >= GUARDS_AT) instance_indicators(instance, instance->guards);
    for (size_t i = 0; i < count; i++) {
        uint32_t at = references[i];
        values[i] = at < DX_AT       ? instance->now.data[at]
                    : at < GUARDS_AT ? instance->dx[at - DX_AT]
                                     : instance->guards[at - GUARDS_AT];
    }
    return OK;
}

int64_t instance_whole(double value, int64_t low, int64_t high)
{
    if (!(value > (double)low)) return low;
    return value < (double)high ? (int64_t)value : high;
}
