/* A host in C for co-simulation, FMI 2.0 and 3.0: loads one FMU and steps it as a file of numbers says.

   host LIBPYTHON LIBRARY RESOURCES TOKEN CASE free|keep

   LIBPYTHON is loaded first, for all to see, because libraries of FMUs that run in Python name it nowhere; "-" is
   none. CASE has whole numbers and doubles, the latter as their bits in hexadecimal: version of FMI, step, numbers of
   inputs, outputs and steps; the references of inputs and outputs; the inputs' values, step by step. The outputs' bits
   after each step are a line. Last, the instance is freed, or kept until the process ends. Messages of the FMU go to
   standard error. Exit status: 2 wrong arguments, 3 a library or function missing, 4 a call that fails. */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#ifdef _WIN32
#include <windows.h>
static void *opened(const char *path, int for_all)
{
    (void)for_all;
    return (void *)LoadLibraryA(path);
}
static void *named(void *from, const char *name) { return (void *)GetProcAddress((HMODULE)from, name); }
static const char *fault(void)
{
    static char text[32];
    snprintf(text, sizeof text, "error %lu", (unsigned long)GetLastError());
    return text;
}
#else
#include <dlfcn.h>
static void *opened(const char *path, int for_all) { return dlopen(path, RTLD_NOW | (for_all ? RTLD_GLOBAL : RTLD_LOCAL)); }
static void *named(void *from, const char *name) { return dlsym(from, name); }
static const char *fault(void) { return dlerror(); }
#endif

static void *library;
static FILE *numbers;

static void *find(const char *name)
{
    void *function = named(library, name);
    if (function == NULL) {
        fprintf(stderr, "%s: %s\n", name, fault());
        exit(3);
    }
    return function;
}

/* In both versions the status without fault is 0. */
static void check(int status, const char *what)
{
    if (status != 0) {
        fprintf(stderr, "%s: status %d\n", what, status);
        exit(4);
    }
}

static void say2(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...)
{
    (void)environment;
    fprintf(stderr, "%s: status %d, %s: %s\n", instance, status, category ? category : "-", message);
}

static void say3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment;
    fprintf(stderr, "status %d, %s: %s\n", status, category ? category : "-", message);
}

static uint64_t next(const char *format)
{
    uint64_t value;
    // cppcheck-suppress wrongPrintfScanfArgNum ; it does not know the macros in the format
    if (fscanf(numbers, format, &value) != 1) {
        fprintf(stderr, "the file of numbers ends too early\n");
        exit(2);
    }
    return value;
}

static size_t whole(void) { return (size_t)next("%" SCNu64); }

static double real(void)
{
    const uint64_t bits = next("%" SCNx64);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void *room(size_t count, size_t size)
{
    void *made = calloc(count + 1, size);
    if (made == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(5);
    }
    return made;
}

/* The instance, and what a step needs; references have the same type in both versions. */
static int fmi;
static void *unit;
static fmi2SetRealTYPE *set2;
static fmi2GetRealTYPE *get2;
static fmi2DoStepTYPE *step2;
static fmi3SetFloat64TYPE *set3;
static fmi3GetFloat64TYPE *get3;
static fmi3DoStepTYPE *step3;

static void begin(const char *token, const char *resources)
{
    static fmi2CallbackFunctions callbacks = {say2, calloc, free, NULL, NULL};
    if (fmi == 2) {
        set2 = (fmi2SetRealTYPE *)find("fmi2SetReal");
        get2 = (fmi2GetRealTYPE *)find("fmi2GetReal");
        step2 = (fmi2DoStepTYPE *)find("fmi2DoStep");
        unit = ((fmi2InstantiateTYPE *)find("fmi2Instantiate"))("hosted by C", fmi2CoSimulation, token, resources,
                                                                &callbacks, fmi2False, fmi2False);
        if (unit == NULL) check(-1, "instantiate");
        check(((fmi2SetupExperimentTYPE *)find("fmi2SetupExperiment"))(unit, fmi2False, 0, 0, fmi2False, 0), "setup");
        check(((fmi2EnterInitializationModeTYPE *)find("fmi2EnterInitializationMode"))(unit), "enter");
        check(((fmi2ExitInitializationModeTYPE *)find("fmi2ExitInitializationMode"))(unit), "exit");
        return;
    }
    set3 = (fmi3SetFloat64TYPE *)find("fmi3SetFloat64");
    get3 = (fmi3GetFloat64TYPE *)find("fmi3GetFloat64");
    step3 = (fmi3DoStepTYPE *)find("fmi3DoStep");
    unit = ((fmi3InstantiateCoSimulationTYPE *)find("fmi3InstantiateCoSimulation"))(
        "hosted by C", token, resources, fmi3False, fmi3False, fmi3False, fmi3False, NULL, 0, NULL, say3, NULL);
    if (unit == NULL) check(-1, "instantiate");
    check(((fmi3EnterInitializationModeTYPE *)find("fmi3EnterInitializationMode"))(unit, fmi3False, 0, 0, fmi3False, 0),
          "enter");
    check(((fmi3ExitInitializationModeTYPE *)find("fmi3ExitInitializationMode"))(unit), "exit");
}

static void set(const fmi2ValueReference *inputs, size_t count, const double *values)
{
    if (count == 0) return;
    check(fmi == 2 ? (int)set2(unit, inputs, count, values) : (int)set3(unit, inputs, count, values, count), "set");
}

static void get(const fmi2ValueReference *outputs, size_t count, double *values)
{
    check(fmi == 2 ? (int)get2(unit, outputs, count, values) : (int)get3(unit, outputs, count, values, count), "get");
}

static void advance(double time, double step)
{
    fmi3Boolean event, terminate, early;
    double reached;
    check(fmi == 2 ? (int)step2(unit, time, step, fmi2True)
                   : (int)step3(unit, time, step, fmi3True, &event, &terminate, &early, &reached),
          "step");
}

int main(int argc, char **argv)
{
    if (argc != 7 || (numbers = fopen(argv[5], "r")) == NULL) {
        fprintf(stderr, "host LIBPYTHON LIBRARY RESOURCES TOKEN CASE free|keep\n");
        return 2;
    }
    const int python = strcmp(argv[1], "-") != 0;
    if ((python && opened(argv[1], 1) == NULL) || (library = opened(argv[2], 0)) == NULL) {
        fprintf(stderr, "%s\n", fault());
        return 3;
    }
    fmi = (int)whole();
    const double step = real();
    const size_t inputs = whole(), outputs = whole(), steps = whole();
    fmi2ValueReference *input = room(inputs, sizeof *input), *output = room(outputs, sizeof *output);
    double *given = room(inputs, sizeof *given), *found = room(outputs, sizeof *found);
    for (size_t i = 0; i < inputs; i++) input[i] = (fmi2ValueReference)whole();
    for (size_t i = 0; i < outputs; i++) output[i] = (fmi2ValueReference)whole();

    begin(argv[4], argv[3]);
    printf("LOADED\n");
    for (size_t k = 0; k < steps; k++) {
        for (size_t i = 0; i < inputs; i++) given[i] = real();
        set(input, inputs, given);
        advance((double)k * step, step);
        get(output, outputs, found);
        for (size_t i = 0; i < outputs; i++) {
            uint64_t bits;
            memcpy(&bits, found + i, sizeof bits);
            printf("%016" PRIx64 "%c", bits, i + 1 < outputs ? ' ' : '\n');
        }
    }
    if (strcmp(argv[6], "free") == 0) {
        if (fmi == 2) {
            check(((fmi2TerminateTYPE *)find("fmi2Terminate"))(unit), "terminate");
            ((fmi2FreeInstanceTYPE *)find("fmi2FreeInstance"))(unit);
        } else {
            check(((fmi3TerminateTYPE *)find("fmi3Terminate"))(unit), "terminate");
            ((fmi3FreeInstanceTYPE *)find("fmi3FreeInstance"))(unit);
        }
    }
    free(input), free(output), free(given), free(found);
    return 0;
}
