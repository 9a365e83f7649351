/* FMI 2.0 or 3.0 (FMI) co-simulation around a model: all variables are doubles in v, a reference is the first's
   place. MODEL is a file with COUNT, START (their start values), READING and LEAVING (the statuses of getters and of the
   end of initialisation) and the function
   `step`, which moves v from t to t + h and returns a status, or ENDED or EARLY with `reached` set. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <signal.h>

#if FMI == 2
#include "fmi2Functions.h"
#define NAME(x) fmi2##x
typedef fmi2CallbackFunctions const *Logger;
#else
#include "fmi3Functions.h"
#define NAME(x) fmi3##x
typedef fmi3LogMessageCallback Logger;
#endif

enum { OK, WARNING, DISCARD, ERROR, FATAL, ENDED = 10, EARLY };

typedef struct {
    double *v;
    double reached;
    bool ended, initialised, configured;
    Logger log;
    void *environment;
    char name[100], text[100];
} Instance;

static void say(Instance *m, int status, const char *text);
#include MODEL
static const double start_values[COUNT] = START;

static void say(Instance *m, int status, const char *text) {
#if FMI == 2
    if (m->log && m->log->logger) m->log->logger(m->environment, m->name, status, "logStatus", text);
#else
    if (m->log) m->log(m->environment, status, "logStatus", text);
#endif
}

static Instance *made(const char *name) {
    Instance *m = calloc(1, sizeof(Instance));
    m->v = malloc(sizeof start_values);
    memcpy(m->v, start_values, sizeof start_values);
    strncpy(m->name, name, sizeof m->name - 1);
    return m;
}

/* The text of a model that has one, before its initialisation. */
static int given(Instance *m, const char *text) {
    if (m->initialised) return ERROR;
    strncpy(m->text, text, sizeof m->text - 1);
    return OK;
}

static int moved(Instance *m, double t, double h) {
    m->ended = false;
    m->reached = t;
    int status = step(m, m->v, t, h);
    if (status == OK) m->reached = t + h;
    if (status == ENDED) m->ended = true;
    return status;
}

/* Of models that are linear, whose differences are exact. */
static int directional(Instance *m, const unsigned u[], size_t nu, const unsigned k[], size_t nk, const double dk[],
                       double du[]) {
    double here[COUNT], there[COUNT];
    memcpy(here, m->v, sizeof here);
    memcpy(there, m->v, sizeof there);
    for (size_t i = 0; i < nk; i++) there[k[i]] += dk[i];
    output(m, here);
    output(m, there);
    for (size_t i = 0; i < nu; i++) du[i] = there[u[i]] - here[u[i]];
    return OK;
}

/* Derivatives of outputs: RATE(reference) is where they are. */
static int rates(Instance *m, const unsigned r[], size_t n, const int order[], double x[]) {
    if (!m->initialised) return ERROR;
    output(m, m->v);
    for (size_t i = 0, k = 0; i < n; i++) {
        if (RATE(r[i]) < 0 || order[i] != 1) return ERROR;
        for (size_t j = 0; j < SIZE(r[i]); j++) x[k++] = m->v[RATE(r[i]) + j];
    }
    return OK;
}

#if FMI == 2

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String s[]) { return fmi2OK; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *f, fmi2Boolean visible, fmi2Boolean logging) {
    if (strcmp(guid, TOKEN)) return NULL;
    Instance *m = made(name);
    m->log = f;
    m->environment = f->componentEnvironment;
    return m;
}
void fmi2FreeInstance(fmi2Component c) { free(((Instance *)c)->v); free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean d, fmi2Real t, fmi2Real s, fmi2Boolean e, fmi2Real x) {
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *m = c;
    m->initialised = true;
    return (fmi2Status)(LEAVING);
}
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { memcpy(((Instance *)c)->v, start_values, sizeof start_values); return fmi2OK; }

#define ACCESS(Type, ctype) \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, ctype x[]) { \
        Instance *m = c; output(m, m->v); \
        for (size_t i = 0; i < n; i++) x[i] = (ctype)m->v[r[i]]; \
        return (fmi2Status)(READING); } \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const ctype x[]) { \
        for (size_t i = 0; i < n; i++) ((Instance *)c)->v[r[i]] = x[i]; \
        return fmi2OK; }
ACCESS(Real, fmi2Real)
ACCESS(Integer, fmi2Integer)
ACCESS(Boolean, fmi2Boolean)
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String x[]) { return fmi2Error; }
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String x[]) {
    return (fmi2Status)given(c, x[0]);
}
fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    if (!*s) *s = malloc(sizeof start_values);
    memcpy(*s, ((Instance *)c)->v, sizeof start_values);
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) {
    memcpy(((Instance *)c)->v, s, sizeof start_values);
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) { free(*s); *s = NULL; return fmi2OK; }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    *n = sizeof start_values;
    return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n) {
    memcpy(b, s, n);
    return fmi2OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s) {
    *s = malloc(n);
    memcpy(*s, b, n);
    return fmi2OK;
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[]) {
    return (fmi2Status)directional(c, u, nu, k, nk, dk, du);
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer o[], const fmi2Real x[]) {
    /* The variables after an input are its derivatives. */
    if (!((Instance *)c)->initialised) return fmi2Error;
    for (size_t i = 0; i < n; i++)
        if (o[i] > HIGHEST) return HIGHEST < 0 ? fmi2Error : fmi2Warning;
    for (size_t i = 0; i < n; i++) ((Instance *)c)->v[r[i] + o[i]] = x[i];
    return fmi2OK;
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer o[], fmi2Real x[]) {
    return (fmi2Status)rates(c, r, n, o, x);
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_rollback) {
    int status = moved(c, t, h);
    return status >= ENDED ? fmi2Discard : (fmi2Status)status;
}
fmi2Status fmi2CancelStep(fmi2Component c) { return fmi2Error; }
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind k, fmi2Status *x) { return fmi2Discard; }
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *x) {
    *x = ((Instance *)c)->reached;
    return fmi2OK;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind k, fmi2Integer *x) { return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *x) {
    *x = ((Instance *)c)->ended;
    return fmi2OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind k, fmi2String *x) { return fmi2Discard; }

#else

const char *fmi3GetVersion(void) { return fmi3Version; }
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String s[]) { return fmi3OK; }
fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    if (strcmp(token, TOKEN)) return NULL;
    Instance *m = made(name);
    m->log = log;
    m->environment = environment;
    return m;
}
void fmi3FreeInstance(fmi3Instance c) { free(((Instance *)c)->v); free(c); }
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean d, fmi3Float64 e, fmi3Float64 t, fmi3Boolean s,
                                       fmi3Float64 x) { return fmi3OK; }
fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    Instance *m = c;
    m->initialised = true;
    return (fmi3Status)(LEAVING);
}
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3Reset(fmi3Instance c) { memcpy(((Instance *)c)->v, start_values, sizeof start_values); return fmi3OK; }

/* Arrays: SIZE(reference) elements one after the other. */
#define ACCESS(Type, ctype) \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference r[], size_t n, ctype x[], size_t nx) { \
        Instance *m = c; size_t k = 0; output(m, m->v); \
        for (size_t i = 0; i < n; i++) \
            for (size_t j = 0; j < SIZE(r[i]); j++) x[k++] = (ctype)m->v[r[i] + j]; \
        return k == nx ? (fmi3Status)(READING) : fmi3Error; } \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference r[], size_t n, const ctype x[], size_t nx) { \
        Instance *m = c; size_t k = 0; \
        for (size_t i = 0; i < n; i++) \
            for (size_t j = 0; j < SIZE(r[i]); j++) m->v[r[i] + j] = x[k++]; \
        return k == nx ? fmi3OK : fmi3Error; }
ACCESS(Float64, fmi3Float64)
ACCESS(Float32, fmi3Float32)
ACCESS(Int32, fmi3Int32)
ACCESS(Int64, fmi3Int64)
ACCESS(Boolean, fmi3Boolean)

/* Structural parameters. */
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) { ((Instance *)c)->configured = true; return fmi3OK; }
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) { ((Instance *)c)->configured = false; return fmi3OK; }
fmi3Status fmi3GetUInt64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3UInt64 x[], size_t nx) {
    for (size_t i = 0; i < n; i++) x[i] = (fmi3UInt64)((Instance *)c)->v[r[i]];
    return fmi3OK;
}
fmi3Status fmi3SetUInt64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3UInt64 x[], size_t nx) {
    if (!((Instance *)c)->configured) return fmi3Error;
    for (size_t i = 0; i < n; i++) ((Instance *)c)->v[r[i]] = (double)x[i];
    return fmi3OK;
}

fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3String x[], size_t nx) {
    return (fmi3Status)given(c, x[0]);
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) {
    if (!*s) *s = malloc(sizeof start_values);
    memcpy(*s, ((Instance *)c)->v, sizeof start_values);
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) {
    memcpy(((Instance *)c)->v, s, sizeof start_values);
    return fmi3OK;
}
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) { free(*s); *s = NULL; return fmi3OK; }
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState s, size_t *n) {
    *n = sizeof start_values;
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
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference u[], size_t nu,
                                        const fmi3ValueReference k[], size_t nk, const fmi3Float64 dk[], size_t ndk,
                                        fmi3Float64 du[], size_t ndu) {
    return (fmi3Status)directional(c, u, nu, k, nk, dk, du);
}
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 o[],
                                    fmi3Float64 x[], size_t nx) { return (fmi3Status)rates(c, r, n, o, x); }
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean no_rollback, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    Instance *m = c;
    int status = moved(m, t, h);
    *event = false;
    *terminate = m->ended;
    *early = status == EARLY;
    *last = m->reached;
    return status >= ENDED ? fmi3OK : (fmi3Status)status;
}

#endif
