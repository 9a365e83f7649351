/* A co-simulation FMU of FMI 1.0: x' = -k x + u, with the exact solution of a step; y = x + u at once, n counts
   the steps, on says whether x > 1/2. The step fails where x is to pass `limit`. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *finished;
} Callbacks;
enum { X, K, U, Y, LIMIT, COUNT };
typedef struct {
    double v[COUNT], reached;
    int n, initialised;
    char name[100];
    Callbacks f;
} Instance;
#define F(name) decay1_fmi##name

const char *F(GetTypesPlatform)(void) { return "standard32"; }
const char *F(GetVersion)(void) { return "1.0"; }
int F(SetDebugLogging)(void *c, char on) { return 0; }
void *F(InstantiateSlave)(const char *name, const char *guid, const char *place, const char *mime, double timeout,
                          char visible, char interactive, Callbacks f, char logging) {
    if (strcmp(guid, "{1e0f7c2a-1111-4b6e-9d50-5d1c0fa3c0de}")) return NULL;
    Instance *m = calloc(1, sizeof(Instance));
    m->v[X] = 1.0; m->v[K] = 1.0; m->v[LIMIT] = -1e300;
    m->f = f;
    strncpy(m->name, name, sizeof m->name - 1);
    return m;
}
int F(InitializeSlave)(void *c, double t, char defined, double stop) {
    Instance *m = c;
    m->v[Y] = m->v[X] + m->v[U];
    m->reached = t;
    return m->initialised++ ? 3 : 0;
}
int F(TerminateSlave)(void *c) { return 0; }
int F(ResetSlave)(void *c) { return 3; }
void F(FreeSlaveInstance)(void *c) { free(c); }
int F(DoStep)(void *c, double t, double h, char new) {
    Instance *m = c;
    double e = exp(-m->v[K] * h), x = m->v[X] * e + m->v[U] * (1.0 - e) / m->v[K];
    if (!m->initialised) return 3;
    if (x < m->v[LIMIT]) {
        m->f.log(c, m->name, 2, "step", "x would be %g", x);
        return 2;
    }
    m->v[X] = x;
    m->reached = t + h;
    m->n++;
    return 0;
}
int F(CancelStep)(void *c) { return 3; }
int F(GetReal)(void *c, const unsigned r[], size_t n, double x[]) {
    Instance *m = c;
    m->v[Y] = m->v[X] + m->v[U];
    for (size_t i = 0; i < n; i++) x[i] = m->v[r[i]];
    return 0;
}
int F(SetReal)(void *c, const unsigned r[], size_t n, const double x[]) {
    Instance *m = c;
    for (size_t i = 0; i < n; i++) m->v[r[i]] = x[i];
    return 0;
}
int F(GetInteger)(void *c, const unsigned r[], size_t n, int x[]) {
    for (size_t i = 0; i < n; i++) x[i] = ((Instance *)c)->n;
    return 0;
}
int F(GetBoolean)(void *c, const unsigned r[], size_t n, char x[]) {
    for (size_t i = 0; i < n; i++) x[i] = ((Instance *)c)->v[X] > 0.5;
    return 0;
}
int F(GetString)(void *c, const unsigned r[], size_t n, const char *x[]) { return 3; }
int F(SetInteger)(void *c, const unsigned r[], size_t n, const int x[]) { return 3; }
int F(SetBoolean)(void *c, const unsigned r[], size_t n, const char x[]) { return 3; }
int F(SetString)(void *c, const unsigned r[], size_t n, const char *x[]) { return 3; }
int F(SetRealInputDerivatives)(void *c, const unsigned r[], size_t n, const int o[], const double x[]) { return 3; }
int F(GetRealOutputDerivatives)(void *c, const unsigned r[], size_t n, const int o[], double x[]) { return 3; }
int F(GetStatus)(void *c, int kind, int *x) { return 2; }
int F(GetRealStatus)(void *c, int kind, double *x) { *x = ((Instance *)c)->reached; return 0; }
int F(GetIntegerStatus)(void *c, int kind, int *x) { return 2; }
int F(GetBooleanStatus)(void *c, int kind, char *x) { return 2; }
int F(GetStringStatus)(void *c, int kind, const char **x) { return 2; }
