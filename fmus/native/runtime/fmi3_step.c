/* FMI 3.0 for co-simulation over `instance`: steps, which may end at an event or where the host wants it, and inputs
   that the host gives in the course of a step. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3.h"

/* A step that would end so close to its beginning goes on over the event, so that time does not stand still. */
#define LEAST_PROGRESS 1e-9
/* How far, relative, times that can be told apart lie from each other. */
#define RESOLUTION 4e-16
/* The polynomial of an input in a step has its value at the beginning and at so many points after. */
#define POINTS 3

fmi3Status fmi3EnterStepMode(fmi3Instance handle)
{
    NEEDS_THAT(!INSTANCE->now.exchange, EVENT, "fmi3EnterStepMode", "in model exchange");
    INSTANCE->now.phase = STEPPING;
    return fmi3OK;
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t size)
{
    Elements some;
    Status status;
    int32_t *of_elements;
    NEEDS(INITIALIZING | MOVING | INTERMEDIATE | TERMINATED, "fmi3GetOutputDerivatives");
    if (INSTANCE->now.phase == INTERMEDIATE && !SESSION->getting)
        return instance_say(INSTANCE, ERROR,
                            "fmi3GetOutputDerivatives: values cannot be read in this intermediate update");
    if (!elements_of(&some, INSTANCE, "fmi3GetOutputDerivatives", vr, count, size, false)) return fmi3Error;
    if (!some.made || !orders)
        return instance_output_derivatives(INSTANCE, some.references, some.count, orders, values);
    of_elements = malloc(some.count * sizeof *of_elements);
    for (size_t i = 0, j = 0; of_elements && i < count; i++)
        for (uint32_t n = instance_variable(vr[i])->elements; n > 0; n--) of_elements[j++] = orders[i];
    if (of_elements) status = instance_output_derivatives(INSTANCE, some.references, some.count, of_elements, values);
    else status = instance_say(INSTANCE, ERROR, "out of memory");
    free(of_elements);
    free(some.made);
    return status;
}

/* Calls of the host's in the course of a step */

/* `end` becomes earlier if the host wants the step to end there. */
static void update(Session *one, double time, bool setting, bool finished, double *end)
{
    Phase phase = one->instance->now.phase;
    fmi3Boolean requested = false, possible = one->early_return && end;
    fmi3Float64 wanted = time;
    one->setting = setting;
    one->getting = finished;
    one->instance->now.phase = INTERMEDIATE;
    one->update(one->instance->environment, time, setting, finished, finished, possible, &requested, &wanted);
    one->instance->now.phase = phase;
    if (end && possible && requested && wanted < *end) *end = fmax(wanted, one->before.data[T_AT]);
}

/* Taylor coefficients of the cubic polynomial through u at 0, h, 2h, 3h. */
static void set_polynomial(double *U, const double u[POINTS + 1], double h)
{
    double first = u[1] - u[0], second = u[2] - 2.0 * u[1] + u[0], third = u[3] - 3.0 * (u[2] - u[1]) - u[0];
    U[0] = u[0];
    U[INPUTS] = (first - second / 2.0 + third / 3.0) / h;
    U[2 * INPUTS] = (second - third) / (h * h);
    U[3 * INPUTS] = third / (h * h * h);
}

/* Asks the host for the inputs that it gives: what they are in the coming step. */
static void ask(Session *one, double time, double step, double *end)
{
    State *now = &one->instance->now;
    double u[INPUTS + 1][POINTS + 1];
    for (int i = 0; i < INPUTS; i++) u[i][0] = now->data[INPUTS_AT + i];
    for (int k = 1; k <= POINTS; k++) {
        update(one, time + step * ((double)k / POINTS), true, false, end);
        for (int i = 0; i < INPUTS; i++) u[i][k] = now->data[INPUTS_AT + i];
    }
    *now = one->before;
    for (int i = 0; i < INPUTS; i++)
        if (one->given[i]) set_polynomial(now->data + INPUTS_AT + i, u[i], step / POINTS);
    now->outputs_stale = true;
}

/* Steps to events */

#ifdef EVENT_COUNT_AT

/* The step from the same beginning to another end, and how many events happen in it. */
static Status make(Session *one, double time, double step, double *events)
{
    State *now = &one->instance->now;
    Status status;
    *now = one->beginning;
    status = instance_step(one->instance, time, step);
    *events = now->data[EVENT_COUNT_AT] - one->beginning.data[EVENT_COUNT_AT];
    return status;
}

/* After a step with events: the step to the first of them, which is due then in event mode, and over if the host
   has none. */
static Status to_first_event(Session *one, double time, double step, double events)
{
    const double *data = one->instance->now.data;
    double low = time, first = fmax(data[EVENT_TIME_AT], time), apart = 0.0, none;
    bool due = one->event_mode;
    Status status;
    while (events > 1.0) {
        double some, middle = low + 0.5 * (first - low);
        if (!(low < middle && middle < first)) break; /* all at once */
        if ((status = make(one, time, middle - time, &some)) != OK) return status;
        if (some > 0.0) {
            first = fmax(data[EVENT_TIME_AT], time);
            events = some;
        } else low = middle;
    }
    if (first - time <= LEAST_PROGRESS * (1.0 + fabs(time))) due = false;
    for (;;) {
        double end = due ? first - apart : first + apart;
        if (!due && end - time >= step) return make(one, time, step, &none);
        if (end > time) {
            if ((status = make(one, time, fmin(end - time, step), &events)) != OK) return status;
            if ((events > 0.0) != due) return OK;
        } else due = false;
        apart = apart > 0.0 ? 2.0 * apart : RESOLUTION * (1.0 + fabs(first));
    }
}

#endif

/* The step; `to_event` if the host lets it end at an event, and it does. */
static Status make_step(Session *one, double time, double step, bool *to_event)
{
    *to_event = false;
#ifdef EVENT_COUNT_AT
    if (one->early_return && step > 0.0) {
        double events;
        Status status;
        instance_ready(one->instance, OUTPUTS_AT);
        one->beginning = one->instance->now;
        status = make(one, time, step, &events);
        *to_event = status == OK && events > 0.0;
        return *to_event ? to_first_event(one, time, step, events) : status;
    }
#endif
    return instance_step(one->instance, time, step);
}

fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_set_state,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    Session *one = handle;
    double whole = time + step, end = whole;
    bool to_event, asks;
    Status status;
    NEEDS_THAT(!INSTANCE->now.exchange, STEPPING, "fmi3DoStep", "in model exchange");
    (void)no_set_state;
    if (!event || !terminate || !early || !reached)
        return instance_say(INSTANCE, ERROR, "fmi3DoStep: no place for what it tells");
    *event = *terminate = *early = false; /* it never ends a run by itself */
    *reached = INSTANCE->now.data[T_AT];
    if (instance_exceeds_stop(INSTANCE, time, step)) return fmi3Error;
    asks = one->update && step > 0.0 && isfinite(whole);
    if (asks || one->early_return) one->before = INSTANCE->now; /* else a step changes nothing unless it is made */
    if (asks) {
        update(one, time, false, true, &end);
        if (one->gives) ask(one, time, step, &end);
    }
    status = make_step(one, time, end < whole ? end - time : step, &to_event);
    if (status != OK) {
        if (asks || one->early_return) INSTANCE->now = one->before;
        return status;
    }
    if (one->gives) instance_continue_inputs(INSTANCE);
    *reached = INSTANCE->now.data[T_AT];
    *event = to_event && one->event_mode;
    *early = *reached < whole;
    if (asks) update(one, *reached, false, true, NULL);
    return fmi3OK;
}
