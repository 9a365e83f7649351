/* The same periods as a page's, on this machine: numbers come in, and rows go out, as doubles. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "sizes.h"

extern double parameters[], inputs[], state[], start[], nominal[], rows[];
extern int32_t held[], positive[];
double revolve(double period, double tolerance, int32_t before);

static void take(double *values, size_t count)
{
    if (fread(values, sizeof *values, count, stdin) != count) exit(1);
}

static void take_flags(int32_t *flags)
{
    double value;
    for (int i = 0; i < STATES; i++) {
        take(&value, 1);
        flags[i] = value != 0.0;
    }
}

int main(void)
{
    double said[3]; /* period, tolerance, how many */
    take(said, 3);
    take(parameters, PARAMETERS);
    take(inputs, INPUTS);
    take(start, STATES);
    take(nominal, STATES);
    take_flags(held);
    take_flags(positive);
    for (int i = 0; i < STATES; i++) state[i] = start[i];
    for (int k = 0; k < said[2]; k++) revolve(said[0], said[1], k);
    return fwrite(rows, sizeof *rows, (SAMPLES + 1) * OUTPUTS, stdout) != (SAMPLES + 1) * OUTPUTS;
}
