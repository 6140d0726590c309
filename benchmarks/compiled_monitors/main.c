/* Times a monitor that is linked to it: main ROWS WIDTH TICKS ROUNDS. Each round starts from the first state, and prints
 * the nanoseconds of CPU time of one tick. Then comes a number that all monitors of the same requirements must agree on. */
#define _POSIX_C_SOURCE 199309L
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void monitor_reset(void);
/* How often the first requirement held if the run ended there; plus how many requirements hold at the end. */
uint64_t monitor_run(const uint8_t *rows, size_t ticks);
size_t monitor_bytes(void);

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

int main(int count, char **arguments)
{
    if (count != 5) {
        return 2;
    }
    const size_t width = strtoul(arguments[2], NULL, 10), ticks = strtoul(arguments[3], NULL, 10);
    const int rounds = atoi(arguments[4]);
    uint8_t *rows = malloc(width * ticks);
    FILE *file = fopen(arguments[1], "rb");
    if (!rows || !file || fread(rows, width, ticks, file) != ticks) {
        return 2;
    }
    uint64_t sum = 0;
    for (int i = 0; i < rounds; i++) {
        monitor_reset();
        const double start = now();
        sum = monitor_run(rows, ticks);
        printf("%.4f\n", (now() - start) / (double)ticks);
    }
    printf("%" PRIu64 " %zu\n", sum, monitor_bytes());
    return 0;
}
