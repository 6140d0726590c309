/* Runs one of Copilot's monitors over columns: cc -DMONITOR='"w1_library.c"' loop.c.
 *
 * The monitor is included, so that the compiler may inline its step. Copilot gives no way back to the
 * initial state: its variables, which alone are `static`, go to a section of their own, to be copied.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EXPORTED __attribute__((visibility("default"), noinline))

bool a, b, c;
static bool truth;

void verdict(bool value) { truth = value; }

#define static static __attribute__((section("monitor")))
#include MONITOR
#undef static

extern char __start_monitor[], __stop_monitor[];
static char *initial;

__attribute__((constructor)) static void keep(void) {
    size_t size = __stop_monitor - __start_monitor;
    initial = malloc(size);
    memcpy(initial, __start_monitor, size);
}

EXPORTED void reset(void) { memcpy(__start_monitor, initial, __stop_monitor - __start_monitor); }

EXPORTED bool tick(bool a_now, bool b_now, bool c_now) {
    a = a_now;
    b = b_now;
    c = c_now;
    step();
    return truth;
}

EXPORTED void run(const bool *as, const bool *bs, const bool *cs, bool *truths, size_t ticks) {
    for (size_t i = 0; i < ticks; i++) {
        a = as[i];
        b = bs[i];
        c = cs[i];
        step();
        truths[i] = truth;
    }
}
