/* W1 to W4 as one may write them for a controller: every proposition is known, and one requirement after a tick tells
 * what a reading of fretc's tells. A monitor keeps one of these structs for each requirement. */
#ifndef BY_HAND_H
#define BY_HAND_H

#include <stdbool.h>
#include <stdint.h>

typedef enum { PENDING, SATISFIED, VIOLATED } verdict_t;

typedef struct {
    int32_t left; /* ticks to the deadline of the open demand; -1: none */
    bool trigger;
    bool violation;
    bool open;
    bool answer;
    bool finite; /* not violated, if the run ends here */
    verdict_t verdict;
} outcome_t;

typedef struct {
    bool open;
} w1_t;

typedef struct {
    int32_t age; /* ticks since the oldest trigger without an answer; -1: none */
    bool broken;
} w2_t;

typedef struct {
    int32_t age; /* ticks since the last b, at most one more than the bound */
    bool broken;
} w3_t;

typedef struct {
    bool a_before;
    bool since;
    bool broken;
} w4_t;

static inline void w1_init(w1_t *s) { s->open = false; }

static inline void w1_step(w1_t *s, bool a, bool b, outcome_t *out)
{
    s->open = (s->open || a) && !b;
    out->left = -1;
    out->trigger = a;
    out->violation = false;
    out->open = s->open;
    out->answer = b;
    out->finite = !s->open;
    out->verdict = PENDING;
}

static inline void w2_init(w2_t *s)
{
    s->age = -1;
    s->broken = false;
}

static inline void w2_step(w2_t *s, bool a, bool b, int32_t bound, outcome_t *out)
{
    if (b) {
        s->age = -1;
    } else if (s->age >= 0) {
        if (s->age <= bound) {
            s->age++;
        }
    } else if (a) {
        s->age = 0;
    }
    out->open = s->age >= 0;
    out->violation = s->age >= bound;
    out->left = (out->open && s->age <= bound) ? bound - s->age : -1;
    s->broken = s->broken || out->violation;
    out->trigger = a;
    out->answer = b;
    out->finite = !s->broken;
    out->verdict = s->broken ? VIOLATED : PENDING;
}

static inline void w3_init(w3_t *s, int32_t bound)
{
    s->age = bound + 1;
    s->broken = false;
}

static inline void w3_step(w3_t *s, bool a, bool b, int32_t bound, outcome_t *out)
{
    if (b) {
        s->age = 0;
    } else if (s->age <= bound) {
        s->age++;
    }
    out->left = -1;
    out->trigger = a;
    out->violation = a && s->age > bound;
    out->open = false;
    out->answer = false;
    s->broken = s->broken || out->violation;
    out->finite = !s->broken;
    out->verdict = s->broken ? VIOLATED : PENDING;
}

static inline void w4_init(w4_t *s)
{
    s->a_before = true;
    s->since = false;
    s->broken = false;
}

static inline void w4_step(w4_t *s, bool a, bool b, bool c, outcome_t *out)
{
    s->since = b || (!c && s->since);
    out->left = -1;
    out->trigger = a && !s->a_before;
    out->violation = out->trigger && !s->since;
    out->open = false;
    out->answer = false;
    s->a_before = a;
    s->broken = s->broken || out->violation;
    out->finite = !s->broken;
    out->verdict = s->broken ? VIOLATED : PENDING;
}

#endif
