/* What hosts ask in the same way in every version of FMI: times, kept states, derivatives of outputs by time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

/* Room for rounding where the host adds up time to the stop time, relative to 1 s or to the time itself. */
#define STOP_SLACK 1e-9

Status instance_set_times(Instance *instance, double start, bool stop_defined, double stop)
{
    if (!isfinite(start)) return instance_say(instance, ERROR, "start time = %g s: must be finite", start);
    if (stop_defined && !(stop >= start))
        return instance_say(instance, ERROR, "stop time = %g s: must not be before the start time = %g s", stop, start);
    instance->stop = stop_defined ? stop : INFINITY;
    instance->now.data[T_AT] = start;
    instance->now.outputs_stale = true;
    return OK;
}

bool instance_exceeds_stop(const Instance *instance, double time, double step)
{
    if (!(time + step > instance->stop + STOP_SLACK * (1.0 + fabs(instance->stop)))) return false;
    instance_say(instance, ERROR, "step from t = %.12g s by %g s: goes beyond the stop time = %.12g s", time, step,
                 instance->stop);
    return true;
}

Status instance_keep(const Instance *instance, void **kept)
{
    if (!kept) return instance_say(instance, ERROR, "no place for the state");
    if (!*kept) *kept = malloc(sizeof(State));
    if (!*kept) return instance_say(instance, ERROR, "out of memory");
    memcpy(*kept, &instance->now, sizeof(State));
    return OK;
}

Status instance_put_back(Instance *instance, const void *kept)
{
    if (!kept) return instance_say(instance, ERROR, "no state is given");
    if (((const State *)kept)->exchange != instance->now.exchange)
        return instance_say(instance, ERROR, "the state is not of an instance for %s",
                            instance->now.exchange ? "model exchange" : "co-simulation");
    memcpy(&instance->now, kept, sizeof(State));
    return OK;
}

Status instance_forget(void **kept)
{
    if (!kept) return OK;
    free(*kept);
    *kept = NULL;
    return OK;
}

Status instance_kept_size(const Instance *instance, const void *kept, size_t *size)
{
    if (!kept || !size) return instance_say(instance, ERROR, "no state is given, or no place for its size");
    *size = instance_saved_size();
    return OK;
}

Status instance_kept_to_bytes(const Instance *instance, const void *kept, void *bytes, size_t size)
{
    if (!kept || !bytes) return instance_say(instance, ERROR, "no state is given, or no place for its bytes");
    if (size < instance_saved_size())
        return instance_say(instance, ERROR, "place for %zu bytes: must be at least %zu", size, instance_saved_size());
    instance_save(kept, bytes);
    return OK;
}

Status instance_kept_from_bytes(const Instance *instance, const void *bytes, size_t size, void **kept)
{
    State *read;
    Status status;
    if (!bytes || !kept) return instance_say(instance, ERROR, "no bytes are given, or no place for the state");
    read = *kept ? *kept : malloc(sizeof *read);
    if (!read) return instance_say(instance, ERROR, "out of memory");
    status = instance_restore(instance, read, bytes, size);
    if (status == OK) *kept = read;
    else if (!*kept) free(read);
    return status;
}

Status instance_output_derivatives(Instance *instance, const uint32_t *references, size_t count, const int32_t *orders,
                                   double *values)
{
    if (count && (!references || !orders || !values)) return instance_get(instance, REAL, NULL, count, NULL);
    for (size_t i = 0; i < count; i++) {
        uint32_t rate = RATES_AT;
        Status status;
        while (rate < RATES_AT + RATED && OUTPUTS_AT + (unsigned)rated[rate - RATES_AT] != references[i]) rate++;
        if (rate == RATES_AT + RATED)
            return instance_say(instance, ERROR, "value reference %u is not a continuous output",
                                (unsigned)references[i]);
        if (orders[i] != 1)
            return instance_say(instance, ERROR, "derivative %d of %s: must be 1", (int)orders[i],
                                instance_name(&variables[references[i]]));
        status = instance_get(instance, REAL, &rate, 1, values + i);
        if (status != OK) return status;
    }
    return OK;
}
