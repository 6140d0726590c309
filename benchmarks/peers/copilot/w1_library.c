#include <stdint.h>
#include <stdbool.h>
#include <string.h>
#include <stdlib.h>
#include <math.h>

#include "w1_library_types.h"
#include "w1_library.h"

static bool a_cpy;
static bool b_cpy;
static bool s0[(1)] = {(false)};
static size_t s0_idx = (0);

bool s0_get(size_t x) {
  return (s0)[((s0_idx) + (x)) % (1)];
}

bool s0_gen(void) {
  return ((a_cpy) && (!(b_cpy))) || ((!(b_cpy)) && ((s0_get)((0))));
}

bool verdict_guard(void) {
  return true;
}

bool verdict_arg0(void) {
  return !(((a_cpy) && (!(b_cpy))) || ((!(b_cpy)) && ((s0_get)((0)))));
}

void step(void) {
  bool s0_tmp;
  bool verdict_arg_temp0;
  (a_cpy) = (a);
  (b_cpy) = (b);
  if ((verdict_guard)()) {
    {(verdict_arg_temp0) = ((verdict_arg0)());
     (verdict)((verdict_arg_temp0));}
  };
  (s0_tmp) = ((s0_gen)());
  ((s0)[s0_idx]) = (s0_tmp);
  (s0_idx) = (((s0_idx) + (1)) % (1));
}
