#include <math.h>
#include <string.h>

#include "kernels.h"
#include "unit.h"

/* What changes: time stands still, as the standard has it. */
typedef struct {
    double x[STATES + 1], u[INPUTS + 1], p[PARAMETERS + 1];
} Seed;

/* Puts the change of one known variable into the seed; says so if it is none. */
static Status seed_with(const Unit *unit, Seed *seed, uint32_t known, double change)
{
    bool exchanging = unit->now.phase & (EVENT | CONTINUOUS), starting = unit->now.phase & (INSTANTIATED | INITIALIZING);
    if (!isfinite(change))
        return unit_say(unit, ERROR, "the change of value reference %u = %g: must be finite", (unsigned)known, change);
    if (known >= INPUTS_AT && known < INPUTS_AT + INPUTS && variables[known].kind == REAL) seed->u[known - INPUTS_AT] = change;
    else if (known < PARAMETERS && variables[known].kind == REAL) seed->p[known] = change;
    else if (starting && known >= STARTS_AT && known < STARTS_AT + STARTED)
        seed->x[started[known - STARTS_AT]] = change;
    else if (exchanging && known >= X_AT && known < X_AT + STATES) seed->x[known - X_AT] = change;
    else
        return unit_say(unit, ERROR, "value reference %u: derivatives are by inputs, parameters and states",
                        (unsigned)known);
    return OK;
}

Status unit_directional(Unit *unit, const uint32_t *unknown, size_t unknowns, const uint32_t *known, size_t knowns,
                        const double *changes, double *result)
{
    Seed seed = {0};
    const double *data = unit->now.data;
    double value[OUTPUTS + STATES], changed[OUTPUTS + 1] = {0}, bent[STATES + 1] = {0};
    if ((unknowns && (!unknown || !result)) || (knowns && (!known || !changes)))
        return unit_say(unit, ERROR, "no place for %zu results of %zu changes", unknowns, knowns);
    for (size_t i = 0; i < knowns; i++)
        if (seed_with(unit, &seed, known[i], changes[i]) != OK) return ERROR;
    unit_ready(unit, OUTPUTS_AT);
    tangent_output(&(int64_t){0}, &(void *){NULL}, data[T_AT], 0.0, data + X_AT, seed.x, data + U_AT, seed.u, data,
                   seed.p, value, changed);
    tangent_derivative(&(int64_t){0}, &(void *){NULL}, data[T_AT], 0.0, data + X_AT, seed.x, data + U_AT, seed.u,
                       data, seed.p, value, bent);
    for (size_t i = 0; i < unknowns; i++) {
        uint32_t at = unknown[i];
        if (at >= OUTPUTS_AT && at < OUTPUTS_AT + OUTPUTS && variables[at].kind == REAL) result[i] = changed[at - OUTPUTS_AT];
        else if (at >= DX_AT && at < DX_AT + STATES) result[i] = bent[at - DX_AT];
        else
            return unit_say(unit, ERROR, "value reference %u: derivatives are of outputs and of states' derivatives",
                            (unsigned)at);
    }
    return OK;
}
