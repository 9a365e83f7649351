/* What hosts ask in the same way in every version of FMI: times, kept states, derivatives of outputs by time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unit.h"

/* Room for rounding where the host adds up time to the stop time, relative to 1 s or to the time itself. */
#define STOP_SLACK 1e-9

Status unit_set_times(Unit *unit, double start, bool stop_defined, double stop)
{
    if (!isfinite(start)) return unit_say(unit, ERROR, "start time = %g s: must be finite", start);
    if (stop_defined && !(stop >= start))
        return unit_say(unit, ERROR, "stop time = %g s: must not be before the start time = %g s", stop, start);
    unit->stop = stop_defined ? stop : INFINITY;
    unit->now.data[T_AT] = start;
    unit->now.outputs_stale = true;
    return OK;
}

bool unit_goes_too_far(const Unit *unit, double time, double step)
{
    if (!(time + step > unit->stop + STOP_SLACK * (1.0 + fabs(unit->stop)))) return false;
    unit_say(unit, ERROR, "step from t = %.12g s by %g s: goes beyond the stop time = %.12g s", time, step,
             unit->stop);
    return true;
}

Status unit_keep(const Unit *unit, void **kept)
{
    if (!kept) return unit_say(unit, ERROR, "no place for the state");
    if (!*kept) *kept = malloc(sizeof(State));
    if (!*kept) return unit_say(unit, ERROR, "out of memory");
    memcpy(*kept, &unit->now, sizeof(State));
    return OK;
}

Status unit_put_back(Unit *unit, const void *kept)
{
    if (!kept) return unit_say(unit, ERROR, "no state is given");
    if (((const State *)kept)->exchange != unit->now.exchange)
        return unit_say(unit, ERROR, "the state is not of an instance for %s",
                        unit->now.exchange ? "model exchange" : "co-simulation");
    memcpy(&unit->now, kept, sizeof(State));
    return OK;
}

Status unit_forget(void **kept)
{
    if (!kept) return OK;
    free(*kept);
    *kept = NULL;
    return OK;
}

Status unit_kept_size(const Unit *unit, const void *kept, size_t *size)
{
    if (!kept || !size) return unit_say(unit, ERROR, "no state is given, or no place for its size");
    *size = unit_saved_size();
    return OK;
}

Status unit_kept_to_bytes(const Unit *unit, const void *kept, void *bytes, size_t size)
{
    if (!kept || !bytes) return unit_say(unit, ERROR, "no state is given, or no place for its bytes");
    if (size < unit_saved_size())
        return unit_say(unit, ERROR, "place for %zu bytes: must be at least %zu", size, unit_saved_size());
    unit_save(kept, bytes);
    return OK;
}

Status unit_kept_from_bytes(const Unit *unit, const void *bytes, size_t size, void **kept)
{
    State *read;
    Status status;
    if (!bytes || !kept) return unit_say(unit, ERROR, "no bytes are given, or no place for the state");
    read = *kept ? *kept : malloc(sizeof *read);
    if (!read) return unit_say(unit, ERROR, "out of memory");
    status = unit_restore(unit, read, bytes, size);
    if (status == OK) *kept = read;
    else if (!*kept) free(read);
    return status;
}

Status unit_output_derivatives(Unit *unit, const uint32_t *references, size_t count, const int32_t *orders,
                               double *values)
{
    if (count && (!references || !orders || !values)) return unit_get(unit, REAL, NULL, count, NULL);
    for (size_t i = 0; i < count; i++) {
        uint32_t rate = RATES_AT;
        Status status;
        while (rate < RATES_AT + RATED && OUTPUTS_AT + (unsigned)rated[rate - RATES_AT] != references[i]) rate++;
        if (rate == RATES_AT + RATED)
            return unit_say(unit, ERROR, "value reference %u is not a continuous output", (unsigned)references[i]);
        if (orders[i] != 1)
            return unit_say(unit, ERROR, "derivative %d of %s: must be 1", (int)orders[i],
                            unit_name(&variables[references[i]]));
        status = unit_get(unit, REAL, &rate, 1, values + i);
        if (status != OK) return status;
    }
    return OK;
}
