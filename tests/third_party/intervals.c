/* FMI 3.0 co-simulation with a clock of every kind that ticks by time, but those of `sampler.c`. They are `fixed`
   (from 0.02 s on) and `tunable`, at the intervals that they state or are given; `asked` (fixed, 0.125 s from 0.05 s
   on) and `tuned` (tunable: 0.2 s, from its third tick on 0.15 s), which state none; and `changing` (0.05 s, 0.1 s,
   0.15 s, ...). Each counts its ticks, adds their times up, and refuses one at another time. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "fmi3Functions.h"

enum { FIXED, TUNABLE, ASKED, TUNED, CHANGING, CLOCKS };
enum { INITIALISING, EVENT, STEP };

typedef struct {
    double time, ticks[CLOCKS], sums[CLOCKS], intervals[2];
    int mode;
    bool on[CLOCKS], fresh, told;
} Instance;

static double due(const Instance *m, int clock) {
    double k = m->ticks[clock];
    switch (clock) {
        case FIXED: return 0.02 + m->intervals[FIXED] * k;
        case TUNABLE: return m->intervals[TUNABLE] * k;
        case ASKED: return 0.05 + 0.125 * k;
        case TUNED: return k < 3.0 ? 0.2 * k : 0.4 + 0.15 * (k - 2.0);
        default: return 0.05 * (k + 1.0) * (k + 2.0) / 2.0;
    }
}
fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    if (!events) return NULL;
    Instance *m = calloc(1, sizeof(Instance));
    m->intervals[FIXED] = 0.1, m->intervals[TUNABLE] = 0.2;
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
                                       fmi3Float64 x) { return fmi3OK; }
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return move(c, INITIALISING, EVENT); }
fmi3Status fmi3EnterEventMode(fmi3Instance c) { return move(c, STEP, EVENT); }
fmi3Status fmi3EnterStepMode(fmi3Instance c) { return move(c, EVENT, STEP); }
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Clock x[]) {
    Instance *m = c;
    if (m->mode != EVENT) return fmi3Error;
    for (size_t i = 0; i < n; i++) {
        int clock = r[i] - 100;
        if (fabs(m->time - due(m, clock)) > 1e-12) return fmi3Error;
        m->on[clock] = x[i];
    }
    return fmi3OK;
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 x[]) {
    Instance *m = c;
    for (size_t i = 0; i < n; i++) {
        if (m->mode != INITIALISING || r[i] - 100 > TUNABLE) return fmi3Error;
        m->intervals[r[i] - 100] = x[i];
    }
    return fmi3OK;
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 x[]) {
    for (size_t i = 0; i < n; i++) {
        if (((Instance *)c)->mode != INITIALISING || (r[i] != 100 + ASKED && r[i] != 100 + TUNED)) return fmi3Error;
        x[i] = r[i] == 100 + ASKED ? 0.05 : 0.0;
    }
    return fmi3OK;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 x[],
                                  fmi3IntervalQualifier q[]) {
    Instance *m = c;
    for (size_t i = 0; i < n; i++) {
        int clock = r[i] - 100;
        bool first = m->mode == INITIALISING;
        if (m->mode == STEP || clock < ASKED || (clock == CHANGING && !first && !m->fresh)) return fmi3Error;
        x[i] = clock == ASKED ? 0.125 : clock == CHANGING ? 0.05 * (m->ticks[CHANGING] + 1.0) : 0.2;
        q[i] = first || clock == CHANGING ? fmi3IntervalChanged : fmi3IntervalUnchanged;
        if (clock == TUNED && m->ticks[TUNED] >= 3.0) {
            x[i] = 0.15;
            q[i] = m->told ? fmi3IntervalUnchanged : fmi3IntervalChanged;
            m->told = true;
        }
        if (clock == CHANGING) m->fresh = false;
    }
    return fmi3OK;
}
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *ends, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *known, fmi3Float64 *next) {
    Instance *m = c;
    *again = false;
    m->fresh |= m->on[CHANGING];
    for (int i = 0; i < CLOCKS; i++)
        if (m->on[i]) m->ticks[i]++, m->sums[i] += m->time, *again = true;
    memset(m->on, 0, sizeof m->on);
    *ends = *nominals = *values = *known = false;
    return m->mode == EVENT ? fmi3OK : fmi3Error;
}
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean p, fmi3Boolean *event,
                      fmi3Boolean *ends, fmi3Boolean *early, fmi3Float64 *last) {
    Instance *m = c;
    for (int i = 0; i < CLOCKS; i++)
        if (t + h > due(m, i) + 1e-9) return fmi3Error;
    m->time = *last = t + h;
    *event = *ends = *early = false;
    return m->mode == STEP ? fmi3OK : fmi3Error;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 x[], size_t nx) {
    return fmi3Error;
}
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 x[], size_t nx) {
    Instance *m = c;
    for (size_t i = 0; i < n; i++) x[i] = r[i] <= CLOCKS ? m->ticks[r[i] - 1] : m->sums[r[i] - 1 - CLOCKS];
    return fmi3OK;
}
