#include "unit.h"

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

Unit *unit_new(const char *name, Logger logger, void *environment, void *callback, bool logging)
{
    Unit *unit = calloc(1, sizeof *unit);
    if (!unit) return NULL;
    unit->name = malloc(strlen(name) + 1);
    if (!unit->name) {
        free(unit);
        return NULL;
    }
    strcpy(unit->name, name);
    unit->logger = logger;
    unit->environment = environment;
    unit->callback = callback;
    unit->logging = logging;
    unit_reset(unit);
    return unit;
}

void unit_free(Unit *unit)
{
    if (unit) free(unit->name);
    free(unit);
}

void unit_reset(Unit *unit)
{
    const bool exchange = unit->now.exchange;
    memset(&unit->now, 0, sizeof unit->now);
    unit->now.exchange = exchange;
    memcpy(unit->now.data, beginning, sizeof beginning);
    /* Tables that kernels keep in their scratch say themselves what they are for; no result depends on them. */
    memset(unit->work, 0, sizeof unit->work);
    unit->now.phase = INSTANTIATED;
    unit->now.outputs_stale = unit->now.energies_stale = unit->now.rates_stale = true;
    unit->now.parameters_unchecked = true;
    unit->stop = INFINITY;
}

/* Messages */

Status unit_say(const Unit *unit, Status status, const char *format, ...)
{
    static const char *const categories[] = {"logAll", "logStatusWarning", "logStatusDiscard", "logStatusError",
                                             "logStatusFatal"};
    char message[MESSAGE];
    va_list arguments;
    if (!unit->logger || (status < DISCARD && !unit->logging)) return status;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    unit->logger(unit, status, categories[status], message);
    return status;
}

bool unit_may(const Unit *unit, int phases, const char *call)
{
    static const char *const names[] = {"instantiation", "initialisation", "stepping", "an event", "continuous time",
                                        "termination", "an intermediate update"};
    int now = 0;
    if (unit->now.phase & phases) return true;
    while (!(unit->now.phase >> now & 1)) now++;
    unit_say(unit, ERROR, "%s: not allowed %s %s", call, now == 0 || now == 5 ? "after" : "during", names[now]);
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

const char *unit_name(const Variable *variable)
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
        used += (size_t)snprintf(message + used, size - used, "%s%s = %g%s", used ? "; " : "",
                                 unit_name(&variable[i]), values[i],
                                 text(2 * (size_t)(&variable[i] - variables) + 1));
        any = true;
    }
    return any;
}

static bool parameters_wrong(const Unit *unit, char *message, size_t size)
{
    return faults(variables, unit->now.data, PARAMETERS, message, size) ||
           unit_unmet(unit, requirements, message, size);
}

bool unit_refuses_parameters(Unit *unit, Status status)
{
    char message[1024] = "";
    if (!unit->now.parameters_unchecked) return false;
    if (parameters_wrong(unit, message, sizeof message)) {
        unit_say(unit, status, "%s", message);
        return true;
    }
    unit->now.parameters_unchecked = false;
    return false;
}

/* Motion */

/* The state as its start values say. */
static void begin(Unit *unit)
{
    double *data = unit->now.data;
    for (int i = 0; i < STARTED; i++) data[X_AT + started[i]] = data[STARTS_AT + i];
}

static bool start_wrong(Unit *unit, char *message, size_t size)
{
    begin(unit);
    return faults(variables + STARTS_AT, unit->now.data + STARTS_AT, STARTED, message, size) ||
           unit_unmet(unit, start_requirements, message, size);
}

/* Outputs of the values that are set, at the present time. */
static void refresh(Unit *unit)
{
    double *data = unit->now.data;
    if (unit->now.phase & (INSTANTIATED | INITIALIZING)) begin(unit);
    memcpy(data + U_AT, data + INPUTS_AT, INPUTS * sizeof *data);
    data[S_AT] = 0.0;
    CALL(output, data[T_AT], data + X_AT, data + U_AT, data, data + OUTPUTS_AT);
    unit->now.outputs_stale = false;
    unit->now.energies_stale = unit->now.rates_stale = true;
}

Status unit_initialize(Unit *unit)
{
    char message[1024] = "";
    if (parameters_wrong(unit, message, sizeof message) || start_wrong(unit, message, sizeof message))
        return unit_say(unit, ERROR, "%s", message);
    refresh(unit);
    unit->now.parameters_unchecked = false;
    return OK;
}

static Status refused(Unit *unit, int status, double time, double step)
{
    const double *data = unit->now.data;
    char message[1024] = "";
    for (int end = 0; end < 2; end++) {
        double u[INPUTS + 1], s = end ? step : 0.0;
        const double *U = data + INPUTS_AT;
        for (int i = 0; i < INPUTS; i++)
            u[i] = U[i] + s * (U[INPUTS + i] + s * (U[2 * INPUTS + i] / 2.0 + s * U[3 * INPUTS + i] / 6.0));
        if (faults(variables + INPUTS_AT, u, INPUTS, message, sizeof message)) break;
    }
    return unit_say(unit, DISCARD, "step from t = %.9g s by %g s: %s%s%s", time, step,
                    status > 0 && status < FAILURES ? failures[status] : "it cannot be made", *message ? "; " : "",
                    message);
}

Status unit_step(Unit *unit, double time, double step)
{
    double *data = unit->now.data, t = data[T_AT], u[INPUTS + 1], y[OUTPUTS + 1];
    int64_t status = 0;
    if (!(step >= 0.0 && step < INFINITY))
        return unit_say(unit, DISCARD, "step size = %g s: must be finite, and not negative", step);
    if (!(fabs(time - t) <= TIME_SLACK * (1.0 + fabs(t)) + STEP_SLACK * step) || isinf(time + step))
        return unit_say(unit, DISCARD,
                        "step from t = %.12g s by %g s: must begin at %.12g s, where the state is, and end at a time",
                        time, step, t);
    if (unit_refuses_parameters(unit, DISCARD)) return DISCARD;
    kernel_step(&status, &(void *){NULL}, time, step, data + X_AT, data + INPUTS_AT, data, nominal, unit->work,
                u, y);
    if (status) return refused(unit, (int)status, time, step);
    memcpy(data + U_AT, u, INPUTS * sizeof *u);
    memcpy(data + OUTPUTS_AT, y, OUTPUTS * sizeof *y);
    data[T_AT] = time + step;
    data[S_AT] = step;
    unit->now.outputs_stale = false;
    unit->now.energies_stale = unit->now.rates_stale = true;
    return OK;
}

/* Variables */

const Variable *unit_variable(uint32_t reference)
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
static bool known(const Unit *unit, Kind kind, const uint32_t *references, size_t count, const void *values)
{
    if (count && (!references || !values)) {
        unit_say(unit, ERROR, "no place for %zu values", count);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        const Variable *variable = unit_variable(references[i]);
        if (!variable) {
            unit_say(unit, ERROR, "there is no value reference %u", (unsigned)references[i]);
            return false;
        }
        if (!passes(kind, variable->kind)) {
            unit_say(unit, ERROR, "%s is not of type %s but %s", unit_name(variable), kinds[kind],
                     kinds[variable->kind]);
            return false;
        }
    }
    return true;
}

static bool settable(const Unit *unit, const Variable *variable, double value)
{
    if (variable->causality == OUTPUT || variable->causality == LOCAL)
        unit_say(unit, ERROR, "%s is calculated: it cannot be set", unit_name(variable));
    else if (variable->fixed && !(unit->now.phase & (INSTANTIATED | INITIALIZING)))
        unit_say(unit, ERROR, "%s is fixed: it cannot be set after initialisation", unit_name(variable));
    else if (!isfinite(value))
        unit_say(unit, ERROR, "%s = %g: must be finite", unit_name(variable), value);
    else
        return true;
    return false;
}

Status unit_can_set(const Unit *unit, Kind kind, const uint32_t *references, size_t count, const double *values)
{
    if (!known(unit, kind, references, count, values)) return ERROR;
    for (size_t i = 0; i < count; i++)
        if (!settable(unit, unit_variable(references[i]), values[i])) return ERROR;
    return OK;
}

Status unit_set(Unit *unit, Kind kind, const uint32_t *references, size_t count, const double *values)
{
    if (unit_can_set(unit, kind, references, count, values) != OK) return ERROR;
    for (size_t i = 0; i < count; i++) {
        unit->now.data[references[i]] = values[i];
        if (references[i] < INPUTS_AT) unit->now.parameters_unchecked = true;
    }
    unit->now.outputs_stale = true;
    return OK;
}

void unit_ready(Unit *unit, uint32_t highest)
{
    State *now = &unit->now;
    double *data = now->data;
    if (highest < OUTPUTS_AT) return;
    if (now->outputs_stale) refresh(unit);
    if (highest >= ENERGIES_AT && now->energies_stale) {
        CALL(energy, data[T_AT], data + X_AT, data + U_AT, data, data + ENERGIES_AT);
        now->energies_stale = false;
    }
    if (highest >= RATES_AT && now->rates_stale) {
        CALL(slopes, data + INPUTS_AT, data[S_AT], unit->slopes);
        CALL(rates, data[T_AT], data + X_AT, data + U_AT, unit->slopes, data, unit->rates_work, unit->all_rates);
        for (int i = 0; i < RATED; i++) data[RATES_AT + i] = unit->all_rates[rated[i]];
        now->rates_stale = false;
    }
}

Status unit_get(Unit *unit, Kind kind, const uint32_t *references, size_t count, double *values)
{
    uint32_t highest = 0, stale = 0;
    if (!known(unit, kind, references, count, values)) return ERROR;
    for (size_t i = 0; i < count; i++) {
        uint32_t computed = references[i] < X_AT ? references[i] : OUTPUTS_AT; /* states go with the outputs */
        if (references[i] > highest) highest = references[i];
        if (computed > stale) stale = computed;
    }
    unit_ready(unit, stale);
    if (highest >= DX_AT) unit_all_derivatives(unit, unit->dx);
    if (highest >= GUARDS_AT) unit_indicators(unit, unit->guards);
    for (size_t i = 0; i < count; i++) {
        uint32_t at = references[i];
        values[i] = at < DX_AT ? unit->now.data[at] : at < GUARDS_AT ? unit->dx[at - DX_AT] : unit->guards[at - GUARDS_AT];
    }
    return OK;
}

int64_t unit_whole(double value, int64_t low, int64_t high)
{
    if (!(value > (double)low)) return low;
    return value < (double)high ? (int64_t)value : high;
}

/* Saved states */

static const char header[] = "tribocosim native state 1 " DIGEST;

static uint64_t checksum(const unsigned char *bytes, size_t size)
{
    uint64_t sum = 14695981039346656037u; /* FNV-1a */
    for (size_t i = 0; i < size; i++) sum = (sum ^ bytes[i]) * 1099511628211u;
    return sum;
}

size_t unit_saved_size(void)
{
    return sizeof header + sizeof(State) + sizeof(uint64_t);
}

void unit_save(const State *state, unsigned char *bytes)
{
    uint64_t sum;
    memcpy(bytes, header, sizeof header);
    memcpy(bytes + sizeof header, state, sizeof *state);
    sum = checksum(bytes, sizeof header + sizeof *state);
    memcpy(bytes + sizeof header + sizeof *state, &sum, sizeof sum);
}

Status unit_restore(const Unit *unit, State *state, const unsigned char *bytes, size_t size)
{
    uint64_t sum;
    if (size < sizeof header || memcmp(bytes, header, sizeof header))
        return unit_say(unit, ERROR, "the saved state is not of this FMU and version");
    if (size != unit_saved_size())
        return unit_say(unit, ERROR, "the saved state is damaged: %zu bytes: must be %zu", size, unit_saved_size());
    memcpy(&sum, bytes + sizeof header + sizeof *state, sizeof sum);
    if (sum != checksum(bytes, sizeof header + sizeof *state))
        return unit_say(unit, ERROR, "the saved state is damaged: its sum does not match");
    memcpy(state, bytes + sizeof header, sizeof *state);
    return OK;
}
