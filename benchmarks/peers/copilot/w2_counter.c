#include <stdint.h>
#include <stdbool.h>
#include <string.h>
#include <stdlib.h>
#include <math.h>

#include "w2_counter_types.h"
#include "w2_counter.h"

static bool b_cpy;
static bool a_cpy;
static int32_t s0[(1)] = {((int32_t)(-1))};
static bool s1[(1)] = {(true)};
static size_t s0_idx = (0);
static size_t s1_idx = (0);

int32_t s0_get(size_t x) {
  return (s0)[((s0_idx) + (x)) % (1)];
}

bool s1_get(size_t x) {
  return (s1)[((s1_idx) + (x)) % (1)];
}

int32_t s0_gen(void) {
  return (b_cpy) ? (int32_t)(-1) : ((((s0_get)((0))) > ((int32_t)(9))) ? (int32_t)(10) : ((((s0_get)((0))) >= ((int32_t)(0))) ? ((s0_get)((0))) + ((int32_t)(1)) : ((a_cpy) ? (int32_t)(0) : ((int32_t)(-1)))));
}

bool s1_gen(void) {
  return (((b_cpy) ? (int32_t)(-1) : ((((s0_get)((0))) > ((int32_t)(9))) ? (int32_t)(10) : ((((s0_get)((0))) >= ((int32_t)(0))) ? ((s0_get)((0))) + ((int32_t)(1)) : ((a_cpy) ? (int32_t)(0) : ((int32_t)(-1)))))) < ((int32_t)(10))) && ((s1_get)((0)));
}

bool verdict_guard(void) {
  return true;
}

bool verdict_arg0(void) {
  return (((b_cpy) ? (int32_t)(-1) : ((((s0_get)((0))) > ((int32_t)(9))) ? (int32_t)(10) : ((((s0_get)((0))) >= ((int32_t)(0))) ? ((s0_get)((0))) + ((int32_t)(1)) : ((a_cpy) ? (int32_t)(0) : ((int32_t)(-1)))))) < ((int32_t)(10))) && ((s1_get)((0)));
}

void step(void) {
  int32_t s0_tmp;
  bool s1_tmp;
  bool verdict_arg_temp0;
  (b_cpy) = (b);
  (a_cpy) = (a);
  if ((verdict_guard)()) {
    {(verdict_arg_temp0) = ((verdict_arg0)());
     (verdict)((verdict_arg_temp0));}
  };
  (s0_tmp) = ((s0_gen)());
  (s1_tmp) = ((s1_gen)());
  ((s0)[s0_idx]) = (s0_tmp);
  ((s1)[s1_idx]) = (s1_tmp);
  (s0_idx) = (((s0_idx) + (1)) % (1));
  (s1_idx) = (((s1_idx) + (1)) % (1));
}
