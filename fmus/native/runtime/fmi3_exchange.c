/* FMI 3.0 for model exchange over `instance`, and derivatives by variables. */
#include <math.h>
#include <stdlib.h>

#include "fmi3.h"

#define NEEDS_EXCHANGE(phases, call) NEEDS_THAT(INSTANCE->now.exchange, phases, call, "in co-simulation")

static Status sized(Instance *instance, size_t count, size_t expected, const void *values)
{
    if (count == expected && (values || !count)) return OK;
    return instance_say(instance, ERROR, "%zu values: there are %zu, and a place for them must be given", count,
                        expected);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance handle)
{
    NEEDS_EXCHANGE(EVENT, "fmi3EnterContinuousTimeMode");
    INSTANCE->now.phase = CONTINUOUS;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance handle, fmi3Boolean no_set_state, fmi3Boolean *enter_event_mode,
                                       fmi3Boolean *terminate)
{
    NEEDS_EXCHANGE(CONTINUOUS, "fmi3CompletedIntegratorStep");
    (void)no_set_state;
    if (!enter_event_mode || !terminate)
        return instance_say(INSTANCE, ERROR, "fmi3CompletedIntegratorStep: no place for what it tells");
    *enter_event_mode = instance_event_is_due(INSTANCE);
    *terminate = fmi3False;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance handle, fmi3Float64 time)
{
    NEEDS_EXCHANGE(EVENT | CONTINUOUS, "fmi3SetTime");
    if (!isfinite(time)) return instance_say(INSTANCE, ERROR, "time = %g s: must be finite", time);
    INSTANCE->now.data[T_AT] = time;
    INSTANCE->now.outputs_stale = true;
    return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance handle, const fmi3Float64 x[], size_t count)
{
    NEEDS_EXCHANGE(EVENT | CONTINUOUS, "fmi3SetContinuousStates");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, x)) return fmi3Error;
    return instance_set_states(INSTANCE, x);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance handle, fmi3Float64 x[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, "fmi3GetContinuousStates");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, x)) return fmi3Error;
    instance_ready(INSTANCE, OUTPUTS_AT);
    instance_get_states(INSTANCE, x);
    return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance handle, fmi3Float64 x[], size_t count)
{
    NEEDS_EXCHANGE(ANY, "fmi3GetNominalsOfContinuousStates");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, x)) return fmi3Error;
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = nominal[continuous[i]];
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance handle, fmi3Float64 dx[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, "fmi3GetContinuousStateDerivatives");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, dx)) return fmi3Error;
    instance_derivatives(INSTANCE, dx);
    return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance handle, fmi3Float64 g[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, "fmi3GetEventIndicators");
    if (sized(INSTANCE, count, GUARDS, g)) return fmi3Error;
    instance_indicators(INSTANCE, g);
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance handle, size_t *count)
{
    NEEDS_EXCHANGE(ANY, "fmi3GetNumberOfContinuousStates");
    if (!count) return instance_say(INSTANCE, ERROR, "fmi3GetNumberOfContinuousStates: no place for the number");
    *count = CONTINUOUS_STATES;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance handle, size_t *count)
{
    NEEDS_EXCHANGE(ANY, "fmi3GetNumberOfEventIndicators");
    if (!count) return instance_say(INSTANCE, ERROR, "fmi3GetNumberOfEventIndicators: no place for the number");
    *count = GUARDS;
    return fmi3OK;
}

/* Derivatives by variables */

/* One pass forward for each known variable. */
static Status adjoint(Instance *instance, const Elements *unknowns, const Elements *knowns, const double *seed,
                      double *result)
{
    Status status = OK;
    double *column;
    size_t n = unknowns->count, m = knowns->count;
    if ((n && (!unknowns->references || !seed)) || (m && (!knowns->references || !result)))
        return instance_say(instance, ERROR, "no place for %zu results of %zu changes", m, n);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(seed[i]))
            return instance_say(instance, ERROR, "the seed of value reference %u = %g: must be finite",
                                (unsigned)unknowns->references[i], seed[i]);
    column = malloc((n + 1) * sizeof *column);
    if (!column) return instance_say(instance, ERROR, "out of memory");
    for (size_t j = 0; j < m && status == OK; j++) {
        double sum = 0.0;
        status =
            instance_directional(instance, unknowns->references, n, &knowns->references[j], 1, &(double){1.0}, column);
        for (size_t i = 0; i < n && status == OK; i++) sum += seed[i] * column[i];
        result[j] = sum;
    }
    free(column);
    return status;
}

static Status derivatives(Instance *instance, const char *call, const fmi3ValueReference unknowns[], size_t n,
                          size_t values, const fmi3ValueReference knowns[], size_t m, size_t changes, bool backward,
                          const double *seed, double *result)
{
    Elements of, by;
    Status status;
    if (!elements_of(&of, instance, call, unknowns, n, values, false)) return ERROR;
    if (!elements_of(&by, instance, call, knowns, m, changes, false)) {
        free(of.made);
        return ERROR;
    }
    if (backward) status = adjoint(instance, &of, &by, seed, result);
    else status = instance_directional(instance, of.references, of.count, by.references, by.count, seed, result);
    free(of.made);
    free(by.made);
    return status;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[], size_t n,
                                        const fmi3ValueReference knowns[], size_t m, const fmi3Float64 seed[],
                                        size_t seeds, fmi3Float64 sensitivity[], size_t results)
{
    NEEDS(DIFFERENTIABLE, "fmi3GetDirectionalDerivative");
    return derivatives(INSTANCE, "fmi3GetDirectionalDerivative", unknowns, n, results, knowns, m, seeds, false, seed,
                       sensitivity);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[], size_t n,
                                    const fmi3ValueReference knowns[], size_t m, const fmi3Float64 seed[], size_t seeds,
                                    fmi3Float64 sensitivity[], size_t results)
{
    NEEDS(DIFFERENTIABLE, "fmi3GetAdjointDerivative");
    return derivatives(INSTANCE, "fmi3GetAdjointDerivative", unknowns, n, seeds, knowns, m, results, true, seed,
                       sensitivity);
}
