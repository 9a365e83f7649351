/* FMI 3.0 over `instance`: model exchange, saved states and derivatives by variables. */
#include <math.h>
#include <stdlib.h>

#include "fmi3.h"
#include "common_calls.h"

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
