#include <stdint.h>
#include <stdbool.h>
#include <string.h>
#include <stdlib.h>
#include <math.h>

#include "w2_library_types.h"
#include "w2_library.h"

static bool a_cpy;
static bool b_cpy;
static int64_t s0[(1)] = {((int64_t)(0))};
static int64_t s1[(1)] = {((int64_t)(0))};
static bool s2[(1)] = {(false)};
static int64_t s3[(1)] = {((int64_t)(0))};
static bool s4[(1)] = {(false)};
static int64_t s5[(1)] = {((int64_t)(0))};
static bool s6[(1)] = {(false)};
static int64_t s7[(1)] = {((int64_t)(0))};
static bool s8[(1)] = {(false)};
static int64_t s9[(1)] = {((int64_t)(0))};
static bool s10[(1)] = {(false)};
static int64_t s11[(1)] = {((int64_t)(0))};
static bool s12[(1)] = {(false)};
static int64_t s13[(1)] = {((int64_t)(0))};
static bool s14[(1)] = {(false)};
static int64_t s15[(1)] = {((int64_t)(0))};
static bool s16[(1)] = {(false)};
static int64_t s17[(1)] = {((int64_t)(0))};
static bool s18[(1)] = {(false)};
static int64_t s19[(1)] = {((int64_t)(0))};
static bool s20[(1)] = {(false)};
static int64_t s21[(1)] = {((int64_t)(0))};
static bool s22[(1)] = {(false)};
static int64_t s23[(1)] = {((int64_t)(0))};
static bool s24[(1)] = {(false)};
static int64_t s25[(1)] = {((int64_t)(0))};
static bool s26[(1)] = {(false)};
static int64_t s27[(1)] = {((int64_t)(0))};
static bool s28[(1)] = {(false)};
static int64_t s29[(1)] = {((int64_t)(0))};
static bool s30[(1)] = {(false)};
static int64_t s31[(1)] = {((int64_t)(0))};
static bool s32[(1)] = {(false)};
static int64_t s33[(1)] = {((int64_t)(0))};
static bool s34[(1)] = {(false)};
static int64_t s35[(1)] = {((int64_t)(0))};
static bool s36[(1)] = {(false)};
static int64_t s37[(1)] = {((int64_t)(0))};
static bool s38[(1)] = {(false)};
static int64_t s39[(1)] = {((int64_t)(0))};
static bool s40[(1)] = {(false)};
static bool s41[(1)] = {(true)};
static size_t s0_idx = (0);
static size_t s1_idx = (0);
static size_t s2_idx = (0);
static size_t s3_idx = (0);
static size_t s4_idx = (0);
static size_t s5_idx = (0);
static size_t s6_idx = (0);
static size_t s7_idx = (0);
static size_t s8_idx = (0);
static size_t s9_idx = (0);
static size_t s10_idx = (0);
static size_t s11_idx = (0);
static size_t s12_idx = (0);
static size_t s13_idx = (0);
static size_t s14_idx = (0);
static size_t s15_idx = (0);
static size_t s16_idx = (0);
static size_t s17_idx = (0);
static size_t s18_idx = (0);
static size_t s19_idx = (0);
static size_t s20_idx = (0);
static size_t s21_idx = (0);
static size_t s22_idx = (0);
static size_t s23_idx = (0);
static size_t s24_idx = (0);
static size_t s25_idx = (0);
static size_t s26_idx = (0);
static size_t s27_idx = (0);
static size_t s28_idx = (0);
static size_t s29_idx = (0);
static size_t s30_idx = (0);
static size_t s31_idx = (0);
static size_t s32_idx = (0);
static size_t s33_idx = (0);
static size_t s34_idx = (0);
static size_t s35_idx = (0);
static size_t s36_idx = (0);
static size_t s37_idx = (0);
static size_t s38_idx = (0);
static size_t s39_idx = (0);
static size_t s40_idx = (0);
static size_t s41_idx = (0);

int64_t s0_get(size_t x) {
  return (s0)[((s0_idx) + (x)) % (1)];
}

int64_t s1_get(size_t x) {
  return (s1)[((s1_idx) + (x)) % (1)];
}

bool s2_get(size_t x) {
  return (s2)[((s2_idx) + (x)) % (1)];
}

int64_t s3_get(size_t x) {
  return (s3)[((s3_idx) + (x)) % (1)];
}

bool s4_get(size_t x) {
  return (s4)[((s4_idx) + (x)) % (1)];
}

int64_t s5_get(size_t x) {
  return (s5)[((s5_idx) + (x)) % (1)];
}

bool s6_get(size_t x) {
  return (s6)[((s6_idx) + (x)) % (1)];
}

int64_t s7_get(size_t x) {
  return (s7)[((s7_idx) + (x)) % (1)];
}

bool s8_get(size_t x) {
  return (s8)[((s8_idx) + (x)) % (1)];
}

int64_t s9_get(size_t x) {
  return (s9)[((s9_idx) + (x)) % (1)];
}

bool s10_get(size_t x) {
  return (s10)[((s10_idx) + (x)) % (1)];
}

int64_t s11_get(size_t x) {
  return (s11)[((s11_idx) + (x)) % (1)];
}

bool s12_get(size_t x) {
  return (s12)[((s12_idx) + (x)) % (1)];
}

int64_t s13_get(size_t x) {
  return (s13)[((s13_idx) + (x)) % (1)];
}

bool s14_get(size_t x) {
  return (s14)[((s14_idx) + (x)) % (1)];
}

int64_t s15_get(size_t x) {
  return (s15)[((s15_idx) + (x)) % (1)];
}

bool s16_get(size_t x) {
  return (s16)[((s16_idx) + (x)) % (1)];
}

int64_t s17_get(size_t x) {
  return (s17)[((s17_idx) + (x)) % (1)];
}

bool s18_get(size_t x) {
  return (s18)[((s18_idx) + (x)) % (1)];
}

int64_t s19_get(size_t x) {
  return (s19)[((s19_idx) + (x)) % (1)];
}

bool s20_get(size_t x) {
  return (s20)[((s20_idx) + (x)) % (1)];
}

int64_t s21_get(size_t x) {
  return (s21)[((s21_idx) + (x)) % (1)];
}

bool s22_get(size_t x) {
  return (s22)[((s22_idx) + (x)) % (1)];
}

int64_t s23_get(size_t x) {
  return (s23)[((s23_idx) + (x)) % (1)];
}

bool s24_get(size_t x) {
  return (s24)[((s24_idx) + (x)) % (1)];
}

int64_t s25_get(size_t x) {
  return (s25)[((s25_idx) + (x)) % (1)];
}

bool s26_get(size_t x) {
  return (s26)[((s26_idx) + (x)) % (1)];
}

int64_t s27_get(size_t x) {
  return (s27)[((s27_idx) + (x)) % (1)];
}

bool s28_get(size_t x) {
  return (s28)[((s28_idx) + (x)) % (1)];
}

int64_t s29_get(size_t x) {
  return (s29)[((s29_idx) + (x)) % (1)];
}

bool s30_get(size_t x) {
  return (s30)[((s30_idx) + (x)) % (1)];
}

int64_t s31_get(size_t x) {
  return (s31)[((s31_idx) + (x)) % (1)];
}

bool s32_get(size_t x) {
  return (s32)[((s32_idx) + (x)) % (1)];
}

int64_t s33_get(size_t x) {
  return (s33)[((s33_idx) + (x)) % (1)];
}

bool s34_get(size_t x) {
  return (s34)[((s34_idx) + (x)) % (1)];
}

int64_t s35_get(size_t x) {
  return (s35)[((s35_idx) + (x)) % (1)];
}

bool s36_get(size_t x) {
  return (s36)[((s36_idx) + (x)) % (1)];
}

int64_t s37_get(size_t x) {
  return (s37)[((s37_idx) + (x)) % (1)];
}

bool s38_get(size_t x) {
  return (s38)[((s38_idx) + (x)) % (1)];
}

int64_t s39_get(size_t x) {
  return (s39)[((s39_idx) + (x)) % (1)];
}

bool s40_get(size_t x) {
  return (s40)[((s40_idx) + (x)) % (1)];
}

bool s41_get(size_t x) {
  return (s41)[((s41_idx) + (x)) % (1)];
}

int64_t s0_gen(void) {
  return ((s0_get)((0))) + ((int64_t)(1));
}

int64_t s1_gen(void) {
  return (s0_get)((0));
}

bool s2_gen(void) {
  return a_cpy;
}

int64_t s3_gen(void) {
  return (s1_get)((0));
}

bool s4_gen(void) {
  return (s2_get)((0));
}

int64_t s5_gen(void) {
  return (s3_get)((0));
}

bool s6_gen(void) {
  return (s4_get)((0));
}

int64_t s7_gen(void) {
  return (s5_get)((0));
}

bool s8_gen(void) {
  return (s6_get)((0));
}

int64_t s9_gen(void) {
  return (s7_get)((0));
}

bool s10_gen(void) {
  return (s8_get)((0));
}

int64_t s11_gen(void) {
  return (s9_get)((0));
}

bool s12_gen(void) {
  return (s10_get)((0));
}

int64_t s13_gen(void) {
  return (s11_get)((0));
}

bool s14_gen(void) {
  return (s12_get)((0));
}

int64_t s15_gen(void) {
  return (s13_get)((0));
}

bool s16_gen(void) {
  return (s14_get)((0));
}

int64_t s17_gen(void) {
  return (s15_get)((0));
}

bool s18_gen(void) {
  return (s16_get)((0));
}

int64_t s19_gen(void) {
  return (s17_get)((0));
}

bool s20_gen(void) {
  return (s18_get)((0));
}

int64_t s21_gen(void) {
  return (s0_get)((0));
}

bool s22_gen(void) {
  return b_cpy;
}

int64_t s23_gen(void) {
  return (s21_get)((0));
}

bool s24_gen(void) {
  return (s22_get)((0));
}

int64_t s25_gen(void) {
  return (s23_get)((0));
}

bool s26_gen(void) {
  return (s24_get)((0));
}

int64_t s27_gen(void) {
  return (s25_get)((0));
}

bool s28_gen(void) {
  return (s26_get)((0));
}

int64_t s29_gen(void) {
  return (s27_get)((0));
}

bool s30_gen(void) {
  return (s28_get)((0));
}

int64_t s31_gen(void) {
  return (s29_get)((0));
}

bool s32_gen(void) {
  return (s30_get)((0));
}

int64_t s33_gen(void) {
  return (s31_get)((0));
}

bool s34_gen(void) {
  return (s32_get)((0));
}

int64_t s35_gen(void) {
  return (s33_get)((0));
}

bool s36_gen(void) {
  return (s34_get)((0));
}

int64_t s37_gen(void) {
  return (s35_get)((0));
}

bool s38_gen(void) {
  return (s36_get)((0));
}

int64_t s39_gen(void) {
  return (s37_get)((0));
}

bool s40_gen(void) {
  return (s38_get)((0));
}

bool s41_gen(void) {
  return ((!(((((s0_get)((0))) - ((int64_t)(10))) <= ((s0_get)((0)))) && (((((s0_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && (a_cpy)) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s1_get)((0)))) && (((((s1_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s2_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s3_get)((0)))) && (((((s3_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s4_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s5_get)((0)))) && (((((s5_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s6_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s7_get)((0)))) && (((((s7_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s8_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s9_get)((0)))) && (((((s9_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s10_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s11_get)((0)))) && (((((s11_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s12_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s13_get)((0)))) && (((((s13_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s14_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s15_get)((0)))) && (((((s15_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s16_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s17_get)((0)))) && (((((s17_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s18_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s19_get)((0)))) && ((((s19_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s20_get)((0)))))))))))))))))))))))))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s0_get)((0)))) && (((((s0_get)((0))) <= ((s0_get)((0)))) && (b_cpy)) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s21_get)((0)))) && (((((s21_get)((0))) <= ((s0_get)((0)))) && ((s22_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s23_get)((0)))) && (((((s23_get)((0))) <= ((s0_get)((0)))) && ((s24_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s25_get)((0)))) && (((((s25_get)((0))) <= ((s0_get)((0)))) && ((s26_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s27_get)((0)))) && (((((s27_get)((0))) <= ((s0_get)((0)))) && ((s28_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s29_get)((0)))) && (((((s29_get)((0))) <= ((s0_get)((0)))) && ((s30_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s31_get)((0)))) && (((((s31_get)((0))) <= ((s0_get)((0)))) && ((s32_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s33_get)((0)))) && (((((s33_get)((0))) <= ((s0_get)((0)))) && ((s34_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s35_get)((0)))) && (((((s35_get)((0))) <= ((s0_get)((0)))) && ((s36_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s37_get)((0)))) && (((((s37_get)((0))) <= ((s0_get)((0)))) && ((s38_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s39_get)((0)))) && ((((s39_get)((0))) <= ((s0_get)((0)))) && ((s40_get)((0)))))))))))))))))))))))))) && ((s41_get)((0)));
}

bool verdict_guard(void) {
  return true;
}

bool verdict_arg0(void) {
  return ((!(((((s0_get)((0))) - ((int64_t)(10))) <= ((s0_get)((0)))) && (((((s0_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && (a_cpy)) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s1_get)((0)))) && (((((s1_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s2_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s3_get)((0)))) && (((((s3_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s4_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s5_get)((0)))) && (((((s5_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s6_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s7_get)((0)))) && (((((s7_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s8_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s9_get)((0)))) && (((((s9_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s10_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s11_get)((0)))) && (((((s11_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s12_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s13_get)((0)))) && (((((s13_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s14_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s15_get)((0)))) && (((((s15_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s16_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s17_get)((0)))) && (((((s17_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s18_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s19_get)((0)))) && ((((s19_get)((0))) <= (((s0_get)((0))) - ((int64_t)(10)))) && ((s20_get)((0)))))))))))))))))))))))))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s0_get)((0)))) && (((((s0_get)((0))) <= ((s0_get)((0)))) && (b_cpy)) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s21_get)((0)))) && (((((s21_get)((0))) <= ((s0_get)((0)))) && ((s22_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s23_get)((0)))) && (((((s23_get)((0))) <= ((s0_get)((0)))) && ((s24_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s25_get)((0)))) && (((((s25_get)((0))) <= ((s0_get)((0)))) && ((s26_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s27_get)((0)))) && (((((s27_get)((0))) <= ((s0_get)((0)))) && ((s28_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s29_get)((0)))) && (((((s29_get)((0))) <= ((s0_get)((0)))) && ((s30_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s31_get)((0)))) && (((((s31_get)((0))) <= ((s0_get)((0)))) && ((s32_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s33_get)((0)))) && (((((s33_get)((0))) <= ((s0_get)((0)))) && ((s34_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s35_get)((0)))) && (((((s35_get)((0))) <= ((s0_get)((0)))) && ((s36_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s37_get)((0)))) && (((((s37_get)((0))) <= ((s0_get)((0)))) && ((s38_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(10))) <= ((s39_get)((0)))) && ((((s39_get)((0))) <= ((s0_get)((0)))) && ((s40_get)((0)))))))))))))))))))))))))) && ((s41_get)((0)));
}

void step(void) {
  int64_t s0_tmp;
  int64_t s1_tmp;
  bool s2_tmp;
  int64_t s3_tmp;
  bool s4_tmp;
  int64_t s5_tmp;
  bool s6_tmp;
  int64_t s7_tmp;
  bool s8_tmp;
  int64_t s9_tmp;
  bool s10_tmp;
  int64_t s11_tmp;
  bool s12_tmp;
  int64_t s13_tmp;
  bool s14_tmp;
  int64_t s15_tmp;
  bool s16_tmp;
  int64_t s17_tmp;
  bool s18_tmp;
  int64_t s19_tmp;
  bool s20_tmp;
  int64_t s21_tmp;
  bool s22_tmp;
  int64_t s23_tmp;
  bool s24_tmp;
  int64_t s25_tmp;
  bool s26_tmp;
  int64_t s27_tmp;
  bool s28_tmp;
  int64_t s29_tmp;
  bool s30_tmp;
  int64_t s31_tmp;
  bool s32_tmp;
  int64_t s33_tmp;
  bool s34_tmp;
  int64_t s35_tmp;
  bool s36_tmp;
  int64_t s37_tmp;
  bool s38_tmp;
  int64_t s39_tmp;
  bool s40_tmp;
  bool s41_tmp;
  bool verdict_arg_temp0;
  (a_cpy) = (a);
  (b_cpy) = (b);
  if ((verdict_guard)()) {
    {(verdict_arg_temp0) = ((verdict_arg0)());
     (verdict)((verdict_arg_temp0));}
  };
  (s0_tmp) = ((s0_gen)());
  (s1_tmp) = ((s1_gen)());
  (s2_tmp) = ((s2_gen)());
  (s3_tmp) = ((s3_gen)());
  (s4_tmp) = ((s4_gen)());
  (s5_tmp) = ((s5_gen)());
  (s6_tmp) = ((s6_gen)());
  (s7_tmp) = ((s7_gen)());
  (s8_tmp) = ((s8_gen)());
  (s9_tmp) = ((s9_gen)());
  (s10_tmp) = ((s10_gen)());
  (s11_tmp) = ((s11_gen)());
  (s12_tmp) = ((s12_gen)());
  (s13_tmp) = ((s13_gen)());
  (s14_tmp) = ((s14_gen)());
  (s15_tmp) = ((s15_gen)());
  (s16_tmp) = ((s16_gen)());
  (s17_tmp) = ((s17_gen)());
  (s18_tmp) = ((s18_gen)());
  (s19_tmp) = ((s19_gen)());
  (s20_tmp) = ((s20_gen)());
  (s21_tmp) = ((s21_gen)());
  (s22_tmp) = ((s22_gen)());
  (s23_tmp) = ((s23_gen)());
  (s24_tmp) = ((s24_gen)());
  (s25_tmp) = ((s25_gen)());
  (s26_tmp) = ((s26_gen)());
  (s27_tmp) = ((s27_gen)());
  (s28_tmp) = ((s28_gen)());
  (s29_tmp) = ((s29_gen)());
  (s30_tmp) = ((s30_gen)());
  (s31_tmp) = ((s31_gen)());
  (s32_tmp) = ((s32_gen)());
  (s33_tmp) = ((s33_gen)());
  (s34_tmp) = ((s34_gen)());
  (s35_tmp) = ((s35_gen)());
  (s36_tmp) = ((s36_gen)());
  (s37_tmp) = ((s37_gen)());
  (s38_tmp) = ((s38_gen)());
  (s39_tmp) = ((s39_gen)());
  (s40_tmp) = ((s40_gen)());
  (s41_tmp) = ((s41_gen)());
  ((s0)[s0_idx]) = (s0_tmp);
  ((s1)[s1_idx]) = (s1_tmp);
  ((s2)[s2_idx]) = (s2_tmp);
  ((s3)[s3_idx]) = (s3_tmp);
  ((s4)[s4_idx]) = (s4_tmp);
  ((s5)[s5_idx]) = (s5_tmp);
  ((s6)[s6_idx]) = (s6_tmp);
  ((s7)[s7_idx]) = (s7_tmp);
  ((s8)[s8_idx]) = (s8_tmp);
  ((s9)[s9_idx]) = (s9_tmp);
  ((s10)[s10_idx]) = (s10_tmp);
  ((s11)[s11_idx]) = (s11_tmp);
  ((s12)[s12_idx]) = (s12_tmp);
  ((s13)[s13_idx]) = (s13_tmp);
  ((s14)[s14_idx]) = (s14_tmp);
  ((s15)[s15_idx]) = (s15_tmp);
  ((s16)[s16_idx]) = (s16_tmp);
  ((s17)[s17_idx]) = (s17_tmp);
  ((s18)[s18_idx]) = (s18_tmp);
  ((s19)[s19_idx]) = (s19_tmp);
  ((s20)[s20_idx]) = (s20_tmp);
  ((s21)[s21_idx]) = (s21_tmp);
  ((s22)[s22_idx]) = (s22_tmp);
  ((s23)[s23_idx]) = (s23_tmp);
  ((s24)[s24_idx]) = (s24_tmp);
  ((s25)[s25_idx]) = (s25_tmp);
  ((s26)[s26_idx]) = (s26_tmp);
  ((s27)[s27_idx]) = (s27_tmp);
  ((s28)[s28_idx]) = (s28_tmp);
  ((s29)[s29_idx]) = (s29_tmp);
  ((s30)[s30_idx]) = (s30_tmp);
  ((s31)[s31_idx]) = (s31_tmp);
  ((s32)[s32_idx]) = (s32_tmp);
  ((s33)[s33_idx]) = (s33_tmp);
  ((s34)[s34_idx]) = (s34_tmp);
  ((s35)[s35_idx]) = (s35_tmp);
  ((s36)[s36_idx]) = (s36_tmp);
  ((s37)[s37_idx]) = (s37_tmp);
  ((s38)[s38_idx]) = (s38_tmp);
  ((s39)[s39_idx]) = (s39_tmp);
  ((s40)[s40_idx]) = (s40_tmp);
  ((s41)[s41_idx]) = (s41_tmp);
  (s0_idx) = (((s0_idx) + (1)) % (1));
  (s1_idx) = (((s1_idx) + (1)) % (1));
  (s2_idx) = (((s2_idx) + (1)) % (1));
  (s3_idx) = (((s3_idx) + (1)) % (1));
  (s4_idx) = (((s4_idx) + (1)) % (1));
  (s5_idx) = (((s5_idx) + (1)) % (1));
  (s6_idx) = (((s6_idx) + (1)) % (1));
  (s7_idx) = (((s7_idx) + (1)) % (1));
  (s8_idx) = (((s8_idx) + (1)) % (1));
  (s9_idx) = (((s9_idx) + (1)) % (1));
  (s10_idx) = (((s10_idx) + (1)) % (1));
  (s11_idx) = (((s11_idx) + (1)) % (1));
  (s12_idx) = (((s12_idx) + (1)) % (1));
  (s13_idx) = (((s13_idx) + (1)) % (1));
  (s14_idx) = (((s14_idx) + (1)) % (1));
  (s15_idx) = (((s15_idx) + (1)) % (1));
  (s16_idx) = (((s16_idx) + (1)) % (1));
  (s17_idx) = (((s17_idx) + (1)) % (1));
  (s18_idx) = (((s18_idx) + (1)) % (1));
  (s19_idx) = (((s19_idx) + (1)) % (1));
  (s20_idx) = (((s20_idx) + (1)) % (1));
  (s21_idx) = (((s21_idx) + (1)) % (1));
  (s22_idx) = (((s22_idx) + (1)) % (1));
  (s23_idx) = (((s23_idx) + (1)) % (1));
  (s24_idx) = (((s24_idx) + (1)) % (1));
  (s25_idx) = (((s25_idx) + (1)) % (1));
  (s26_idx) = (((s26_idx) + (1)) % (1));
  (s27_idx) = (((s27_idx) + (1)) % (1));
  (s28_idx) = (((s28_idx) + (1)) % (1));
  (s29_idx) = (((s29_idx) + (1)) % (1));
  (s30_idx) = (((s30_idx) + (1)) % (1));
  (s31_idx) = (((s31_idx) + (1)) % (1));
  (s32_idx) = (((s32_idx) + (1)) % (1));
  (s33_idx) = (((s33_idx) + (1)) % (1));
  (s34_idx) = (((s34_idx) + (1)) % (1));
  (s35_idx) = (((s35_idx) + (1)) % (1));
  (s36_idx) = (((s36_idx) + (1)) % (1));
  (s37_idx) = (((s37_idx) + (1)) % (1));
  (s38_idx) = (((s38_idx) + (1)) % (1));
  (s39_idx) = (((s39_idx) + (1)) % (1));
  (s40_idx) = (((s40_idx) + (1)) % (1));
  (s41_idx) = (((s41_idx) + (1)) % (1));
}
