/* What hosts of both versions of FMI do at random: instances, kept states, arguments. */
#ifndef FUZZ_HOST_H
#define FUZZ_HOST_H

#include "fuzz.h"

/* Instances, and states that are kept of them. */

#define INSTANCES 3
#define KEPT 5
#define BYTES 100000

enum { NEW = 1, INIT = 2, STEP = 4, EVENT = 8, TIME = 16, END = 32 }; /* phases */
#define MOVING (STEP | EVENT | TIME)

typedef struct {
    void *unit;
    int phase;
    bool exchange, tame; /* tame ones get values near to their starts */
    double time, stop; /* the latter of the instance, not of its state */
} Place;

typedef struct {
    void *state;
    Place of;
    bool seen;
    double values[1000];
} Kept;

static Place places[INSTANCES], *at;
static Kept kept[KEPT];
static struct {
    char data[BYTES], whole[BYTES]; /* now, and as the FMU wrote them */
    size_t size, size_of_whole;
    Kept of;
} bytes;
static double before[1000], after[1000];
static size_t states, indicators; /* as modelDescription.xml tells */
static const char *token;

/* Of the program: the values of a variable through the standard's call, which is to give status OK. */
static int read_values(void *unit, const Known *variable, double *values);

/* All variables' values. The FMU computes what it has put off, so this is not done before every call. */
static void look(void *unit, double *values)
{
    for (unsigned i = 0; i < known_count; i++) {
        const int status = read_values(unit, &known[i], values + known[i].first);
        if (status) fail("reading value reference %u: status %d", known[i].reference, status);
    }
}

static bool same(const double *a, const double *b)
{
    for (unsigned i = 0; i < value_count; i++)
        if (memcmp(a + i, b + i, sizeof *a)) {
            unsigned k = known_count - 1;
            while (known[k].first > i) k--;
            snprintf(said.message, sizeof said.message, "value reference %u was %.17g and is %.17g",
                     known[k].reference, a[i], b[i]);
            said.count = 1;
            return false;
        }
    return true;
}

/* Why a state must not be put into the present instance, or NULL. */
static const char *foreign(const Kept *some)
{
    return !some->state ? "no state" : some->of.exchange != at->exchange ? "of the other interface" : NULL;
}

/* A state was kept of, or put into, the present instance. */
static void was_kept(Kept *some, bool seen)
{
    some->of = *at;
    some->seen = seen;
}

static void was_restored(const Kept *some)
{
    const Place now = *at;
    *at = some->of;
    at->unit = now.unit, at->stop = now.stop;
    if (!some->seen) return;
    look(at->unit, after);
    if (!same(some->values, after)) fail("a restored state is another");
}

/* The FMU wrote a state into the bytes. */
static void was_written(const Kept *some, size_t size)
{
    if (size > BYTES) fail("%zu bytes", size);
    bytes.of = *some;
    bytes.size = bytes.size_of_whole = size;
    memcpy(bytes.whole, bytes.data, size);
}

/* Damages the bytes, sometimes; whether they are damaged now, as two damages may undo each other. */
static bool damaged(void)
{
    if (bytes.size && percent(50)) {
        const size_t place = random_bits() % bytes.size;
        if (percent(60)) bytes.data[place] ^= (char)(1 << below(8));
        else bytes.size = percent(50) ? place : bytes.size + 1 + below(9);
        if (bytes.size > BYTES) bytes.size = BYTES;
    }
    return !bytes.size || bytes.size != bytes.size_of_whole || memcmp(bytes.data, bytes.whole, bytes.size);
}

/* Arguments */

static unsigned vr[MOST], others[MOST];
static double reals[MOST * LONGEST], more[MOST * LONGEST];
static int ints[MOST * LONGEST];
static size_t values; /* that the references stand for */

/* References for a call of that kind, mostly of those causalities, and values for a call that sets; why it must
   be refused, or NULL. */
static const char *choose(char kind, bool to_set, const char *causalities, size_t *count, bool *no_references,
                          bool *no_values)
{
    const char *wrong = NULL;
    values = 0;
    const bool spoilt = percent(20);
    *count = percent(5) ? 0 : percent(70) ? 1 : percent(95) ? 1 + below(10) : 1 + below(MOST);
    *no_references = *count && percent(3), *no_values = *count && percent(3);
    if (*no_references || *no_values) wrong = "NULL";
    for (size_t i = 0; i < *count; i++) {
        const Known *v = spoilt && percent(30) ? any_variable() : some_variable(kind, causalities);
        const double near = v->start == 0.0 ? 1e-6 : v->start * (1.0 + 0.01 * unit_random());
        vr[i] = v->reference;
        if (v->kind != kind) wrong = "another kind";
        if (to_set && strchr("ol", v->causality)) wrong = "calculated";
        if (to_set && v->causality == 's' && (FMI == 2 || at->phase != TIME)) wrong = "calculated";
        if (to_set && v->change == 'f' && !(at->phase & (NEW | INIT))) wrong = "fixed";
        for (unsigned j = 0; j < v->size; j++, values++) {
            reals[values] = at->tame ? near : wild_real();
            ints[values] = at->tame ? (v->kind == 'r' ? 1 : (int)v->start) : (int)random_bits() >> below(32);
        }
        if (!spoilt || percent(90)) continue;
        if (to_set && kind == 'r' && percent(50)) reals[values - 1] = no_number(), wrong = "no number";
        else if (v->size > 1 && percent(50)) vr[i] += 1 + below(v->size - 1), wrong = "not the first of an array";
        else vr[i] = percent(50) ? UINT32_MAX - below(9) : 1000000 + below(1u << 31), wrong = "unknown";
    }
    return *count && !of_kind[(int)kind] ? "none of that kind" : wrong;
}

static bool beyond_stop(double time, double slack)
{
    return time > at->stop + slack * (1.0 + fabs(at->stop));
}

/* A step from near or far, sensible or not; why it must be refused, or NULL. */
static const char *choose_step(double *time, double *step)
{
    *time = at->time;
    *step = percent(70) ? 1e-3 * unit_random() : percent(50) ? 0.0 : wild_real();
    if (fabs(*step) > 1.0 && fabs(*step) < 1e290) *step = 1.0; /* more would only take long */
    if (percent(5)) *step = no_number();
    if (percent(10)) *time = percent(50) ? no_number() : *time - 1.0 - unit_random();
    if (!at->tame) {
        patience = 1;
        alarm(1);
    }
    if (!(*step >= 0.0) || !isfinite(*step) || !isfinite(*time)) return "no step";
    if (beyond_stop(*time + *step, 2e-9)) return "beyond the stop time"; /* 1e-9 is allowed, for rounding */
    return fabs(*time - at->time) > 1e-3 * (1.0 + fabs(at->time) + *step) ? "elsewhere" : NULL;
}

/* After a step to that time. */
static void look_at_stop(int status, double end)
{
    if (status == 3 && said.count && strstr(said.message, "beyond the stop time") && !beyond_stop(end, 0.0))
        fail("a stop time too early, of %.17g for %.17g", at->stop, end);
}

static unsigned long taken[100], refused[100]; /* how often, by function */

/* Calls a function that is allowed in these phases, and looks at the answer; values can be read in `readable`. */
static void make(int f, const char *name, int allowed, int readable, int (*perform)(int, const char **))
{
    const int phase = at->phase;
    const bool watched = phase & readable && percent(20);
    const char *wrong = NULL;
    void *unit = at->unit;
    if (watched) look(unit, before);
    if (percent(1)) at->unit = NULL;
    begin(name);
    const int status = perform(f, &wrong);
    if (!at->unit) {
        if (status != 3 || said.count) fail("status %d without an instance", status);
        at->unit = unit;
        return;
    }
    judge(status, phase & allowed ? wrong : "the wrong phase");
    ++*(status < 2 ? &taken[f] : &refused[f]);
    if (!watched || status < 2) return;
    look(unit, after);
    if (!same(before, after)) fail("a refusal changed values");
}

/* With the arguments that fuzz.c tells: makes calls, and frees all in the end. */
static void play(char **argv, void (*create)(void), void (*call)(void), void (*free_instance)(void *),
                 int (*free_state)(void *, void **))
{
    token = argv[2];
    read_variables(argv[3]);
    states = strtoul(argv[4], NULL, 10), indicators = strtoul(argv[5], NULL, 10);
    seed = state_of_random = strtoull(argv[6], NULL, 10);
    const unsigned long calls = strtoul(argv[7], NULL, 10);
    watch();
    while (call_number < calls) {
        at = &places[below(INSTANCES)];
        if (!at->unit) create();
        else if (below(1000) == 0 || sigsetjmp(way_out, 1)) {
            begin("free");
            free_instance(at->unit);
            at->unit = NULL;
        } else call();
    }
    for (int i = 0; i < KEPT; i++) { /* any living instance frees them */
        for (at = places; !at->unit; create()) continue;
        if (free_state(at->unit, &kept[i].state)) fail("a state cannot be freed");
    }
    for (int i = 0; i < INSTANCES; i++) free_instance(places[i].unit);
}

#endif
