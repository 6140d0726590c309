#include <stdint.h>
#include <stdbool.h>
#include <string.h>
#include <stdlib.h>
#include <math.h>

#include "w4_library_types.h"
#include "w4_library.h"

static bool a_cpy;
static bool b_cpy;
static bool c_cpy;
static bool s0[(1)] = {(false)};
static bool s1[(1)] = {(false)};
static bool s2[(1)] = {(true)};
static size_t s0_idx = (0);
static size_t s1_idx = (0);
static size_t s2_idx = (0);

bool s0_get(size_t x) {
  return (s0)[((s0_idx) + (x)) % (1)];
}

bool s1_get(size_t x) {
  return (s1)[((s1_idx) + (x)) % (1)];
}

bool s2_get(size_t x) {
  return (s2)[((s2_idx) + (x)) % (1)];
}

bool s0_gen(void) {
  return !(a_cpy);
}

bool s1_gen(void) {
  return (b_cpy) || ((!(c_cpy)) && ((s1_get)((0))));
}

bool s2_gen(void) {
  return ((!((a_cpy) && ((s0_get)((0))))) || ((b_cpy) || ((!(c_cpy)) && ((s1_get)((0)))))) && ((s2_get)((0)));
}

bool verdict_guard(void) {
  return true;
}

bool verdict_arg0(void) {
  return ((!((a_cpy) && ((s0_get)((0))))) || ((b_cpy) || ((!(c_cpy)) && ((s1_get)((0)))))) && ((s2_get)((0)));
}

void step(void) {
  bool s0_tmp;
  bool s1_tmp;
  bool s2_tmp;
  bool verdict_arg_temp0;
  (a_cpy) = (a);
  (b_cpy) = (b);
  (c_cpy) = (c);
  if ((verdict_guard)()) {
    {(verdict_arg_temp0) = ((verdict_arg0)());
     (verdict)((verdict_arg_temp0));}
  };
  (s0_tmp) = ((s0_gen)());
  (s1_tmp) = ((s1_gen)());
  (s2_tmp) = ((s2_gen)());
  ((s0)[s0_idx]) = (s0_tmp);
  ((s1)[s1_idx]) = (s1_tmp);
  ((s2)[s2_idx]) = (s2_tmp);
  (s0_idx) = (((s0_idx) + (1)) % (1));
  (s1_idx) = (((s1_idx) + (1)) % (1));
  (s2_idx) = (((s2_idx) + (1)) % (1));
}
