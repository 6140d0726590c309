/* Runtime monitor of R1: what it says and needs stands in r1_monitor.h */
#include "r1_monitor.h"

/* The literals of a tick: an unknown proposition makes both or none of its literals true. */
typedef struct {
    bool is_too_close;
    bool not_stopped;
    bool is_stopped;
} r1_literals;

static void r1_clear(r1_approximation *approximation)
{
    approximation->since_1 = false;
}

void r1_init(r1_state *state)
{
    r1_clear(&state->certain);
    r1_clear(&state->possible);
}

static inline void r1_advance(r1_approximation *approximation, const r1_literals *now, r1_outcomes *outcomes, bool possible)
{
    fretc_reading *reading;
    /* !stopped S (too_close & !stopped) */
    approximation->since_1 = (now->is_too_close & now->not_stopped) | (now->not_stopped & approximation->since_1);
    /* R1 */
    reading = possible ? &outcomes->r1.possible : &outcomes->r1.certain;
    reading->left = -1;
    reading->violated = false;
    reading->failed = approximation->since_1;
    reading->trigger = now->is_too_close;
    reading->violation = false;
    reading->open = approximation->since_1;
    reading->satisfied_forever = false;
    reading->answer = now->is_stopped;
}

static void r1_judge(fretc_outcome *outcome)
{
    const bool certain = outcome->certain.trigger | outcome->certain.open;
    const bool possible = outcome->possible.trigger | outcome->possible.open;

    if (outcome->certain.violated) {
        outcome->verdict = FRETC_VIOLATED;
    } else if (outcome->certain.satisfied_forever && !outcome->possible.violated) {
        outcome->verdict = FRETC_SATISFIED;
    } else {
        outcome->verdict = FRETC_PENDING;
    }
    /* FRETC_FALSE is 0, FRETC_TRUE 1 and FRETC_UNKNOWN 2: a jump would be guessed wrong each time that it changes. */
    outcome->finite = (fretc_truth)((outcome->certain.failed ? 0u : 1u) << (outcome->possible.failed ? 1u : 0u));
    outcome->obligation_pending = (fretc_truth)((possible ? 2u : 0u) >> (certain ? 1u : 0u));
}

void r1_step(r1_state *state, const r1_inputs *inputs, r1_outcomes *outcomes)
{
    r1_literals now;
    now.is_too_close = inputs->too_close == FRETC_TRUE;
    now.not_stopped = inputs->stopped == FRETC_FALSE;
    now.is_stopped = inputs->stopped == FRETC_TRUE;
    r1_advance(&state->certain, &now, outcomes, false);
    now.is_too_close = inputs->too_close != FRETC_FALSE;
    now.not_stopped = inputs->stopped != FRETC_TRUE;
    now.is_stopped = inputs->stopped != FRETC_FALSE;
    r1_advance(&state->possible, &now, outcomes, true);
    r1_judge(&outcomes->r1);
}
