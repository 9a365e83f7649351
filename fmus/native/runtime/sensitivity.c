#include <math.h>
#include <string.h>

#include "kernels.h"
#include "instance.h"

/* What changes: time stands still, as the standard has it. */
typedef struct {
    double x[STATES + 1], u[INPUTS + 1], slopes[INPUTS + 1], p[PARAMETERS + 1];
} Seed;

/* Puts the change of one known variable into the seed; says so if it is none. An input's derivatives are those at the
   present time, as if they were set now, so that of what is calculated only rates depend on the first. */
static Status seed_with(const Instance *instance, Seed *seed, uint32_t known, double change)
{
    bool starting = instance->now.phase & (INSTANTIATED | INITIALIZING); /* then states follow their start values */
    if (!isfinite(change))
        return instance_say(instance, ERROR, "the change of value reference %u = %g: must be finite", (unsigned)known,
                            change);
    if (known >= INPUTS_AT && known < OUTPUTS_AT && variables[known].kind == REAL) {
        if (known < INPUTS_AT + INPUTS) seed->u[known - INPUTS_AT] = change;
        else if (known < INPUTS_AT + 2 * INPUTS) seed->slopes[known - INPUTS_AT - INPUTS] = change;
    } else if (known < PARAMETERS && variables[known].kind == REAL) seed->p[known] = change;
    else if (starting && known >= STARTS_AT && known < STARTS_AT + STARTED)
        seed->x[started[known - STARTS_AT]] = change;
    else if (!starting && known >= X_AT && known < X_AT + STATES && variables[known].kind == REAL)
        seed->x[known - X_AT] = change;
    else
        return instance_say(instance, ERROR, "value reference %u: derivatives are by inputs, parameters and states",
                            (unsigned)known);
    return OK;
}

static bool any(const uint32_t *references, size_t count, uint32_t from, uint32_t to)
{
    for (size_t i = 0; i < count; i++)
        if (references[i] >= from && references[i] < to) return true;
    return false;
}

/* Where the change of what is calculated lies, as its value in the memory and after it. */
#define AT(reference) (changes + (reference) - OUTPUTS_AT)
#define TANGENT_AT(kernel, change)                                                                                     \
    tangent_##kernel(&(int64_t){0}, &(void *){NULL}, data[T_AT], 0.0, data + X_AT, seed->x, data + U_AT, seed->u,      \
                     data, seed->p, value, change)

/* The changes of what these references need, and perhaps of others. */
static void change(Instance *instance, const Seed *seed, const uint32_t *unknown, size_t unknowns, double *changes)
{
    const double *data = instance->now.data;
    double value[OUTPUTS + STATES + GUARDS + 3];
    instance_ready(instance, OUTPUTS_AT);
    memcpy(AT(X_AT), seed->x, STATES * sizeof *changes);
    if (any(unknown, unknowns, OUTPUTS_AT, ENERGIES_AT)) TANGENT_AT(output, AT(OUTPUTS_AT));
    if (any(unknown, unknowns, ENERGIES_AT, RATES_AT)) TANGENT_AT(energy, AT(ENERGIES_AT));
    if (any(unknown, unknowns, RATES_AT, X_AT)) {
        double dwork[RATES_WORK_SIZE], turned[OUTPUTS + 1];
        kernel_slopes(&(int64_t){0}, &(void *){NULL}, data + INPUTS_AT, data[S_AT], instance->slopes);
        tangent_rates(&(int64_t){0}, &(void *){NULL}, data[T_AT], 0.0, data + X_AT, seed->x, data + U_AT, seed->u,
                      instance->slopes, seed->slopes, data, seed->p, instance->rates_work, dwork, value, turned);
        for (int i = 0; i < RATED; i++) AT(RATES_AT)[i] = turned[rated[i]];
    }
    if (any(unknown, unknowns, DX_AT, GUARDS_AT)) TANGENT_AT(derivative, AT(DX_AT));
#if GUARDS
    if (any(unknown, unknowns, GUARDS_AT, GUARDS_AT + GUARDS)) TANGENT_AT(guards, AT(GUARDS_AT));
#endif
}

Status instance_directional(Instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                            size_t knowns, const double *changes, double *result)
{
    Seed seed = {0};
    double changed[GUARDS_AT + GUARDS - OUTPUTS_AT];
    if ((unknowns && (!unknown || !result)) || (knowns && (!known || !changes)))
        return instance_say(instance, ERROR, "no place for %zu results of %zu changes", unknowns, knowns);
    for (size_t i = 0; i < knowns; i++)
        if (seed_with(instance, &seed, known[i], changes[i]) != OK) return ERROR;
    for (size_t i = 0; i < unknowns; i++) {
        const Variable *variable = instance_variable(unknown[i]);
        if (!variable || variable->kind != REAL || unknown[i] < OUTPUTS_AT || unknown[i] == T_AT)
            return instance_say(instance, ERROR,
                                "value reference %u: derivatives are of what is calculated and continuous",
                                (unsigned)unknown[i]);
    }
    change(instance, &seed, unknown, unknowns, changed);
    for (size_t i = 0; i < unknowns; i++) result[i] = changed[unknown[i] - OUTPUTS_AT];
    return OK;
}
