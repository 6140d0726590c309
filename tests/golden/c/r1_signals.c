/* What samples say of the propositions of R1, as `fretc audit` reads them. */
#include "r1_signals.h"

fretc_number r1_sample_vx(fretc_number field)
{
    const fretc_number x = field;
    return fretc_recorded(fretc_meant(x, fretc_meaning_of(x, FRETC_TRUE, FRETC_UNKNOWABLE, FRETC_UNKNOWABLE, FRETC_UNKNOWABLE, FRETC_UNKNOWABLE)));
}

fretc_number r1_sample_wz(fretc_number field)
{
    const fretc_number x = field;
    return fretc_recorded(fretc_meant(x, fretc_meaning_of(x, FRETC_TRUE, FRETC_UNKNOWABLE, FRETC_UNKNOWABLE, FRETC_UNKNOWABLE, FRETC_UNKNOWABLE)));
}

void r1_instant(const r1_samples *samples, int64_t now, const r1_held *held, r1_inputs *inputs)
{
    const fretc_number s_clearance = fretc_in_force(samples->clearance, now, true, UINT64_C(300000000));
    const fretc_number s_vx = fretc_in_force(samples->vx, now, true, UINT64_C(100000000));
    const fretc_number s_wz = fretc_in_force(samples->wz, now, true, UINT64_C(100000000));
    (void)s_clearance;
    (void)s_vx;
    (void)s_wz;

    (void)held;
    inputs->too_close = fretc_compared_with(s_clearance, FRETC_LT, 0x1.99999a0000000p-5, 0x1.999999999999ap-5, 0x1.999999999999ap-5, UINT64_C(0));
    inputs->stopped = held->stopped_for_1;
}

void r1_holding(const r1_samples *samples, int64_t now, const r1_held *held, r1_held *holding)
{
    const fretc_number s_clearance = fretc_in_force(samples->clearance, now, true, UINT64_C(300000000));
    const fretc_number s_vx = fretc_in_force(samples->vx, now, true, UINT64_C(100000000));
    const fretc_number s_wz = fretc_in_force(samples->wz, now, true, UINT64_C(100000000));
    (void)s_clearance;
    (void)s_vx;
    (void)s_wz;

    (void)held;
    holding->stopped_for_1 = fretc_both(fretc_compared_with(fretc_absolute(s_vx), FRETC_LT, 0x1.47ae140000000p-7, 0x1.47ae147ae147bp-7, 0x1.47ae147ae147bp-7, UINT64_C(0)), fretc_compared_with(fretc_absolute(s_wz), FRETC_LT, 0x1.47ae140000000p-7, 0x1.47ae147ae147bp-7, 0x1.47ae147ae147bp-7, UINT64_C(0)));
}

void r1_gather(r1_inputs *tick, const r1_inputs *next)
{
    tick->too_close = fretc_either(tick->too_close, next->too_close);
    tick->stopped = next->stopped;
}

void r1_assume(r1_inputs *tick)
{
    (void)tick;
}
