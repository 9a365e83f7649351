/* FMI 3.0 co-simulation with event mode and clocks, which refuses every call that the standard forbids then.
   `tick` (constant, 0.1 s) adds 0.1 u to y. Every second tick sets `alarm` (countdown) to 0.03 s and ticks the
   output clock `fired`. `poke` (triggered) counts. A time event at 0.25 s sets `level`; doStep may not go beyond.
   `gain` is a discrete input: scaled = gain * y. Where it is negative the next event stays at the present; 5 sets the
   alarm too. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "fmi3Functions.h"

enum { TIME, U, Y, TICKS, ALARMS, POKES, LEVEL, GAIN, SCALED, LAST, COUNT };
enum { TICK = 100, ALARM, POKE, FIRED };
enum { INSTANTIATED, INITIALISING, EVENT, STEP };

typedef struct {
    double v[COUNT], alarm;
    int mode;
    bool on[4], fired, set, warned;
} Instance;

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    if (!events || !early) return NULL;
    Instance *m = calloc(1, sizeof(Instance));
    m->v[GAIN] = 1.0;
    return m;
}
const char *fmi3GetVersion(void) { return fmi3Version; }
void fmi3FreeInstance(fmi3Instance c) { free(c); }
static fmi3Status move(fmi3Instance c, int from, int to) {
    Instance *m = c;
    if (m->mode != from) return fmi3Error;
    m->mode = to;
    return fmi3OK;
}
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean d, fmi3Float64 e, fmi3Float64 t, fmi3Boolean s,
                                       fmi3Float64 x) { return move(c, INSTANTIATED, INITIALISING); }
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return move(c, INITIALISING, EVENT); }
fmi3Status fmi3EnterEventMode(fmi3Instance c) { return move(c, STEP, EVENT); }
fmi3Status fmi3EnterStepMode(fmi3Instance c) { return move(c, EVENT, STEP); }
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Clock x[]) {
    Instance *m = c;
    if (m->mode != EVENT) return fmi3Error;
    for (size_t i = 0; i < n; i++) {
        if (r[i] > POKE) return fmi3Error;
        m->on[r[i] - TICK] = x[i];
    }
    if (m->on[0] && fabs(fmod(m->v[TIME] + 0.05, 0.1) - 0.05) > 1e-9) return fmi3Error;
    return fmi3OK;
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Clock x[]) {
    Instance *m = c;
    if (m->mode != EVENT) return fmi3Error;
    /* Its equations are solved where an output of the event is asked for first. */
    for (size_t i = 0; i < n; i++) x[i] = r[i] == FIRED && m->on[0] && fmod(m->v[TICKS] + 1.0, 2.0) == 0.0 && !m->fired;
    m->fired |= n > 0 && x[0];
    return fmi3OK;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 x[],
                                  fmi3IntervalQualifier q[]) {
    Instance *m = c;
    if ((m->mode != INITIALISING && m->mode != EVENT) || n != 1 || r[0] != ALARM) return fmi3Error;
    x[0] = m->alarm;
    q[0] = m->alarm > 0.0 ? (m->set ? fmi3IntervalChanged : fmi3IntervalUnchanged) : fmi3IntervalNotYetKnown;
    m->set = false;
    return fmi3OK;
}
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *ends, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *known, fmi3Float64 *next) {
    Instance *m = c;
    if (m->mode != EVENT) return fmi3Error;
    if (m->on[0]) {
        m->v[TICKS]++;
        m->v[LAST] = m->v[TIME];
        m->v[Y] += 0.1 * m->v[U];
        if (fmod(m->v[TICKS], 2.0) == 0.0) m->alarm = 0.03, m->set = true;
    }
    if (m->v[GAIN] == 5.0 && !m->warned) m->alarm = 0.03, m->set = m->warned = true;
    if (m->on[1]) m->v[ALARMS]++, m->alarm = 0.0;
    if (m->on[2]) m->v[POKES]++;
    if (m->v[TIME] >= 0.25 - 1e-12) m->v[LEVEL] = 1.0;
    m->v[SCALED] = m->v[GAIN] * m->v[Y];
    *again = m->on[0] || m->on[1] || m->on[2];
    memset(m->on, 0, sizeof m->on);
    m->fired = false;
    *ends = *nominals = *values = false;
    *known = m->v[LEVEL] == 0.0 || m->v[GAIN] < 0.0;
    *next = m->v[LEVEL] == 0.0 ? 0.25 : m->v[TIME];
    return fmi3OK;
}
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean p, fmi3Boolean *event,
                      fmi3Boolean *ends, fmi3Boolean *early, fmi3Float64 *last) {
    Instance *m = c;
    if (m->mode != STEP || fabs(t - m->v[TIME]) > 1e-9) return fmi3Error;
    if (m->v[LEVEL] == 0.0 && t + h > 0.25 + 1e-9) return fmi3Error;
    m->v[TIME] = *last = t + h;
    *event = *ends = *early = false;
    return fmi3OK;
}
static int is_discrete(fmi3ValueReference r) { return r == U || r == GAIN; }
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 x[], size_t nx) {
    Instance *m = c;
    for (size_t i = 0; i < n; i++) {
        if (is_discrete(r[i]) && m->mode == STEP) return fmi3Error;
        if (r[i] == U && m->mode == EVENT && !m->on[0]) return fmi3Error;
        m->v[r[i]] = x[i];
    }
    return fmi3OK;
}
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 x[], size_t nx) {
    for (size_t i = 0; i < n; i++) x[i] = ((Instance *)c)->v[r[i]];
    return fmi3OK;
}
fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) {
    if (((Instance *)c)->mode != STEP) return fmi3Error;
    if (!*s) *s = malloc(sizeof(Instance));
    memcpy(*s, c, sizeof(Instance));
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) { memcpy(c, s, sizeof(Instance)); return fmi3OK; }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) { free(*s); *s = NULL; return fmi3OK; }
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState s, size_t *n) {
    *n = sizeof(Instance);
    return fmi3OK;
}
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState s, fmi3Byte b[], size_t n) {
    memcpy(b, s, n);
    return fmi3OK;
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte b[], size_t n, fmi3FMUState *s) {
    *s = malloc(n);
    memcpy(*s, b, n);
    return fmi3OK;
}
