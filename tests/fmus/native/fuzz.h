/* Of programs that call an FMU at random: random numbers, variables, what it said, and how to stop.

   A failure ends the process with 1, a crash or a call that hangs with 5; each names the seed and the call. */
#ifndef FUZZ_H
#define FUZZ_H

#include <dlfcn.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST 3000  /* references in one call */
#define LONGEST 10 /* elements of an array */
#define SECONDS 60 /* after which a call hangs */

/* Random numbers: splitmix64, the same on every machine. */

static uint64_t seed, state_of_random;

static uint64_t random_bits(void)
{
    uint64_t z = state_of_random += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static unsigned below(unsigned n)
{
    return (unsigned)(random_bits() % n);
}

static bool percent(unsigned p)
{
    return below(100) < p;
}

static double unit_random(void)
{
    return (double)(random_bits() >> 11) * 0x1p-53;
}

/* Any double but NaN and infinities, of any size. */
static double wild_real(void)
{
    static const double special[] = {0.0, -0.0, 1.0, -1.0, 5e-324, 2e-308, 1.7e308, -1.7e308, 9007199254740993.0};
    double sign = percent(50) ? 1.0 : -1.0;
    if (percent(40)) return special[below(sizeof special / sizeof *special)];
    return sign * pow(10.0, percent(50) ? 12.0 * unit_random() - 6.0 : 600.0 * unit_random() - 300.0);
}

static double no_number(void)
{
    static const double special[] = {NAN, INFINITY, -INFINITY};
    return special[below(3)];
}

/* Variables, as the test read them in modelDescription.xml. */

typedef struct {
    unsigned reference;
    char kind;      /* r, i, b: real, integer or enumeration, boolean */
    char causality; /* p, i, d, o, s, l: parameter, input, derivative of one by time, output, state, local */
    char change;    /* f, t, d, c: fixed, tunable, discrete, continuous */
    unsigned size;  /* elements: 1 of scalars */
    double start;   /* of the first */
    unsigned first; /* where the values begin that are looked at */
} Known;

static Known known[1000];
static unsigned known_count, value_count, of_kind[128];

static void read_variables(const char *path)
{
    FILE *file = fopen(path, "r");
    Known *v = known;
    if (!file) exit(2);
    while (known_count < 1000 && fscanf(file, "%u %c %c %c %u %lf", &v->reference, &v->kind, &v->causality, &v->change,
                                        &v->size, &v->start) == 6) {
        if (v->size > LONGEST || value_count + v->size > 1000) exit(2);
        v->first = value_count;
        value_count += v->size;
        of_kind[(int)v->kind]++;
        known_count++, v++;
    }
    fclose(file);
}

static const Known *any_variable(void)
{
    return &known[below(known_count)];
}

/* One of that kind, if there is one, and mostly of one of those causalities. */
static const Known *some_variable(char kind, const char *causalities)
{
    const Known *v = any_variable();
    while ((of_kind[(int)kind] && v->kind != kind) || (!strchr(causalities, v->causality) && percent(95)))
        v = any_variable();
    return v;
}

/* What is done, and what the FMU says to it. */

static const char *doing = "nothing";
static unsigned long call_number;
static struct {
    int count, status;
    char category[64], message[4096];
} said;

static void fail(const char *format, ...)
{
    va_list arguments;
    printf("seed %llu, call %lu, %s: ", (unsigned long long)seed, call_number, doing);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("; it said: %s\n", said.count ? said.message : "nothing");
    fflush(stdout);
    _exit(1);
}

/* Steps with absurd parameters take long, as there are so many in them; hosts give up, and so does this. */
static sigjmp_buf way_out;
static volatile sig_atomic_t patience; /* there is a way out */

static void crashed(int signal_number)
{
    if (signal_number == SIGALRM && patience) {
        patience = 0;
        siglongjmp(way_out, 1);
    }
    char text[200]; /* not safe after any signal, but the process ends here in any case */
    int length = snprintf(text, sizeof text, "seed %llu, call %lu, %s: %s\n", (unsigned long long)seed, call_number,
                          doing, signal_number == SIGALRM ? "it hangs" : strsignal(signal_number));
    if (write(1, text, (size_t)length) < 0) _exit(6);
    _exit(5);
}

static void watch(void)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) signal(signals[i], crashed);
}

static void listen(int status, const char *instance, const char *category, const char *message)
{
    if (!instance || !category || !message || !*message) fail("a message without text or source");
    if (strlen(message) >= sizeof said.message) fail("a message of %zu bytes", strlen(message));
    said.count++;
    said.status = status;
    snprintf(said.category, sizeof said.category, "%s", category);
    strcpy(said.message, message);
}

static void begin(const char *call)
{
    doing = call;
    call_number++;
    said.count = 0;
    alarm(SECONDS);
}

/* After a call: a status of the standard (OK, Warning, Discard, Error); a refusal where `wrong` says why there must
   be one; and one message with the same status for each refusal, none for what went well. */
static void judge(int status, const char *wrong)
{
    if (status < 0 || status > 3) fail("status %d", status);
    if (wrong && status < 2) fail("status %d, in spite of: %s", status, wrong);
    if (status == 0 && said.count) fail("status 0 with a message");
    if (status == 1 && said.count > 1) fail("a warning with %d messages", said.count);
    if (status >= 2 && said.count != 1) fail("status %d with %d messages", status, said.count);
    if (status >= 2 && said.status != status) fail("status %d with a message of status %d", status, said.status);
    if (status >= 2 && strcmp(said.category, status == 2 ? "logStatusDiscard" : "logStatusError"))
        fail("a message of category %s", said.category);
}

static void *find(void *library, const char *name)
{
    void *function = dlsym(library, name);
    if (function) return function;
    printf("%s\n", dlerror());
    exit(3);
}

#endif
