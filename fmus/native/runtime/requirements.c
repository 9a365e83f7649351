/* What the component requires besides ranges, and the messages where it is not so. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "instance.h"

/* Adds what a requirement says, with numbers and word in their places, to a message that has `used` bytes. */
static void tell(const Requirement *requirement, const double *numbers, char *message, size_t used, size_t size)
{
    const char *text = requirement->says;
    while (*text && used + 1 < size) {
        const char *end = strchr(text, '}');
        if (*text != '{') {
            message[used++] = *text++;
            message[used] = '\0';
            continue;
        }
        if (!strncmp(text, "{word}", 6)) {
            snprintf(message + used, size - used, "%s", requirement->words[(int)numbers[0]]);
        } else { /* such as {0:.9g} */
            double number = numbers[text[1] - '0'];
            if (number != number) number = fabs(number); /* nan has no sign, as in Python */
            char format[16];
            snprintf(format, sizeof format, "%%%.*s", (int)(end - text - 3), text + 3);
            snprintf(message + used, size - used, format, number);
        }
        used += strlen(message + used);
        text = end + 1;
    }
}

bool instance_unmet(const Instance *instance, const Requirement *list, char *message, size_t size)
{
    const double *data = instance->now.data;
    bool any = false;
    for (; list->met; list++) {
        double numbers[PLACES] = {0.0};
        int64_t met = 0;
        size_t used = strlen(message);
        list->met(&met, &(void *){NULL}, data + X_AT, data + INPUTS_AT, data, numbers);
        if (met) continue;
        if (used) used += (size_t)snprintf(message + used, size - used, "; ");
        tell(list, numbers, message, used, size);
        any = true;
    }
    return any;
}
