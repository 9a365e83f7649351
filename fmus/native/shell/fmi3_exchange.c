/* FMI 3.0 for model exchange over `unit`, and derivatives by variables. */
#include <math.h>
#include <stdlib.h>

#include "fmi3.h"

#define NEEDS_EXCHANGE(phases, call) NEEDS_THAT(UNIT->now.exchange, phases, call, "in co-simulation")

static Status sized(Unit *unit, size_t count, size_t expected, const void *values)
{
    if (count == expected && (values || !count)) return OK;
    return unit_say(unit, ERROR, "%zu values: there are %zu, and a place for them must be given", count, expected);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    NEEDS_EXCHANGE(EVENT, "fmi3EnterContinuousTimeMode");
    UNIT->now.phase = CONTINUOUS;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_set_state, fmi3Boolean *enter_event_mode,
                                       fmi3Boolean *terminate)
{
    NEEDS_EXCHANGE(CONTINUOUS, "fmi3CompletedIntegratorStep");
    (void)no_set_state;
    if (!enter_event_mode || !terminate)
        return unit_say(UNIT, ERROR, "fmi3CompletedIntegratorStep: no place for what it tells");
    *enter_event_mode = unit_event_is_due(UNIT);
    *terminate = fmi3False;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    NEEDS_EXCHANGE(EVENT | CONTINUOUS, "fmi3SetTime");
    if (!isfinite(time)) return unit_say(UNIT, ERROR, "time = %g s: must be finite", time);
    UNIT->now.data[T_AT] = time;
    UNIT->now.outputs_stale = true;
    return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 x[], size_t count)
{
    NEEDS_EXCHANGE(EVENT | CONTINUOUS, "fmi3SetContinuousStates");
    if (sized(UNIT, count, CONTINUOUS_STATES, x)) return fmi3Error;
    return unit_set_states(UNIT, x);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 x[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, "fmi3GetContinuousStates");
    if (sized(UNIT, count, CONTINUOUS_STATES, x)) return fmi3Error;
    unit_ready(UNIT, OUTPUTS_AT);
    unit_get_states(UNIT, x);
    return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 x[], size_t count)
{
    NEEDS_EXCHANGE(ANY, "fmi3GetNominalsOfContinuousStates");
    if (sized(UNIT, count, CONTINUOUS_STATES, x)) return fmi3Error;
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = nominal[continuous[i]];
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 dx[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, "fmi3GetContinuousStateDerivatives");
    if (sized(UNIT, count, CONTINUOUS_STATES, dx)) return fmi3Error;
    unit_derivatives(UNIT, dx);
    return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 g[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, "fmi3GetEventIndicators");
    if (sized(UNIT, count, GUARDS, g)) return fmi3Error;
    unit_indicators(UNIT, g);
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count)
{
    NEEDS_EXCHANGE(ANY, "fmi3GetNumberOfContinuousStates");
    if (!count) return unit_say(UNIT, ERROR, "fmi3GetNumberOfContinuousStates: no place for the number");
    *count = CONTINUOUS_STATES;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count)
{
    NEEDS_EXCHANGE(ANY, "fmi3GetNumberOfEventIndicators");
    if (!count) return unit_say(UNIT, ERROR, "fmi3GetNumberOfEventIndicators: no place for the number");
    *count = GUARDS;
    return fmi3OK;
}

/* Derivatives by variables */

static Status paired(Unit *unit, const char *call, size_t seeds, size_t of, size_t results, size_t by)
{
    if (seeds == of && results == by) return OK;
    return unit_say(unit, ERROR, "%s: %zu seeds for %zu scalars, %zu results for %zu", call, seeds, of, results, by);
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t n,
                                        const fmi3ValueReference knowns[], size_t m, const fmi3Float64 seed[],
                                        size_t seeds, fmi3Float64 sensitivity[], size_t results)
{
    NEEDS(DIFFERENTIABLE, "fmi3GetDirectionalDerivative");
    if (paired(UNIT, "fmi3GetDirectionalDerivative", seeds, m, results, n)) return fmi3Error;
    return unit_directional(UNIT, unknowns, n, knowns, m, seed, sensitivity);
}

/* One pass forward for each known variable. */
fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t n,
                                    const fmi3ValueReference knowns[], size_t m, const fmi3Float64 seed[],
                                    size_t seeds, fmi3Float64 sensitivity[], size_t results)
{
    Status status = OK;
    double *column;
    NEEDS(DIFFERENTIABLE, "fmi3GetAdjointDerivative");
    if (paired(UNIT, "fmi3GetAdjointDerivative", seeds, n, results, m)) return fmi3Error;
    if ((n && (!unknowns || !seed)) || (m && (!knowns || !sensitivity)))
        return unit_say(UNIT, ERROR, "no place for %zu results of %zu changes", m, n);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(seed[i]))
            return unit_say(UNIT, ERROR, "the seed of value reference %u = %g: must be finite", (unsigned)unknowns[i],
                            seed[i]);
    column = malloc((n + 1) * sizeof *column);
    if (!column) return unit_say(UNIT, ERROR, "out of memory");
    for (size_t j = 0; j < m && status == OK; j++) {
        status = unit_directional(UNIT, unknowns, n, &knowns[j], 1, &(double){1.0}, column);
        sensitivity[j] = 0.0;
        for (size_t i = 0; i < n && status == OK; i++) sensitivity[j] += seed[i] * column[i];
    }
    free(column);
    return status;
}
