#include <string.h>

#include "instance.h"
#include "kernels.h"

/* Saved states: a header that names the FMU and its version, the state, and a sum over both. */

static const char header[] = "tribocosim native state 1 " DIGEST;

static uint64_t checksum(const unsigned char *bytes, size_t size)
{
    uint64_t sum = 14695981039346656037u; /* FNV-1a */
    for (size_t i = 0; i < size; i++) sum = (sum ^ bytes[i]) * 1099511628211u;
    return sum;
}

size_t instance_saved_size(void)
{
    return sizeof header + sizeof(State) + sizeof(uint64_t);
}

void instance_save(const State *state, unsigned char *bytes)
{
    uint64_t sum;
    memcpy(bytes, header, sizeof header);
    memcpy(bytes + sizeof header, state, sizeof *state);
    sum = checksum(bytes, sizeof header + sizeof *state);
    memcpy(bytes + sizeof header + sizeof *state, &sum, sizeof sum);
}

Status instance_restore(const Instance *instance, State *state, const unsigned char *bytes, size_t size)
{
    uint64_t sum;
    if (size < sizeof header || memcmp(bytes, header, sizeof header))
        return instance_say(instance, ERROR, "the saved state is not of this FMU and version");
    if (size != instance_saved_size())
        return instance_say(instance, ERROR, "the saved state is damaged: %zu bytes: must be %zu", size,
                            instance_saved_size());
    memcpy(&sum, bytes + sizeof header + sizeof *state, sizeof sum);
    if (sum != checksum(bytes, sizeof header + sizeof *state))
        return instance_say(instance, ERROR, "the saved state is damaged: its sum does not match");
    memcpy(state, bytes + sizeof header, sizeof *state);
    return OK;
}
