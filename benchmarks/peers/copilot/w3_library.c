#include <stdint.h>
#include <stdbool.h>
#include <string.h>
#include <stdlib.h>
#include <math.h>

#include "w3_library_types.h"
#include "w3_library.h"

static bool b_cpy;
static bool a_cpy;
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
static int64_t s41[(1)] = {((int64_t)(0))};
static bool s42[(1)] = {(false)};
static int64_t s43[(1)] = {((int64_t)(0))};
static bool s44[(1)] = {(false)};
static int64_t s45[(1)] = {((int64_t)(0))};
static bool s46[(1)] = {(false)};
static int64_t s47[(1)] = {((int64_t)(0))};
static bool s48[(1)] = {(false)};
static int64_t s49[(1)] = {((int64_t)(0))};
static bool s50[(1)] = {(false)};
static int64_t s51[(1)] = {((int64_t)(0))};
static bool s52[(1)] = {(false)};
static int64_t s53[(1)] = {((int64_t)(0))};
static bool s54[(1)] = {(false)};
static int64_t s55[(1)] = {((int64_t)(0))};
static bool s56[(1)] = {(false)};
static int64_t s57[(1)] = {((int64_t)(0))};
static bool s58[(1)] = {(false)};
static int64_t s59[(1)] = {((int64_t)(0))};
static bool s60[(1)] = {(false)};
static int64_t s61[(1)] = {((int64_t)(0))};
static bool s62[(1)] = {(false)};
static int64_t s63[(1)] = {((int64_t)(0))};
static bool s64[(1)] = {(false)};
static int64_t s65[(1)] = {((int64_t)(0))};
static bool s66[(1)] = {(false)};
static int64_t s67[(1)] = {((int64_t)(0))};
static bool s68[(1)] = {(false)};
static int64_t s69[(1)] = {((int64_t)(0))};
static bool s70[(1)] = {(false)};
static int64_t s71[(1)] = {((int64_t)(0))};
static bool s72[(1)] = {(false)};
static int64_t s73[(1)] = {((int64_t)(0))};
static bool s74[(1)] = {(false)};
static int64_t s75[(1)] = {((int64_t)(0))};
static bool s76[(1)] = {(false)};
static int64_t s77[(1)] = {((int64_t)(0))};
static bool s78[(1)] = {(false)};
static int64_t s79[(1)] = {((int64_t)(0))};
static bool s80[(1)] = {(false)};
static int64_t s81[(1)] = {((int64_t)(0))};
static bool s82[(1)] = {(false)};
static int64_t s83[(1)] = {((int64_t)(0))};
static bool s84[(1)] = {(false)};
static int64_t s85[(1)] = {((int64_t)(0))};
static bool s86[(1)] = {(false)};
static int64_t s87[(1)] = {((int64_t)(0))};
static bool s88[(1)] = {(false)};
static int64_t s89[(1)] = {((int64_t)(0))};
static bool s90[(1)] = {(false)};
static int64_t s91[(1)] = {((int64_t)(0))};
static bool s92[(1)] = {(false)};
static int64_t s93[(1)] = {((int64_t)(0))};
static bool s94[(1)] = {(false)};
static int64_t s95[(1)] = {((int64_t)(0))};
static bool s96[(1)] = {(false)};
static int64_t s97[(1)] = {((int64_t)(0))};
static bool s98[(1)] = {(false)};
static int64_t s99[(1)] = {((int64_t)(0))};
static bool s100[(1)] = {(false)};
static int64_t s101[(1)] = {((int64_t)(0))};
static bool s102[(1)] = {(false)};
static int64_t s103[(1)] = {((int64_t)(0))};
static bool s104[(1)] = {(false)};
static int64_t s105[(1)] = {((int64_t)(0))};
static bool s106[(1)] = {(false)};
static int64_t s107[(1)] = {((int64_t)(0))};
static bool s108[(1)] = {(false)};
static int64_t s109[(1)] = {((int64_t)(0))};
static bool s110[(1)] = {(false)};
static int64_t s111[(1)] = {((int64_t)(0))};
static bool s112[(1)] = {(false)};
static int64_t s113[(1)] = {((int64_t)(0))};
static bool s114[(1)] = {(false)};
static int64_t s115[(1)] = {((int64_t)(0))};
static bool s116[(1)] = {(false)};
static int64_t s117[(1)] = {((int64_t)(0))};
static bool s118[(1)] = {(false)};
static int64_t s119[(1)] = {((int64_t)(0))};
static bool s120[(1)] = {(false)};
static int64_t s121[(1)] = {((int64_t)(0))};
static bool s122[(1)] = {(false)};
static int64_t s123[(1)] = {((int64_t)(0))};
static bool s124[(1)] = {(false)};
static int64_t s125[(1)] = {((int64_t)(0))};
static bool s126[(1)] = {(false)};
static int64_t s127[(1)] = {((int64_t)(0))};
static bool s128[(1)] = {(false)};
static int64_t s129[(1)] = {((int64_t)(0))};
static bool s130[(1)] = {(false)};
static int64_t s131[(1)] = {((int64_t)(0))};
static bool s132[(1)] = {(false)};
static int64_t s133[(1)] = {((int64_t)(0))};
static bool s134[(1)] = {(false)};
static int64_t s135[(1)] = {((int64_t)(0))};
static bool s136[(1)] = {(false)};
static int64_t s137[(1)] = {((int64_t)(0))};
static bool s138[(1)] = {(false)};
static int64_t s139[(1)] = {((int64_t)(0))};
static bool s140[(1)] = {(false)};
static int64_t s141[(1)] = {((int64_t)(0))};
static bool s142[(1)] = {(false)};
static int64_t s143[(1)] = {((int64_t)(0))};
static bool s144[(1)] = {(false)};
static int64_t s145[(1)] = {((int64_t)(0))};
static bool s146[(1)] = {(false)};
static int64_t s147[(1)] = {((int64_t)(0))};
static bool s148[(1)] = {(false)};
static int64_t s149[(1)] = {((int64_t)(0))};
static bool s150[(1)] = {(false)};
static int64_t s151[(1)] = {((int64_t)(0))};
static bool s152[(1)] = {(false)};
static int64_t s153[(1)] = {((int64_t)(0))};
static bool s154[(1)] = {(false)};
static int64_t s155[(1)] = {((int64_t)(0))};
static bool s156[(1)] = {(false)};
static int64_t s157[(1)] = {((int64_t)(0))};
static bool s158[(1)] = {(false)};
static int64_t s159[(1)] = {((int64_t)(0))};
static bool s160[(1)] = {(false)};
static int64_t s161[(1)] = {((int64_t)(0))};
static bool s162[(1)] = {(false)};
static int64_t s163[(1)] = {((int64_t)(0))};
static bool s164[(1)] = {(false)};
static int64_t s165[(1)] = {((int64_t)(0))};
static bool s166[(1)] = {(false)};
static int64_t s167[(1)] = {((int64_t)(0))};
static bool s168[(1)] = {(false)};
static int64_t s169[(1)] = {((int64_t)(0))};
static bool s170[(1)] = {(false)};
static int64_t s171[(1)] = {((int64_t)(0))};
static bool s172[(1)] = {(false)};
static int64_t s173[(1)] = {((int64_t)(0))};
static bool s174[(1)] = {(false)};
static int64_t s175[(1)] = {((int64_t)(0))};
static bool s176[(1)] = {(false)};
static int64_t s177[(1)] = {((int64_t)(0))};
static bool s178[(1)] = {(false)};
static int64_t s179[(1)] = {((int64_t)(0))};
static bool s180[(1)] = {(false)};
static int64_t s181[(1)] = {((int64_t)(0))};
static bool s182[(1)] = {(false)};
static int64_t s183[(1)] = {((int64_t)(0))};
static bool s184[(1)] = {(false)};
static int64_t s185[(1)] = {((int64_t)(0))};
static bool s186[(1)] = {(false)};
static int64_t s187[(1)] = {((int64_t)(0))};
static bool s188[(1)] = {(false)};
static int64_t s189[(1)] = {((int64_t)(0))};
static bool s190[(1)] = {(false)};
static int64_t s191[(1)] = {((int64_t)(0))};
static bool s192[(1)] = {(false)};
static int64_t s193[(1)] = {((int64_t)(0))};
static bool s194[(1)] = {(false)};
static int64_t s195[(1)] = {((int64_t)(0))};
static bool s196[(1)] = {(false)};
static int64_t s197[(1)] = {((int64_t)(0))};
static bool s198[(1)] = {(false)};
static int64_t s199[(1)] = {((int64_t)(0))};
static bool s200[(1)] = {(false)};
static bool s201[(1)] = {(true)};
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
static size_t s42_idx = (0);
static size_t s43_idx = (0);
static size_t s44_idx = (0);
static size_t s45_idx = (0);
static size_t s46_idx = (0);
static size_t s47_idx = (0);
static size_t s48_idx = (0);
static size_t s49_idx = (0);
static size_t s50_idx = (0);
static size_t s51_idx = (0);
static size_t s52_idx = (0);
static size_t s53_idx = (0);
static size_t s54_idx = (0);
static size_t s55_idx = (0);
static size_t s56_idx = (0);
static size_t s57_idx = (0);
static size_t s58_idx = (0);
static size_t s59_idx = (0);
static size_t s60_idx = (0);
static size_t s61_idx = (0);
static size_t s62_idx = (0);
static size_t s63_idx = (0);
static size_t s64_idx = (0);
static size_t s65_idx = (0);
static size_t s66_idx = (0);
static size_t s67_idx = (0);
static size_t s68_idx = (0);
static size_t s69_idx = (0);
static size_t s70_idx = (0);
static size_t s71_idx = (0);
static size_t s72_idx = (0);
static size_t s73_idx = (0);
static size_t s74_idx = (0);
static size_t s75_idx = (0);
static size_t s76_idx = (0);
static size_t s77_idx = (0);
static size_t s78_idx = (0);
static size_t s79_idx = (0);
static size_t s80_idx = (0);
static size_t s81_idx = (0);
static size_t s82_idx = (0);
static size_t s83_idx = (0);
static size_t s84_idx = (0);
static size_t s85_idx = (0);
static size_t s86_idx = (0);
static size_t s87_idx = (0);
static size_t s88_idx = (0);
static size_t s89_idx = (0);
static size_t s90_idx = (0);
static size_t s91_idx = (0);
static size_t s92_idx = (0);
static size_t s93_idx = (0);
static size_t s94_idx = (0);
static size_t s95_idx = (0);
static size_t s96_idx = (0);
static size_t s97_idx = (0);
static size_t s98_idx = (0);
static size_t s99_idx = (0);
static size_t s100_idx = (0);
static size_t s101_idx = (0);
static size_t s102_idx = (0);
static size_t s103_idx = (0);
static size_t s104_idx = (0);
static size_t s105_idx = (0);
static size_t s106_idx = (0);
static size_t s107_idx = (0);
static size_t s108_idx = (0);
static size_t s109_idx = (0);
static size_t s110_idx = (0);
static size_t s111_idx = (0);
static size_t s112_idx = (0);
static size_t s113_idx = (0);
static size_t s114_idx = (0);
static size_t s115_idx = (0);
static size_t s116_idx = (0);
static size_t s117_idx = (0);
static size_t s118_idx = (0);
static size_t s119_idx = (0);
static size_t s120_idx = (0);
static size_t s121_idx = (0);
static size_t s122_idx = (0);
static size_t s123_idx = (0);
static size_t s124_idx = (0);
static size_t s125_idx = (0);
static size_t s126_idx = (0);
static size_t s127_idx = (0);
static size_t s128_idx = (0);
static size_t s129_idx = (0);
static size_t s130_idx = (0);
static size_t s131_idx = (0);
static size_t s132_idx = (0);
static size_t s133_idx = (0);
static size_t s134_idx = (0);
static size_t s135_idx = (0);
static size_t s136_idx = (0);
static size_t s137_idx = (0);
static size_t s138_idx = (0);
static size_t s139_idx = (0);
static size_t s140_idx = (0);
static size_t s141_idx = (0);
static size_t s142_idx = (0);
static size_t s143_idx = (0);
static size_t s144_idx = (0);
static size_t s145_idx = (0);
static size_t s146_idx = (0);
static size_t s147_idx = (0);
static size_t s148_idx = (0);
static size_t s149_idx = (0);
static size_t s150_idx = (0);
static size_t s151_idx = (0);
static size_t s152_idx = (0);
static size_t s153_idx = (0);
static size_t s154_idx = (0);
static size_t s155_idx = (0);
static size_t s156_idx = (0);
static size_t s157_idx = (0);
static size_t s158_idx = (0);
static size_t s159_idx = (0);
static size_t s160_idx = (0);
static size_t s161_idx = (0);
static size_t s162_idx = (0);
static size_t s163_idx = (0);
static size_t s164_idx = (0);
static size_t s165_idx = (0);
static size_t s166_idx = (0);
static size_t s167_idx = (0);
static size_t s168_idx = (0);
static size_t s169_idx = (0);
static size_t s170_idx = (0);
static size_t s171_idx = (0);
static size_t s172_idx = (0);
static size_t s173_idx = (0);
static size_t s174_idx = (0);
static size_t s175_idx = (0);
static size_t s176_idx = (0);
static size_t s177_idx = (0);
static size_t s178_idx = (0);
static size_t s179_idx = (0);
static size_t s180_idx = (0);
static size_t s181_idx = (0);
static size_t s182_idx = (0);
static size_t s183_idx = (0);
static size_t s184_idx = (0);
static size_t s185_idx = (0);
static size_t s186_idx = (0);
static size_t s187_idx = (0);
static size_t s188_idx = (0);
static size_t s189_idx = (0);
static size_t s190_idx = (0);
static size_t s191_idx = (0);
static size_t s192_idx = (0);
static size_t s193_idx = (0);
static size_t s194_idx = (0);
static size_t s195_idx = (0);
static size_t s196_idx = (0);
static size_t s197_idx = (0);
static size_t s198_idx = (0);
static size_t s199_idx = (0);
static size_t s200_idx = (0);
static size_t s201_idx = (0);

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

int64_t s41_get(size_t x) {
  return (s41)[((s41_idx) + (x)) % (1)];
}

bool s42_get(size_t x) {
  return (s42)[((s42_idx) + (x)) % (1)];
}

int64_t s43_get(size_t x) {
  return (s43)[((s43_idx) + (x)) % (1)];
}

bool s44_get(size_t x) {
  return (s44)[((s44_idx) + (x)) % (1)];
}

int64_t s45_get(size_t x) {
  return (s45)[((s45_idx) + (x)) % (1)];
}

bool s46_get(size_t x) {
  return (s46)[((s46_idx) + (x)) % (1)];
}

int64_t s47_get(size_t x) {
  return (s47)[((s47_idx) + (x)) % (1)];
}

bool s48_get(size_t x) {
  return (s48)[((s48_idx) + (x)) % (1)];
}

int64_t s49_get(size_t x) {
  return (s49)[((s49_idx) + (x)) % (1)];
}

bool s50_get(size_t x) {
  return (s50)[((s50_idx) + (x)) % (1)];
}

int64_t s51_get(size_t x) {
  return (s51)[((s51_idx) + (x)) % (1)];
}

bool s52_get(size_t x) {
  return (s52)[((s52_idx) + (x)) % (1)];
}

int64_t s53_get(size_t x) {
  return (s53)[((s53_idx) + (x)) % (1)];
}

bool s54_get(size_t x) {
  return (s54)[((s54_idx) + (x)) % (1)];
}

int64_t s55_get(size_t x) {
  return (s55)[((s55_idx) + (x)) % (1)];
}

bool s56_get(size_t x) {
  return (s56)[((s56_idx) + (x)) % (1)];
}

int64_t s57_get(size_t x) {
  return (s57)[((s57_idx) + (x)) % (1)];
}

bool s58_get(size_t x) {
  return (s58)[((s58_idx) + (x)) % (1)];
}

int64_t s59_get(size_t x) {
  return (s59)[((s59_idx) + (x)) % (1)];
}

bool s60_get(size_t x) {
  return (s60)[((s60_idx) + (x)) % (1)];
}

int64_t s61_get(size_t x) {
  return (s61)[((s61_idx) + (x)) % (1)];
}

bool s62_get(size_t x) {
  return (s62)[((s62_idx) + (x)) % (1)];
}

int64_t s63_get(size_t x) {
  return (s63)[((s63_idx) + (x)) % (1)];
}

bool s64_get(size_t x) {
  return (s64)[((s64_idx) + (x)) % (1)];
}

int64_t s65_get(size_t x) {
  return (s65)[((s65_idx) + (x)) % (1)];
}

bool s66_get(size_t x) {
  return (s66)[((s66_idx) + (x)) % (1)];
}

int64_t s67_get(size_t x) {
  return (s67)[((s67_idx) + (x)) % (1)];
}

bool s68_get(size_t x) {
  return (s68)[((s68_idx) + (x)) % (1)];
}

int64_t s69_get(size_t x) {
  return (s69)[((s69_idx) + (x)) % (1)];
}

bool s70_get(size_t x) {
  return (s70)[((s70_idx) + (x)) % (1)];
}

int64_t s71_get(size_t x) {
  return (s71)[((s71_idx) + (x)) % (1)];
}

bool s72_get(size_t x) {
  return (s72)[((s72_idx) + (x)) % (1)];
}

int64_t s73_get(size_t x) {
  return (s73)[((s73_idx) + (x)) % (1)];
}

bool s74_get(size_t x) {
  return (s74)[((s74_idx) + (x)) % (1)];
}

int64_t s75_get(size_t x) {
  return (s75)[((s75_idx) + (x)) % (1)];
}

bool s76_get(size_t x) {
  return (s76)[((s76_idx) + (x)) % (1)];
}

int64_t s77_get(size_t x) {
  return (s77)[((s77_idx) + (x)) % (1)];
}

bool s78_get(size_t x) {
  return (s78)[((s78_idx) + (x)) % (1)];
}

int64_t s79_get(size_t x) {
  return (s79)[((s79_idx) + (x)) % (1)];
}

bool s80_get(size_t x) {
  return (s80)[((s80_idx) + (x)) % (1)];
}

int64_t s81_get(size_t x) {
  return (s81)[((s81_idx) + (x)) % (1)];
}

bool s82_get(size_t x) {
  return (s82)[((s82_idx) + (x)) % (1)];
}

int64_t s83_get(size_t x) {
  return (s83)[((s83_idx) + (x)) % (1)];
}

bool s84_get(size_t x) {
  return (s84)[((s84_idx) + (x)) % (1)];
}

int64_t s85_get(size_t x) {
  return (s85)[((s85_idx) + (x)) % (1)];
}

bool s86_get(size_t x) {
  return (s86)[((s86_idx) + (x)) % (1)];
}

int64_t s87_get(size_t x) {
  return (s87)[((s87_idx) + (x)) % (1)];
}

bool s88_get(size_t x) {
  return (s88)[((s88_idx) + (x)) % (1)];
}

int64_t s89_get(size_t x) {
  return (s89)[((s89_idx) + (x)) % (1)];
}

bool s90_get(size_t x) {
  return (s90)[((s90_idx) + (x)) % (1)];
}

int64_t s91_get(size_t x) {
  return (s91)[((s91_idx) + (x)) % (1)];
}

bool s92_get(size_t x) {
  return (s92)[((s92_idx) + (x)) % (1)];
}

int64_t s93_get(size_t x) {
  return (s93)[((s93_idx) + (x)) % (1)];
}

bool s94_get(size_t x) {
  return (s94)[((s94_idx) + (x)) % (1)];
}

int64_t s95_get(size_t x) {
  return (s95)[((s95_idx) + (x)) % (1)];
}

bool s96_get(size_t x) {
  return (s96)[((s96_idx) + (x)) % (1)];
}

int64_t s97_get(size_t x) {
  return (s97)[((s97_idx) + (x)) % (1)];
}

bool s98_get(size_t x) {
  return (s98)[((s98_idx) + (x)) % (1)];
}

int64_t s99_get(size_t x) {
  return (s99)[((s99_idx) + (x)) % (1)];
}

bool s100_get(size_t x) {
  return (s100)[((s100_idx) + (x)) % (1)];
}

int64_t s101_get(size_t x) {
  return (s101)[((s101_idx) + (x)) % (1)];
}

bool s102_get(size_t x) {
  return (s102)[((s102_idx) + (x)) % (1)];
}

int64_t s103_get(size_t x) {
  return (s103)[((s103_idx) + (x)) % (1)];
}

bool s104_get(size_t x) {
  return (s104)[((s104_idx) + (x)) % (1)];
}

int64_t s105_get(size_t x) {
  return (s105)[((s105_idx) + (x)) % (1)];
}

bool s106_get(size_t x) {
  return (s106)[((s106_idx) + (x)) % (1)];
}

int64_t s107_get(size_t x) {
  return (s107)[((s107_idx) + (x)) % (1)];
}

bool s108_get(size_t x) {
  return (s108)[((s108_idx) + (x)) % (1)];
}

int64_t s109_get(size_t x) {
  return (s109)[((s109_idx) + (x)) % (1)];
}

bool s110_get(size_t x) {
  return (s110)[((s110_idx) + (x)) % (1)];
}

int64_t s111_get(size_t x) {
  return (s111)[((s111_idx) + (x)) % (1)];
}

bool s112_get(size_t x) {
  return (s112)[((s112_idx) + (x)) % (1)];
}

int64_t s113_get(size_t x) {
  return (s113)[((s113_idx) + (x)) % (1)];
}

bool s114_get(size_t x) {
  return (s114)[((s114_idx) + (x)) % (1)];
}

int64_t s115_get(size_t x) {
  return (s115)[((s115_idx) + (x)) % (1)];
}

bool s116_get(size_t x) {
  return (s116)[((s116_idx) + (x)) % (1)];
}

int64_t s117_get(size_t x) {
  return (s117)[((s117_idx) + (x)) % (1)];
}

bool s118_get(size_t x) {
  return (s118)[((s118_idx) + (x)) % (1)];
}

int64_t s119_get(size_t x) {
  return (s119)[((s119_idx) + (x)) % (1)];
}

bool s120_get(size_t x) {
  return (s120)[((s120_idx) + (x)) % (1)];
}

int64_t s121_get(size_t x) {
  return (s121)[((s121_idx) + (x)) % (1)];
}

bool s122_get(size_t x) {
  return (s122)[((s122_idx) + (x)) % (1)];
}

int64_t s123_get(size_t x) {
  return (s123)[((s123_idx) + (x)) % (1)];
}

bool s124_get(size_t x) {
  return (s124)[((s124_idx) + (x)) % (1)];
}

int64_t s125_get(size_t x) {
  return (s125)[((s125_idx) + (x)) % (1)];
}

bool s126_get(size_t x) {
  return (s126)[((s126_idx) + (x)) % (1)];
}

int64_t s127_get(size_t x) {
  return (s127)[((s127_idx) + (x)) % (1)];
}

bool s128_get(size_t x) {
  return (s128)[((s128_idx) + (x)) % (1)];
}

int64_t s129_get(size_t x) {
  return (s129)[((s129_idx) + (x)) % (1)];
}

bool s130_get(size_t x) {
  return (s130)[((s130_idx) + (x)) % (1)];
}

int64_t s131_get(size_t x) {
  return (s131)[((s131_idx) + (x)) % (1)];
}

bool s132_get(size_t x) {
  return (s132)[((s132_idx) + (x)) % (1)];
}

int64_t s133_get(size_t x) {
  return (s133)[((s133_idx) + (x)) % (1)];
}

bool s134_get(size_t x) {
  return (s134)[((s134_idx) + (x)) % (1)];
}

int64_t s135_get(size_t x) {
  return (s135)[((s135_idx) + (x)) % (1)];
}

bool s136_get(size_t x) {
  return (s136)[((s136_idx) + (x)) % (1)];
}

int64_t s137_get(size_t x) {
  return (s137)[((s137_idx) + (x)) % (1)];
}

bool s138_get(size_t x) {
  return (s138)[((s138_idx) + (x)) % (1)];
}

int64_t s139_get(size_t x) {
  return (s139)[((s139_idx) + (x)) % (1)];
}

bool s140_get(size_t x) {
  return (s140)[((s140_idx) + (x)) % (1)];
}

int64_t s141_get(size_t x) {
  return (s141)[((s141_idx) + (x)) % (1)];
}

bool s142_get(size_t x) {
  return (s142)[((s142_idx) + (x)) % (1)];
}

int64_t s143_get(size_t x) {
  return (s143)[((s143_idx) + (x)) % (1)];
}

bool s144_get(size_t x) {
  return (s144)[((s144_idx) + (x)) % (1)];
}

int64_t s145_get(size_t x) {
  return (s145)[((s145_idx) + (x)) % (1)];
}

bool s146_get(size_t x) {
  return (s146)[((s146_idx) + (x)) % (1)];
}

int64_t s147_get(size_t x) {
  return (s147)[((s147_idx) + (x)) % (1)];
}

bool s148_get(size_t x) {
  return (s148)[((s148_idx) + (x)) % (1)];
}

int64_t s149_get(size_t x) {
  return (s149)[((s149_idx) + (x)) % (1)];
}

bool s150_get(size_t x) {
  return (s150)[((s150_idx) + (x)) % (1)];
}

int64_t s151_get(size_t x) {
  return (s151)[((s151_idx) + (x)) % (1)];
}

bool s152_get(size_t x) {
  return (s152)[((s152_idx) + (x)) % (1)];
}

int64_t s153_get(size_t x) {
  return (s153)[((s153_idx) + (x)) % (1)];
}

bool s154_get(size_t x) {
  return (s154)[((s154_idx) + (x)) % (1)];
}

int64_t s155_get(size_t x) {
  return (s155)[((s155_idx) + (x)) % (1)];
}

bool s156_get(size_t x) {
  return (s156)[((s156_idx) + (x)) % (1)];
}

int64_t s157_get(size_t x) {
  return (s157)[((s157_idx) + (x)) % (1)];
}

bool s158_get(size_t x) {
  return (s158)[((s158_idx) + (x)) % (1)];
}

int64_t s159_get(size_t x) {
  return (s159)[((s159_idx) + (x)) % (1)];
}

bool s160_get(size_t x) {
  return (s160)[((s160_idx) + (x)) % (1)];
}

int64_t s161_get(size_t x) {
  return (s161)[((s161_idx) + (x)) % (1)];
}

bool s162_get(size_t x) {
  return (s162)[((s162_idx) + (x)) % (1)];
}

int64_t s163_get(size_t x) {
  return (s163)[((s163_idx) + (x)) % (1)];
}

bool s164_get(size_t x) {
  return (s164)[((s164_idx) + (x)) % (1)];
}

int64_t s165_get(size_t x) {
  return (s165)[((s165_idx) + (x)) % (1)];
}

bool s166_get(size_t x) {
  return (s166)[((s166_idx) + (x)) % (1)];
}

int64_t s167_get(size_t x) {
  return (s167)[((s167_idx) + (x)) % (1)];
}

bool s168_get(size_t x) {
  return (s168)[((s168_idx) + (x)) % (1)];
}

int64_t s169_get(size_t x) {
  return (s169)[((s169_idx) + (x)) % (1)];
}

bool s170_get(size_t x) {
  return (s170)[((s170_idx) + (x)) % (1)];
}

int64_t s171_get(size_t x) {
  return (s171)[((s171_idx) + (x)) % (1)];
}

bool s172_get(size_t x) {
  return (s172)[((s172_idx) + (x)) % (1)];
}

int64_t s173_get(size_t x) {
  return (s173)[((s173_idx) + (x)) % (1)];
}

bool s174_get(size_t x) {
  return (s174)[((s174_idx) + (x)) % (1)];
}

int64_t s175_get(size_t x) {
  return (s175)[((s175_idx) + (x)) % (1)];
}

bool s176_get(size_t x) {
  return (s176)[((s176_idx) + (x)) % (1)];
}

int64_t s177_get(size_t x) {
  return (s177)[((s177_idx) + (x)) % (1)];
}

bool s178_get(size_t x) {
  return (s178)[((s178_idx) + (x)) % (1)];
}

int64_t s179_get(size_t x) {
  return (s179)[((s179_idx) + (x)) % (1)];
}

bool s180_get(size_t x) {
  return (s180)[((s180_idx) + (x)) % (1)];
}

int64_t s181_get(size_t x) {
  return (s181)[((s181_idx) + (x)) % (1)];
}

bool s182_get(size_t x) {
  return (s182)[((s182_idx) + (x)) % (1)];
}

int64_t s183_get(size_t x) {
  return (s183)[((s183_idx) + (x)) % (1)];
}

bool s184_get(size_t x) {
  return (s184)[((s184_idx) + (x)) % (1)];
}

int64_t s185_get(size_t x) {
  return (s185)[((s185_idx) + (x)) % (1)];
}

bool s186_get(size_t x) {
  return (s186)[((s186_idx) + (x)) % (1)];
}

int64_t s187_get(size_t x) {
  return (s187)[((s187_idx) + (x)) % (1)];
}

bool s188_get(size_t x) {
  return (s188)[((s188_idx) + (x)) % (1)];
}

int64_t s189_get(size_t x) {
  return (s189)[((s189_idx) + (x)) % (1)];
}

bool s190_get(size_t x) {
  return (s190)[((s190_idx) + (x)) % (1)];
}

int64_t s191_get(size_t x) {
  return (s191)[((s191_idx) + (x)) % (1)];
}

bool s192_get(size_t x) {
  return (s192)[((s192_idx) + (x)) % (1)];
}

int64_t s193_get(size_t x) {
  return (s193)[((s193_idx) + (x)) % (1)];
}

bool s194_get(size_t x) {
  return (s194)[((s194_idx) + (x)) % (1)];
}

int64_t s195_get(size_t x) {
  return (s195)[((s195_idx) + (x)) % (1)];
}

bool s196_get(size_t x) {
  return (s196)[((s196_idx) + (x)) % (1)];
}

int64_t s197_get(size_t x) {
  return (s197)[((s197_idx) + (x)) % (1)];
}

bool s198_get(size_t x) {
  return (s198)[((s198_idx) + (x)) % (1)];
}

int64_t s199_get(size_t x) {
  return (s199)[((s199_idx) + (x)) % (1)];
}

bool s200_get(size_t x) {
  return (s200)[((s200_idx) + (x)) % (1)];
}

bool s201_get(size_t x) {
  return (s201)[((s201_idx) + (x)) % (1)];
}

int64_t s0_gen(void) {
  return ((s0_get)((0))) + ((int64_t)(1));
}

int64_t s1_gen(void) {
  return (s0_get)((0));
}

bool s2_gen(void) {
  return b_cpy;
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
  return (s19_get)((0));
}

bool s22_gen(void) {
  return (s20_get)((0));
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

int64_t s41_gen(void) {
  return (s39_get)((0));
}

bool s42_gen(void) {
  return (s40_get)((0));
}

int64_t s43_gen(void) {
  return (s41_get)((0));
}

bool s44_gen(void) {
  return (s42_get)((0));
}

int64_t s45_gen(void) {
  return (s43_get)((0));
}

bool s46_gen(void) {
  return (s44_get)((0));
}

int64_t s47_gen(void) {
  return (s45_get)((0));
}

bool s48_gen(void) {
  return (s46_get)((0));
}

int64_t s49_gen(void) {
  return (s47_get)((0));
}

bool s50_gen(void) {
  return (s48_get)((0));
}

int64_t s51_gen(void) {
  return (s49_get)((0));
}

bool s52_gen(void) {
  return (s50_get)((0));
}

int64_t s53_gen(void) {
  return (s51_get)((0));
}

bool s54_gen(void) {
  return (s52_get)((0));
}

int64_t s55_gen(void) {
  return (s53_get)((0));
}

bool s56_gen(void) {
  return (s54_get)((0));
}

int64_t s57_gen(void) {
  return (s55_get)((0));
}

bool s58_gen(void) {
  return (s56_get)((0));
}

int64_t s59_gen(void) {
  return (s57_get)((0));
}

bool s60_gen(void) {
  return (s58_get)((0));
}

int64_t s61_gen(void) {
  return (s59_get)((0));
}

bool s62_gen(void) {
  return (s60_get)((0));
}

int64_t s63_gen(void) {
  return (s61_get)((0));
}

bool s64_gen(void) {
  return (s62_get)((0));
}

int64_t s65_gen(void) {
  return (s63_get)((0));
}

bool s66_gen(void) {
  return (s64_get)((0));
}

int64_t s67_gen(void) {
  return (s65_get)((0));
}

bool s68_gen(void) {
  return (s66_get)((0));
}

int64_t s69_gen(void) {
  return (s67_get)((0));
}

bool s70_gen(void) {
  return (s68_get)((0));
}

int64_t s71_gen(void) {
  return (s69_get)((0));
}

bool s72_gen(void) {
  return (s70_get)((0));
}

int64_t s73_gen(void) {
  return (s71_get)((0));
}

bool s74_gen(void) {
  return (s72_get)((0));
}

int64_t s75_gen(void) {
  return (s73_get)((0));
}

bool s76_gen(void) {
  return (s74_get)((0));
}

int64_t s77_gen(void) {
  return (s75_get)((0));
}

bool s78_gen(void) {
  return (s76_get)((0));
}

int64_t s79_gen(void) {
  return (s77_get)((0));
}

bool s80_gen(void) {
  return (s78_get)((0));
}

int64_t s81_gen(void) {
  return (s79_get)((0));
}

bool s82_gen(void) {
  return (s80_get)((0));
}

int64_t s83_gen(void) {
  return (s81_get)((0));
}

bool s84_gen(void) {
  return (s82_get)((0));
}

int64_t s85_gen(void) {
  return (s83_get)((0));
}

bool s86_gen(void) {
  return (s84_get)((0));
}

int64_t s87_gen(void) {
  return (s85_get)((0));
}

bool s88_gen(void) {
  return (s86_get)((0));
}

int64_t s89_gen(void) {
  return (s87_get)((0));
}

bool s90_gen(void) {
  return (s88_get)((0));
}

int64_t s91_gen(void) {
  return (s89_get)((0));
}

bool s92_gen(void) {
  return (s90_get)((0));
}

int64_t s93_gen(void) {
  return (s91_get)((0));
}

bool s94_gen(void) {
  return (s92_get)((0));
}

int64_t s95_gen(void) {
  return (s93_get)((0));
}

bool s96_gen(void) {
  return (s94_get)((0));
}

int64_t s97_gen(void) {
  return (s95_get)((0));
}

bool s98_gen(void) {
  return (s96_get)((0));
}

int64_t s99_gen(void) {
  return (s97_get)((0));
}

bool s100_gen(void) {
  return (s98_get)((0));
}

int64_t s101_gen(void) {
  return (s99_get)((0));
}

bool s102_gen(void) {
  return (s100_get)((0));
}

int64_t s103_gen(void) {
  return (s101_get)((0));
}

bool s104_gen(void) {
  return (s102_get)((0));
}

int64_t s105_gen(void) {
  return (s103_get)((0));
}

bool s106_gen(void) {
  return (s104_get)((0));
}

int64_t s107_gen(void) {
  return (s105_get)((0));
}

bool s108_gen(void) {
  return (s106_get)((0));
}

int64_t s109_gen(void) {
  return (s107_get)((0));
}

bool s110_gen(void) {
  return (s108_get)((0));
}

int64_t s111_gen(void) {
  return (s109_get)((0));
}

bool s112_gen(void) {
  return (s110_get)((0));
}

int64_t s113_gen(void) {
  return (s111_get)((0));
}

bool s114_gen(void) {
  return (s112_get)((0));
}

int64_t s115_gen(void) {
  return (s113_get)((0));
}

bool s116_gen(void) {
  return (s114_get)((0));
}

int64_t s117_gen(void) {
  return (s115_get)((0));
}

bool s118_gen(void) {
  return (s116_get)((0));
}

int64_t s119_gen(void) {
  return (s117_get)((0));
}

bool s120_gen(void) {
  return (s118_get)((0));
}

int64_t s121_gen(void) {
  return (s119_get)((0));
}

bool s122_gen(void) {
  return (s120_get)((0));
}

int64_t s123_gen(void) {
  return (s121_get)((0));
}

bool s124_gen(void) {
  return (s122_get)((0));
}

int64_t s125_gen(void) {
  return (s123_get)((0));
}

bool s126_gen(void) {
  return (s124_get)((0));
}

int64_t s127_gen(void) {
  return (s125_get)((0));
}

bool s128_gen(void) {
  return (s126_get)((0));
}

int64_t s129_gen(void) {
  return (s127_get)((0));
}

bool s130_gen(void) {
  return (s128_get)((0));
}

int64_t s131_gen(void) {
  return (s129_get)((0));
}

bool s132_gen(void) {
  return (s130_get)((0));
}

int64_t s133_gen(void) {
  return (s131_get)((0));
}

bool s134_gen(void) {
  return (s132_get)((0));
}

int64_t s135_gen(void) {
  return (s133_get)((0));
}

bool s136_gen(void) {
  return (s134_get)((0));
}

int64_t s137_gen(void) {
  return (s135_get)((0));
}

bool s138_gen(void) {
  return (s136_get)((0));
}

int64_t s139_gen(void) {
  return (s137_get)((0));
}

bool s140_gen(void) {
  return (s138_get)((0));
}

int64_t s141_gen(void) {
  return (s139_get)((0));
}

bool s142_gen(void) {
  return (s140_get)((0));
}

int64_t s143_gen(void) {
  return (s141_get)((0));
}

bool s144_gen(void) {
  return (s142_get)((0));
}

int64_t s145_gen(void) {
  return (s143_get)((0));
}

bool s146_gen(void) {
  return (s144_get)((0));
}

int64_t s147_gen(void) {
  return (s145_get)((0));
}

bool s148_gen(void) {
  return (s146_get)((0));
}

int64_t s149_gen(void) {
  return (s147_get)((0));
}

bool s150_gen(void) {
  return (s148_get)((0));
}

int64_t s151_gen(void) {
  return (s149_get)((0));
}

bool s152_gen(void) {
  return (s150_get)((0));
}

int64_t s153_gen(void) {
  return (s151_get)((0));
}

bool s154_gen(void) {
  return (s152_get)((0));
}

int64_t s155_gen(void) {
  return (s153_get)((0));
}

bool s156_gen(void) {
  return (s154_get)((0));
}

int64_t s157_gen(void) {
  return (s155_get)((0));
}

bool s158_gen(void) {
  return (s156_get)((0));
}

int64_t s159_gen(void) {
  return (s157_get)((0));
}

bool s160_gen(void) {
  return (s158_get)((0));
}

int64_t s161_gen(void) {
  return (s159_get)((0));
}

bool s162_gen(void) {
  return (s160_get)((0));
}

int64_t s163_gen(void) {
  return (s161_get)((0));
}

bool s164_gen(void) {
  return (s162_get)((0));
}

int64_t s165_gen(void) {
  return (s163_get)((0));
}

bool s166_gen(void) {
  return (s164_get)((0));
}

int64_t s167_gen(void) {
  return (s165_get)((0));
}

bool s168_gen(void) {
  return (s166_get)((0));
}

int64_t s169_gen(void) {
  return (s167_get)((0));
}

bool s170_gen(void) {
  return (s168_get)((0));
}

int64_t s171_gen(void) {
  return (s169_get)((0));
}

bool s172_gen(void) {
  return (s170_get)((0));
}

int64_t s173_gen(void) {
  return (s171_get)((0));
}

bool s174_gen(void) {
  return (s172_get)((0));
}

int64_t s175_gen(void) {
  return (s173_get)((0));
}

bool s176_gen(void) {
  return (s174_get)((0));
}

int64_t s177_gen(void) {
  return (s175_get)((0));
}

bool s178_gen(void) {
  return (s176_get)((0));
}

int64_t s179_gen(void) {
  return (s177_get)((0));
}

bool s180_gen(void) {
  return (s178_get)((0));
}

int64_t s181_gen(void) {
  return (s179_get)((0));
}

bool s182_gen(void) {
  return (s180_get)((0));
}

int64_t s183_gen(void) {
  return (s181_get)((0));
}

bool s184_gen(void) {
  return (s182_get)((0));
}

int64_t s185_gen(void) {
  return (s183_get)((0));
}

bool s186_gen(void) {
  return (s184_get)((0));
}

int64_t s187_gen(void) {
  return (s185_get)((0));
}

bool s188_gen(void) {
  return (s186_get)((0));
}

int64_t s189_gen(void) {
  return (s187_get)((0));
}

bool s190_gen(void) {
  return (s188_get)((0));
}

int64_t s191_gen(void) {
  return (s189_get)((0));
}

bool s192_gen(void) {
  return (s190_get)((0));
}

int64_t s193_gen(void) {
  return (s191_get)((0));
}

bool s194_gen(void) {
  return (s192_get)((0));
}

int64_t s195_gen(void) {
  return (s193_get)((0));
}

bool s196_gen(void) {
  return (s194_get)((0));
}

int64_t s197_gen(void) {
  return (s195_get)((0));
}

bool s198_gen(void) {
  return (s196_get)((0));
}

int64_t s199_gen(void) {
  return (s197_get)((0));
}

bool s200_gen(void) {
  return (s198_get)((0));
}

bool s201_gen(void) {
  return ((!(a_cpy)) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s0_get)((0)))) && (((((s0_get)((0))) <= ((s0_get)((0)))) && (b_cpy)) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s1_get)((0)))) && (((((s1_get)((0))) <= ((s0_get)((0)))) && ((s2_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s3_get)((0)))) && (((((s3_get)((0))) <= ((s0_get)((0)))) && ((s4_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s5_get)((0)))) && (((((s5_get)((0))) <= ((s0_get)((0)))) && ((s6_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s7_get)((0)))) && (((((s7_get)((0))) <= ((s0_get)((0)))) && ((s8_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s9_get)((0)))) && (((((s9_get)((0))) <= ((s0_get)((0)))) && ((s10_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s11_get)((0)))) && (((((s11_get)((0))) <= ((s0_get)((0)))) && ((s12_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s13_get)((0)))) && (((((s13_get)((0))) <= ((s0_get)((0)))) && ((s14_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s15_get)((0)))) && (((((s15_get)((0))) <= ((s0_get)((0)))) && ((s16_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s17_get)((0)))) && (((((s17_get)((0))) <= ((s0_get)((0)))) && ((s18_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s19_get)((0)))) && (((((s19_get)((0))) <= ((s0_get)((0)))) && ((s20_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s21_get)((0)))) && (((((s21_get)((0))) <= ((s0_get)((0)))) && ((s22_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s23_get)((0)))) && (((((s23_get)((0))) <= ((s0_get)((0)))) && ((s24_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s25_get)((0)))) && (((((s25_get)((0))) <= ((s0_get)((0)))) && ((s26_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s27_get)((0)))) && (((((s27_get)((0))) <= ((s0_get)((0)))) && ((s28_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s29_get)((0)))) && (((((s29_get)((0))) <= ((s0_get)((0)))) && ((s30_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s31_get)((0)))) && (((((s31_get)((0))) <= ((s0_get)((0)))) && ((s32_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s33_get)((0)))) && (((((s33_get)((0))) <= ((s0_get)((0)))) && ((s34_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s35_get)((0)))) && (((((s35_get)((0))) <= ((s0_get)((0)))) && ((s36_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s37_get)((0)))) && (((((s37_get)((0))) <= ((s0_get)((0)))) && ((s38_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s39_get)((0)))) && (((((s39_get)((0))) <= ((s0_get)((0)))) && ((s40_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s41_get)((0)))) && (((((s41_get)((0))) <= ((s0_get)((0)))) && ((s42_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s43_get)((0)))) && (((((s43_get)((0))) <= ((s0_get)((0)))) && ((s44_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s45_get)((0)))) && (((((s45_get)((0))) <= ((s0_get)((0)))) && ((s46_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s47_get)((0)))) && (((((s47_get)((0))) <= ((s0_get)((0)))) && ((s48_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s49_get)((0)))) && (((((s49_get)((0))) <= ((s0_get)((0)))) && ((s50_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s51_get)((0)))) && (((((s51_get)((0))) <= ((s0_get)((0)))) && ((s52_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s53_get)((0)))) && (((((s53_get)((0))) <= ((s0_get)((0)))) && ((s54_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s55_get)((0)))) && (((((s55_get)((0))) <= ((s0_get)((0)))) && ((s56_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s57_get)((0)))) && (((((s57_get)((0))) <= ((s0_get)((0)))) && ((s58_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s59_get)((0)))) && (((((s59_get)((0))) <= ((s0_get)((0)))) && ((s60_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s61_get)((0)))) && (((((s61_get)((0))) <= ((s0_get)((0)))) && ((s62_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s63_get)((0)))) && (((((s63_get)((0))) <= ((s0_get)((0)))) && ((s64_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s65_get)((0)))) && (((((s65_get)((0))) <= ((s0_get)((0)))) && ((s66_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s67_get)((0)))) && (((((s67_get)((0))) <= ((s0_get)((0)))) && ((s68_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s69_get)((0)))) && (((((s69_get)((0))) <= ((s0_get)((0)))) && ((s70_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s71_get)((0)))) && (((((s71_get)((0))) <= ((s0_get)((0)))) && ((s72_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s73_get)((0)))) && (((((s73_get)((0))) <= ((s0_get)((0)))) && ((s74_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s75_get)((0)))) && (((((s75_get)((0))) <= ((s0_get)((0)))) && ((s76_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s77_get)((0)))) && (((((s77_get)((0))) <= ((s0_get)((0)))) && ((s78_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s79_get)((0)))) && (((((s79_get)((0))) <= ((s0_get)((0)))) && ((s80_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s81_get)((0)))) && (((((s81_get)((0))) <= ((s0_get)((0)))) && ((s82_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s83_get)((0)))) && (((((s83_get)((0))) <= ((s0_get)((0)))) && ((s84_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s85_get)((0)))) && (((((s85_get)((0))) <= ((s0_get)((0)))) && ((s86_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s87_get)((0)))) && (((((s87_get)((0))) <= ((s0_get)((0)))) && ((s88_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s89_get)((0)))) && (((((s89_get)((0))) <= ((s0_get)((0)))) && ((s90_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s91_get)((0)))) && (((((s91_get)((0))) <= ((s0_get)((0)))) && ((s92_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s93_get)((0)))) && (((((s93_get)((0))) <= ((s0_get)((0)))) && ((s94_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s95_get)((0)))) && (((((s95_get)((0))) <= ((s0_get)((0)))) && ((s96_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s97_get)((0)))) && (((((s97_get)((0))) <= ((s0_get)((0)))) && ((s98_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s99_get)((0)))) && (((((s99_get)((0))) <= ((s0_get)((0)))) && ((s100_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s101_get)((0)))) && (((((s101_get)((0))) <= ((s0_get)((0)))) && ((s102_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s103_get)((0)))) && (((((s103_get)((0))) <= ((s0_get)((0)))) && ((s104_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s105_get)((0)))) && (((((s105_get)((0))) <= ((s0_get)((0)))) && ((s106_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s107_get)((0)))) && (((((s107_get)((0))) <= ((s0_get)((0)))) && ((s108_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s109_get)((0)))) && (((((s109_get)((0))) <= ((s0_get)((0)))) && ((s110_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s111_get)((0)))) && (((((s111_get)((0))) <= ((s0_get)((0)))) && ((s112_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s113_get)((0)))) && (((((s113_get)((0))) <= ((s0_get)((0)))) && ((s114_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s115_get)((0)))) && (((((s115_get)((0))) <= ((s0_get)((0)))) && ((s116_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s117_get)((0)))) && (((((s117_get)((0))) <= ((s0_get)((0)))) && ((s118_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s119_get)((0)))) && (((((s119_get)((0))) <= ((s0_get)((0)))) && ((s120_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s121_get)((0)))) && (((((s121_get)((0))) <= ((s0_get)((0)))) && ((s122_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s123_get)((0)))) && (((((s123_get)((0))) <= ((s0_get)((0)))) && ((s124_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s125_get)((0)))) && (((((s125_get)((0))) <= ((s0_get)((0)))) && ((s126_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s127_get)((0)))) && (((((s127_get)((0))) <= ((s0_get)((0)))) && ((s128_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s129_get)((0)))) && (((((s129_get)((0))) <= ((s0_get)((0)))) && ((s130_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s131_get)((0)))) && (((((s131_get)((0))) <= ((s0_get)((0)))) && ((s132_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s133_get)((0)))) && (((((s133_get)((0))) <= ((s0_get)((0)))) && ((s134_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s135_get)((0)))) && (((((s135_get)((0))) <= ((s0_get)((0)))) && ((s136_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s137_get)((0)))) && (((((s137_get)((0))) <= ((s0_get)((0)))) && ((s138_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s139_get)((0)))) && (((((s139_get)((0))) <= ((s0_get)((0)))) && ((s140_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s141_get)((0)))) && (((((s141_get)((0))) <= ((s0_get)((0)))) && ((s142_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s143_get)((0)))) && (((((s143_get)((0))) <= ((s0_get)((0)))) && ((s144_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s145_get)((0)))) && (((((s145_get)((0))) <= ((s0_get)((0)))) && ((s146_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s147_get)((0)))) && (((((s147_get)((0))) <= ((s0_get)((0)))) && ((s148_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s149_get)((0)))) && (((((s149_get)((0))) <= ((s0_get)((0)))) && ((s150_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s151_get)((0)))) && (((((s151_get)((0))) <= ((s0_get)((0)))) && ((s152_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s153_get)((0)))) && (((((s153_get)((0))) <= ((s0_get)((0)))) && ((s154_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s155_get)((0)))) && (((((s155_get)((0))) <= ((s0_get)((0)))) && ((s156_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s157_get)((0)))) && (((((s157_get)((0))) <= ((s0_get)((0)))) && ((s158_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s159_get)((0)))) && (((((s159_get)((0))) <= ((s0_get)((0)))) && ((s160_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s161_get)((0)))) && (((((s161_get)((0))) <= ((s0_get)((0)))) && ((s162_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s163_get)((0)))) && (((((s163_get)((0))) <= ((s0_get)((0)))) && ((s164_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s165_get)((0)))) && (((((s165_get)((0))) <= ((s0_get)((0)))) && ((s166_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s167_get)((0)))) && (((((s167_get)((0))) <= ((s0_get)((0)))) && ((s168_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s169_get)((0)))) && (((((s169_get)((0))) <= ((s0_get)((0)))) && ((s170_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s171_get)((0)))) && (((((s171_get)((0))) <= ((s0_get)((0)))) && ((s172_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s173_get)((0)))) && (((((s173_get)((0))) <= ((s0_get)((0)))) && ((s174_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s175_get)((0)))) && (((((s175_get)((0))) <= ((s0_get)((0)))) && ((s176_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s177_get)((0)))) && (((((s177_get)((0))) <= ((s0_get)((0)))) && ((s178_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s179_get)((0)))) && (((((s179_get)((0))) <= ((s0_get)((0)))) && ((s180_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s181_get)((0)))) && (((((s181_get)((0))) <= ((s0_get)((0)))) && ((s182_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s183_get)((0)))) && (((((s183_get)((0))) <= ((s0_get)((0)))) && ((s184_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s185_get)((0)))) && (((((s185_get)((0))) <= ((s0_get)((0)))) && ((s186_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s187_get)((0)))) && (((((s187_get)((0))) <= ((s0_get)((0)))) && ((s188_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s189_get)((0)))) && (((((s189_get)((0))) <= ((s0_get)((0)))) && ((s190_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s191_get)((0)))) && (((((s191_get)((0))) <= ((s0_get)((0)))) && ((s192_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s193_get)((0)))) && (((((s193_get)((0))) <= ((s0_get)((0)))) && ((s194_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s195_get)((0)))) && (((((s195_get)((0))) <= ((s0_get)((0)))) && ((s196_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s197_get)((0)))) && (((((s197_get)((0))) <= ((s0_get)((0)))) && ((s198_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s199_get)((0)))) && ((((s199_get)((0))) <= ((s0_get)((0)))) && ((s200_get)((0)))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))) && ((s201_get)((0)));
}

bool verdict_guard(void) {
  return true;
}

bool verdict_arg0(void) {
  return ((!(a_cpy)) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s0_get)((0)))) && (((((s0_get)((0))) <= ((s0_get)((0)))) && (b_cpy)) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s1_get)((0)))) && (((((s1_get)((0))) <= ((s0_get)((0)))) && ((s2_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s3_get)((0)))) && (((((s3_get)((0))) <= ((s0_get)((0)))) && ((s4_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s5_get)((0)))) && (((((s5_get)((0))) <= ((s0_get)((0)))) && ((s6_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s7_get)((0)))) && (((((s7_get)((0))) <= ((s0_get)((0)))) && ((s8_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s9_get)((0)))) && (((((s9_get)((0))) <= ((s0_get)((0)))) && ((s10_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s11_get)((0)))) && (((((s11_get)((0))) <= ((s0_get)((0)))) && ((s12_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s13_get)((0)))) && (((((s13_get)((0))) <= ((s0_get)((0)))) && ((s14_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s15_get)((0)))) && (((((s15_get)((0))) <= ((s0_get)((0)))) && ((s16_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s17_get)((0)))) && (((((s17_get)((0))) <= ((s0_get)((0)))) && ((s18_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s19_get)((0)))) && (((((s19_get)((0))) <= ((s0_get)((0)))) && ((s20_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s21_get)((0)))) && (((((s21_get)((0))) <= ((s0_get)((0)))) && ((s22_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s23_get)((0)))) && (((((s23_get)((0))) <= ((s0_get)((0)))) && ((s24_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s25_get)((0)))) && (((((s25_get)((0))) <= ((s0_get)((0)))) && ((s26_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s27_get)((0)))) && (((((s27_get)((0))) <= ((s0_get)((0)))) && ((s28_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s29_get)((0)))) && (((((s29_get)((0))) <= ((s0_get)((0)))) && ((s30_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s31_get)((0)))) && (((((s31_get)((0))) <= ((s0_get)((0)))) && ((s32_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s33_get)((0)))) && (((((s33_get)((0))) <= ((s0_get)((0)))) && ((s34_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s35_get)((0)))) && (((((s35_get)((0))) <= ((s0_get)((0)))) && ((s36_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s37_get)((0)))) && (((((s37_get)((0))) <= ((s0_get)((0)))) && ((s38_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s39_get)((0)))) && (((((s39_get)((0))) <= ((s0_get)((0)))) && ((s40_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s41_get)((0)))) && (((((s41_get)((0))) <= ((s0_get)((0)))) && ((s42_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s43_get)((0)))) && (((((s43_get)((0))) <= ((s0_get)((0)))) && ((s44_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s45_get)((0)))) && (((((s45_get)((0))) <= ((s0_get)((0)))) && ((s46_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s47_get)((0)))) && (((((s47_get)((0))) <= ((s0_get)((0)))) && ((s48_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s49_get)((0)))) && (((((s49_get)((0))) <= ((s0_get)((0)))) && ((s50_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s51_get)((0)))) && (((((s51_get)((0))) <= ((s0_get)((0)))) && ((s52_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s53_get)((0)))) && (((((s53_get)((0))) <= ((s0_get)((0)))) && ((s54_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s55_get)((0)))) && (((((s55_get)((0))) <= ((s0_get)((0)))) && ((s56_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s57_get)((0)))) && (((((s57_get)((0))) <= ((s0_get)((0)))) && ((s58_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s59_get)((0)))) && (((((s59_get)((0))) <= ((s0_get)((0)))) && ((s60_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s61_get)((0)))) && (((((s61_get)((0))) <= ((s0_get)((0)))) && ((s62_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s63_get)((0)))) && (((((s63_get)((0))) <= ((s0_get)((0)))) && ((s64_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s65_get)((0)))) && (((((s65_get)((0))) <= ((s0_get)((0)))) && ((s66_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s67_get)((0)))) && (((((s67_get)((0))) <= ((s0_get)((0)))) && ((s68_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s69_get)((0)))) && (((((s69_get)((0))) <= ((s0_get)((0)))) && ((s70_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s71_get)((0)))) && (((((s71_get)((0))) <= ((s0_get)((0)))) && ((s72_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s73_get)((0)))) && (((((s73_get)((0))) <= ((s0_get)((0)))) && ((s74_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s75_get)((0)))) && (((((s75_get)((0))) <= ((s0_get)((0)))) && ((s76_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s77_get)((0)))) && (((((s77_get)((0))) <= ((s0_get)((0)))) && ((s78_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s79_get)((0)))) && (((((s79_get)((0))) <= ((s0_get)((0)))) && ((s80_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s81_get)((0)))) && (((((s81_get)((0))) <= ((s0_get)((0)))) && ((s82_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s83_get)((0)))) && (((((s83_get)((0))) <= ((s0_get)((0)))) && ((s84_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s85_get)((0)))) && (((((s85_get)((0))) <= ((s0_get)((0)))) && ((s86_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s87_get)((0)))) && (((((s87_get)((0))) <= ((s0_get)((0)))) && ((s88_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s89_get)((0)))) && (((((s89_get)((0))) <= ((s0_get)((0)))) && ((s90_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s91_get)((0)))) && (((((s91_get)((0))) <= ((s0_get)((0)))) && ((s92_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s93_get)((0)))) && (((((s93_get)((0))) <= ((s0_get)((0)))) && ((s94_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s95_get)((0)))) && (((((s95_get)((0))) <= ((s0_get)((0)))) && ((s96_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s97_get)((0)))) && (((((s97_get)((0))) <= ((s0_get)((0)))) && ((s98_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s99_get)((0)))) && (((((s99_get)((0))) <= ((s0_get)((0)))) && ((s100_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s101_get)((0)))) && (((((s101_get)((0))) <= ((s0_get)((0)))) && ((s102_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s103_get)((0)))) && (((((s103_get)((0))) <= ((s0_get)((0)))) && ((s104_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s105_get)((0)))) && (((((s105_get)((0))) <= ((s0_get)((0)))) && ((s106_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s107_get)((0)))) && (((((s107_get)((0))) <= ((s0_get)((0)))) && ((s108_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s109_get)((0)))) && (((((s109_get)((0))) <= ((s0_get)((0)))) && ((s110_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s111_get)((0)))) && (((((s111_get)((0))) <= ((s0_get)((0)))) && ((s112_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s113_get)((0)))) && (((((s113_get)((0))) <= ((s0_get)((0)))) && ((s114_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s115_get)((0)))) && (((((s115_get)((0))) <= ((s0_get)((0)))) && ((s116_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s117_get)((0)))) && (((((s117_get)((0))) <= ((s0_get)((0)))) && ((s118_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s119_get)((0)))) && (((((s119_get)((0))) <= ((s0_get)((0)))) && ((s120_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s121_get)((0)))) && (((((s121_get)((0))) <= ((s0_get)((0)))) && ((s122_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s123_get)((0)))) && (((((s123_get)((0))) <= ((s0_get)((0)))) && ((s124_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s125_get)((0)))) && (((((s125_get)((0))) <= ((s0_get)((0)))) && ((s126_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s127_get)((0)))) && (((((s127_get)((0))) <= ((s0_get)((0)))) && ((s128_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s129_get)((0)))) && (((((s129_get)((0))) <= ((s0_get)((0)))) && ((s130_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s131_get)((0)))) && (((((s131_get)((0))) <= ((s0_get)((0)))) && ((s132_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s133_get)((0)))) && (((((s133_get)((0))) <= ((s0_get)((0)))) && ((s134_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s135_get)((0)))) && (((((s135_get)((0))) <= ((s0_get)((0)))) && ((s136_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s137_get)((0)))) && (((((s137_get)((0))) <= ((s0_get)((0)))) && ((s138_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s139_get)((0)))) && (((((s139_get)((0))) <= ((s0_get)((0)))) && ((s140_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s141_get)((0)))) && (((((s141_get)((0))) <= ((s0_get)((0)))) && ((s142_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s143_get)((0)))) && (((((s143_get)((0))) <= ((s0_get)((0)))) && ((s144_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s145_get)((0)))) && (((((s145_get)((0))) <= ((s0_get)((0)))) && ((s146_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s147_get)((0)))) && (((((s147_get)((0))) <= ((s0_get)((0)))) && ((s148_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s149_get)((0)))) && (((((s149_get)((0))) <= ((s0_get)((0)))) && ((s150_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s151_get)((0)))) && (((((s151_get)((0))) <= ((s0_get)((0)))) && ((s152_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s153_get)((0)))) && (((((s153_get)((0))) <= ((s0_get)((0)))) && ((s154_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s155_get)((0)))) && (((((s155_get)((0))) <= ((s0_get)((0)))) && ((s156_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s157_get)((0)))) && (((((s157_get)((0))) <= ((s0_get)((0)))) && ((s158_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s159_get)((0)))) && (((((s159_get)((0))) <= ((s0_get)((0)))) && ((s160_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s161_get)((0)))) && (((((s161_get)((0))) <= ((s0_get)((0)))) && ((s162_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s163_get)((0)))) && (((((s163_get)((0))) <= ((s0_get)((0)))) && ((s164_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s165_get)((0)))) && (((((s165_get)((0))) <= ((s0_get)((0)))) && ((s166_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s167_get)((0)))) && (((((s167_get)((0))) <= ((s0_get)((0)))) && ((s168_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s169_get)((0)))) && (((((s169_get)((0))) <= ((s0_get)((0)))) && ((s170_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s171_get)((0)))) && (((((s171_get)((0))) <= ((s0_get)((0)))) && ((s172_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s173_get)((0)))) && (((((s173_get)((0))) <= ((s0_get)((0)))) && ((s174_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s175_get)((0)))) && (((((s175_get)((0))) <= ((s0_get)((0)))) && ((s176_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s177_get)((0)))) && (((((s177_get)((0))) <= ((s0_get)((0)))) && ((s178_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s179_get)((0)))) && (((((s179_get)((0))) <= ((s0_get)((0)))) && ((s180_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s181_get)((0)))) && (((((s181_get)((0))) <= ((s0_get)((0)))) && ((s182_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s183_get)((0)))) && (((((s183_get)((0))) <= ((s0_get)((0)))) && ((s184_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s185_get)((0)))) && (((((s185_get)((0))) <= ((s0_get)((0)))) && ((s186_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s187_get)((0)))) && (((((s187_get)((0))) <= ((s0_get)((0)))) && ((s188_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s189_get)((0)))) && (((((s189_get)((0))) <= ((s0_get)((0)))) && ((s190_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s191_get)((0)))) && (((((s191_get)((0))) <= ((s0_get)((0)))) && ((s192_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s193_get)((0)))) && (((((s193_get)((0))) <= ((s0_get)((0)))) && ((s194_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s195_get)((0)))) && (((((s195_get)((0))) <= ((s0_get)((0)))) && ((s196_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s197_get)((0)))) && (((((s197_get)((0))) <= ((s0_get)((0)))) && ((s198_get)((0)))) || (((((s0_get)((0))) - ((int64_t)(100))) <= ((s199_get)((0)))) && ((((s199_get)((0))) <= ((s0_get)((0)))) && ((s200_get)((0)))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))) && ((s201_get)((0)));
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
  int64_t s41_tmp;
  bool s42_tmp;
  int64_t s43_tmp;
  bool s44_tmp;
  int64_t s45_tmp;
  bool s46_tmp;
  int64_t s47_tmp;
  bool s48_tmp;
  int64_t s49_tmp;
  bool s50_tmp;
  int64_t s51_tmp;
  bool s52_tmp;
  int64_t s53_tmp;
  bool s54_tmp;
  int64_t s55_tmp;
  bool s56_tmp;
  int64_t s57_tmp;
  bool s58_tmp;
  int64_t s59_tmp;
  bool s60_tmp;
  int64_t s61_tmp;
  bool s62_tmp;
  int64_t s63_tmp;
  bool s64_tmp;
  int64_t s65_tmp;
  bool s66_tmp;
  int64_t s67_tmp;
  bool s68_tmp;
  int64_t s69_tmp;
  bool s70_tmp;
  int64_t s71_tmp;
  bool s72_tmp;
  int64_t s73_tmp;
  bool s74_tmp;
  int64_t s75_tmp;
  bool s76_tmp;
  int64_t s77_tmp;
  bool s78_tmp;
  int64_t s79_tmp;
  bool s80_tmp;
  int64_t s81_tmp;
  bool s82_tmp;
  int64_t s83_tmp;
  bool s84_tmp;
  int64_t s85_tmp;
  bool s86_tmp;
  int64_t s87_tmp;
  bool s88_tmp;
  int64_t s89_tmp;
  bool s90_tmp;
  int64_t s91_tmp;
  bool s92_tmp;
  int64_t s93_tmp;
  bool s94_tmp;
  int64_t s95_tmp;
  bool s96_tmp;
  int64_t s97_tmp;
  bool s98_tmp;
  int64_t s99_tmp;
  bool s100_tmp;
  int64_t s101_tmp;
  bool s102_tmp;
  int64_t s103_tmp;
  bool s104_tmp;
  int64_t s105_tmp;
  bool s106_tmp;
  int64_t s107_tmp;
  bool s108_tmp;
  int64_t s109_tmp;
  bool s110_tmp;
  int64_t s111_tmp;
  bool s112_tmp;
  int64_t s113_tmp;
  bool s114_tmp;
  int64_t s115_tmp;
  bool s116_tmp;
  int64_t s117_tmp;
  bool s118_tmp;
  int64_t s119_tmp;
  bool s120_tmp;
  int64_t s121_tmp;
  bool s122_tmp;
  int64_t s123_tmp;
  bool s124_tmp;
  int64_t s125_tmp;
  bool s126_tmp;
  int64_t s127_tmp;
  bool s128_tmp;
  int64_t s129_tmp;
  bool s130_tmp;
  int64_t s131_tmp;
  bool s132_tmp;
  int64_t s133_tmp;
  bool s134_tmp;
  int64_t s135_tmp;
  bool s136_tmp;
  int64_t s137_tmp;
  bool s138_tmp;
  int64_t s139_tmp;
  bool s140_tmp;
  int64_t s141_tmp;
  bool s142_tmp;
  int64_t s143_tmp;
  bool s144_tmp;
  int64_t s145_tmp;
  bool s146_tmp;
  int64_t s147_tmp;
  bool s148_tmp;
  int64_t s149_tmp;
  bool s150_tmp;
  int64_t s151_tmp;
  bool s152_tmp;
  int64_t s153_tmp;
  bool s154_tmp;
  int64_t s155_tmp;
  bool s156_tmp;
  int64_t s157_tmp;
  bool s158_tmp;
  int64_t s159_tmp;
  bool s160_tmp;
  int64_t s161_tmp;
  bool s162_tmp;
  int64_t s163_tmp;
  bool s164_tmp;
  int64_t s165_tmp;
  bool s166_tmp;
  int64_t s167_tmp;
  bool s168_tmp;
  int64_t s169_tmp;
  bool s170_tmp;
  int64_t s171_tmp;
  bool s172_tmp;
  int64_t s173_tmp;
  bool s174_tmp;
  int64_t s175_tmp;
  bool s176_tmp;
  int64_t s177_tmp;
  bool s178_tmp;
  int64_t s179_tmp;
  bool s180_tmp;
  int64_t s181_tmp;
  bool s182_tmp;
  int64_t s183_tmp;
  bool s184_tmp;
  int64_t s185_tmp;
  bool s186_tmp;
  int64_t s187_tmp;
  bool s188_tmp;
  int64_t s189_tmp;
  bool s190_tmp;
  int64_t s191_tmp;
  bool s192_tmp;
  int64_t s193_tmp;
  bool s194_tmp;
  int64_t s195_tmp;
  bool s196_tmp;
  int64_t s197_tmp;
  bool s198_tmp;
  int64_t s199_tmp;
  bool s200_tmp;
  bool s201_tmp;
  bool verdict_arg_temp0;
  (b_cpy) = (b);
  (a_cpy) = (a);
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
  (s42_tmp) = ((s42_gen)());
  (s43_tmp) = ((s43_gen)());
  (s44_tmp) = ((s44_gen)());
  (s45_tmp) = ((s45_gen)());
  (s46_tmp) = ((s46_gen)());
  (s47_tmp) = ((s47_gen)());
  (s48_tmp) = ((s48_gen)());
  (s49_tmp) = ((s49_gen)());
  (s50_tmp) = ((s50_gen)());
  (s51_tmp) = ((s51_gen)());
  (s52_tmp) = ((s52_gen)());
  (s53_tmp) = ((s53_gen)());
  (s54_tmp) = ((s54_gen)());
  (s55_tmp) = ((s55_gen)());
  (s56_tmp) = ((s56_gen)());
  (s57_tmp) = ((s57_gen)());
  (s58_tmp) = ((s58_gen)());
  (s59_tmp) = ((s59_gen)());
  (s60_tmp) = ((s60_gen)());
  (s61_tmp) = ((s61_gen)());
  (s62_tmp) = ((s62_gen)());
  (s63_tmp) = ((s63_gen)());
  (s64_tmp) = ((s64_gen)());
  (s65_tmp) = ((s65_gen)());
  (s66_tmp) = ((s66_gen)());
  (s67_tmp) = ((s67_gen)());
  (s68_tmp) = ((s68_gen)());
  (s69_tmp) = ((s69_gen)());
  (s70_tmp) = ((s70_gen)());
  (s71_tmp) = ((s71_gen)());
  (s72_tmp) = ((s72_gen)());
  (s73_tmp) = ((s73_gen)());
  (s74_tmp) = ((s74_gen)());
  (s75_tmp) = ((s75_gen)());
  (s76_tmp) = ((s76_gen)());
  (s77_tmp) = ((s77_gen)());
  (s78_tmp) = ((s78_gen)());
  (s79_tmp) = ((s79_gen)());
  (s80_tmp) = ((s80_gen)());
  (s81_tmp) = ((s81_gen)());
  (s82_tmp) = ((s82_gen)());
  (s83_tmp) = ((s83_gen)());
  (s84_tmp) = ((s84_gen)());
  (s85_tmp) = ((s85_gen)());
  (s86_tmp) = ((s86_gen)());
  (s87_tmp) = ((s87_gen)());
  (s88_tmp) = ((s88_gen)());
  (s89_tmp) = ((s89_gen)());
  (s90_tmp) = ((s90_gen)());
  (s91_tmp) = ((s91_gen)());
  (s92_tmp) = ((s92_gen)());
  (s93_tmp) = ((s93_gen)());
  (s94_tmp) = ((s94_gen)());
  (s95_tmp) = ((s95_gen)());
  (s96_tmp) = ((s96_gen)());
  (s97_tmp) = ((s97_gen)());
  (s98_tmp) = ((s98_gen)());
  (s99_tmp) = ((s99_gen)());
  (s100_tmp) = ((s100_gen)());
  (s101_tmp) = ((s101_gen)());
  (s102_tmp) = ((s102_gen)());
  (s103_tmp) = ((s103_gen)());
  (s104_tmp) = ((s104_gen)());
  (s105_tmp) = ((s105_gen)());
  (s106_tmp) = ((s106_gen)());
  (s107_tmp) = ((s107_gen)());
  (s108_tmp) = ((s108_gen)());
  (s109_tmp) = ((s109_gen)());
  (s110_tmp) = ((s110_gen)());
  (s111_tmp) = ((s111_gen)());
  (s112_tmp) = ((s112_gen)());
  (s113_tmp) = ((s113_gen)());
  (s114_tmp) = ((s114_gen)());
  (s115_tmp) = ((s115_gen)());
  (s116_tmp) = ((s116_gen)());
  (s117_tmp) = ((s117_gen)());
  (s118_tmp) = ((s118_gen)());
  (s119_tmp) = ((s119_gen)());
  (s120_tmp) = ((s120_gen)());
  (s121_tmp) = ((s121_gen)());
  (s122_tmp) = ((s122_gen)());
  (s123_tmp) = ((s123_gen)());
  (s124_tmp) = ((s124_gen)());
  (s125_tmp) = ((s125_gen)());
  (s126_tmp) = ((s126_gen)());
  (s127_tmp) = ((s127_gen)());
  (s128_tmp) = ((s128_gen)());
  (s129_tmp) = ((s129_gen)());
  (s130_tmp) = ((s130_gen)());
  (s131_tmp) = ((s131_gen)());
  (s132_tmp) = ((s132_gen)());
  (s133_tmp) = ((s133_gen)());
  (s134_tmp) = ((s134_gen)());
  (s135_tmp) = ((s135_gen)());
  (s136_tmp) = ((s136_gen)());
  (s137_tmp) = ((s137_gen)());
  (s138_tmp) = ((s138_gen)());
  (s139_tmp) = ((s139_gen)());
  (s140_tmp) = ((s140_gen)());
  (s141_tmp) = ((s141_gen)());
  (s142_tmp) = ((s142_gen)());
  (s143_tmp) = ((s143_gen)());
  (s144_tmp) = ((s144_gen)());
  (s145_tmp) = ((s145_gen)());
  (s146_tmp) = ((s146_gen)());
  (s147_tmp) = ((s147_gen)());
  (s148_tmp) = ((s148_gen)());
  (s149_tmp) = ((s149_gen)());
  (s150_tmp) = ((s150_gen)());
  (s151_tmp) = ((s151_gen)());
  (s152_tmp) = ((s152_gen)());
  (s153_tmp) = ((s153_gen)());
  (s154_tmp) = ((s154_gen)());
  (s155_tmp) = ((s155_gen)());
  (s156_tmp) = ((s156_gen)());
  (s157_tmp) = ((s157_gen)());
  (s158_tmp) = ((s158_gen)());
  (s159_tmp) = ((s159_gen)());
  (s160_tmp) = ((s160_gen)());
  (s161_tmp) = ((s161_gen)());
  (s162_tmp) = ((s162_gen)());
  (s163_tmp) = ((s163_gen)());
  (s164_tmp) = ((s164_gen)());
  (s165_tmp) = ((s165_gen)());
  (s166_tmp) = ((s166_gen)());
  (s167_tmp) = ((s167_gen)());
  (s168_tmp) = ((s168_gen)());
  (s169_tmp) = ((s169_gen)());
  (s170_tmp) = ((s170_gen)());
  (s171_tmp) = ((s171_gen)());
  (s172_tmp) = ((s172_gen)());
  (s173_tmp) = ((s173_gen)());
  (s174_tmp) = ((s174_gen)());
  (s175_tmp) = ((s175_gen)());
  (s176_tmp) = ((s176_gen)());
  (s177_tmp) = ((s177_gen)());
  (s178_tmp) = ((s178_gen)());
  (s179_tmp) = ((s179_gen)());
  (s180_tmp) = ((s180_gen)());
  (s181_tmp) = ((s181_gen)());
  (s182_tmp) = ((s182_gen)());
  (s183_tmp) = ((s183_gen)());
  (s184_tmp) = ((s184_gen)());
  (s185_tmp) = ((s185_gen)());
  (s186_tmp) = ((s186_gen)());
  (s187_tmp) = ((s187_gen)());
  (s188_tmp) = ((s188_gen)());
  (s189_tmp) = ((s189_gen)());
  (s190_tmp) = ((s190_gen)());
  (s191_tmp) = ((s191_gen)());
  (s192_tmp) = ((s192_gen)());
  (s193_tmp) = ((s193_gen)());
  (s194_tmp) = ((s194_gen)());
  (s195_tmp) = ((s195_gen)());
  (s196_tmp) = ((s196_gen)());
  (s197_tmp) = ((s197_gen)());
  (s198_tmp) = ((s198_gen)());
  (s199_tmp) = ((s199_gen)());
  (s200_tmp) = ((s200_gen)());
  (s201_tmp) = ((s201_gen)());
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
  ((s42)[s42_idx]) = (s42_tmp);
  ((s43)[s43_idx]) = (s43_tmp);
  ((s44)[s44_idx]) = (s44_tmp);
  ((s45)[s45_idx]) = (s45_tmp);
  ((s46)[s46_idx]) = (s46_tmp);
  ((s47)[s47_idx]) = (s47_tmp);
  ((s48)[s48_idx]) = (s48_tmp);
  ((s49)[s49_idx]) = (s49_tmp);
  ((s50)[s50_idx]) = (s50_tmp);
  ((s51)[s51_idx]) = (s51_tmp);
  ((s52)[s52_idx]) = (s52_tmp);
  ((s53)[s53_idx]) = (s53_tmp);
  ((s54)[s54_idx]) = (s54_tmp);
  ((s55)[s55_idx]) = (s55_tmp);
  ((s56)[s56_idx]) = (s56_tmp);
  ((s57)[s57_idx]) = (s57_tmp);
  ((s58)[s58_idx]) = (s58_tmp);
  ((s59)[s59_idx]) = (s59_tmp);
  ((s60)[s60_idx]) = (s60_tmp);
  ((s61)[s61_idx]) = (s61_tmp);
  ((s62)[s62_idx]) = (s62_tmp);
  ((s63)[s63_idx]) = (s63_tmp);
  ((s64)[s64_idx]) = (s64_tmp);
  ((s65)[s65_idx]) = (s65_tmp);
  ((s66)[s66_idx]) = (s66_tmp);
  ((s67)[s67_idx]) = (s67_tmp);
  ((s68)[s68_idx]) = (s68_tmp);
  ((s69)[s69_idx]) = (s69_tmp);
  ((s70)[s70_idx]) = (s70_tmp);
  ((s71)[s71_idx]) = (s71_tmp);
  ((s72)[s72_idx]) = (s72_tmp);
  ((s73)[s73_idx]) = (s73_tmp);
  ((s74)[s74_idx]) = (s74_tmp);
  ((s75)[s75_idx]) = (s75_tmp);
  ((s76)[s76_idx]) = (s76_tmp);
  ((s77)[s77_idx]) = (s77_tmp);
  ((s78)[s78_idx]) = (s78_tmp);
  ((s79)[s79_idx]) = (s79_tmp);
  ((s80)[s80_idx]) = (s80_tmp);
  ((s81)[s81_idx]) = (s81_tmp);
  ((s82)[s82_idx]) = (s82_tmp);
  ((s83)[s83_idx]) = (s83_tmp);
  ((s84)[s84_idx]) = (s84_tmp);
  ((s85)[s85_idx]) = (s85_tmp);
  ((s86)[s86_idx]) = (s86_tmp);
  ((s87)[s87_idx]) = (s87_tmp);
  ((s88)[s88_idx]) = (s88_tmp);
  ((s89)[s89_idx]) = (s89_tmp);
  ((s90)[s90_idx]) = (s90_tmp);
  ((s91)[s91_idx]) = (s91_tmp);
  ((s92)[s92_idx]) = (s92_tmp);
  ((s93)[s93_idx]) = (s93_tmp);
  ((s94)[s94_idx]) = (s94_tmp);
  ((s95)[s95_idx]) = (s95_tmp);
  ((s96)[s96_idx]) = (s96_tmp);
  ((s97)[s97_idx]) = (s97_tmp);
  ((s98)[s98_idx]) = (s98_tmp);
  ((s99)[s99_idx]) = (s99_tmp);
  ((s100)[s100_idx]) = (s100_tmp);
  ((s101)[s101_idx]) = (s101_tmp);
  ((s102)[s102_idx]) = (s102_tmp);
  ((s103)[s103_idx]) = (s103_tmp);
  ((s104)[s104_idx]) = (s104_tmp);
  ((s105)[s105_idx]) = (s105_tmp);
  ((s106)[s106_idx]) = (s106_tmp);
  ((s107)[s107_idx]) = (s107_tmp);
  ((s108)[s108_idx]) = (s108_tmp);
  ((s109)[s109_idx]) = (s109_tmp);
  ((s110)[s110_idx]) = (s110_tmp);
  ((s111)[s111_idx]) = (s111_tmp);
  ((s112)[s112_idx]) = (s112_tmp);
  ((s113)[s113_idx]) = (s113_tmp);
  ((s114)[s114_idx]) = (s114_tmp);
  ((s115)[s115_idx]) = (s115_tmp);
  ((s116)[s116_idx]) = (s116_tmp);
  ((s117)[s117_idx]) = (s117_tmp);
  ((s118)[s118_idx]) = (s118_tmp);
  ((s119)[s119_idx]) = (s119_tmp);
  ((s120)[s120_idx]) = (s120_tmp);
  ((s121)[s121_idx]) = (s121_tmp);
  ((s122)[s122_idx]) = (s122_tmp);
  ((s123)[s123_idx]) = (s123_tmp);
  ((s124)[s124_idx]) = (s124_tmp);
  ((s125)[s125_idx]) = (s125_tmp);
  ((s126)[s126_idx]) = (s126_tmp);
  ((s127)[s127_idx]) = (s127_tmp);
  ((s128)[s128_idx]) = (s128_tmp);
  ((s129)[s129_idx]) = (s129_tmp);
  ((s130)[s130_idx]) = (s130_tmp);
  ((s131)[s131_idx]) = (s131_tmp);
  ((s132)[s132_idx]) = (s132_tmp);
  ((s133)[s133_idx]) = (s133_tmp);
  ((s134)[s134_idx]) = (s134_tmp);
  ((s135)[s135_idx]) = (s135_tmp);
  ((s136)[s136_idx]) = (s136_tmp);
  ((s137)[s137_idx]) = (s137_tmp);
  ((s138)[s138_idx]) = (s138_tmp);
  ((s139)[s139_idx]) = (s139_tmp);
  ((s140)[s140_idx]) = (s140_tmp);
  ((s141)[s141_idx]) = (s141_tmp);
  ((s142)[s142_idx]) = (s142_tmp);
  ((s143)[s143_idx]) = (s143_tmp);
  ((s144)[s144_idx]) = (s144_tmp);
  ((s145)[s145_idx]) = (s145_tmp);
  ((s146)[s146_idx]) = (s146_tmp);
  ((s147)[s147_idx]) = (s147_tmp);
  ((s148)[s148_idx]) = (s148_tmp);
  ((s149)[s149_idx]) = (s149_tmp);
  ((s150)[s150_idx]) = (s150_tmp);
  ((s151)[s151_idx]) = (s151_tmp);
  ((s152)[s152_idx]) = (s152_tmp);
  ((s153)[s153_idx]) = (s153_tmp);
  ((s154)[s154_idx]) = (s154_tmp);
  ((s155)[s155_idx]) = (s155_tmp);
  ((s156)[s156_idx]) = (s156_tmp);
  ((s157)[s157_idx]) = (s157_tmp);
  ((s158)[s158_idx]) = (s158_tmp);
  ((s159)[s159_idx]) = (s159_tmp);
  ((s160)[s160_idx]) = (s160_tmp);
  ((s161)[s161_idx]) = (s161_tmp);
  ((s162)[s162_idx]) = (s162_tmp);
  ((s163)[s163_idx]) = (s163_tmp);
  ((s164)[s164_idx]) = (s164_tmp);
  ((s165)[s165_idx]) = (s165_tmp);
  ((s166)[s166_idx]) = (s166_tmp);
  ((s167)[s167_idx]) = (s167_tmp);
  ((s168)[s168_idx]) = (s168_tmp);
  ((s169)[s169_idx]) = (s169_tmp);
  ((s170)[s170_idx]) = (s170_tmp);
  ((s171)[s171_idx]) = (s171_tmp);
  ((s172)[s172_idx]) = (s172_tmp);
  ((s173)[s173_idx]) = (s173_tmp);
  ((s174)[s174_idx]) = (s174_tmp);
  ((s175)[s175_idx]) = (s175_tmp);
  ((s176)[s176_idx]) = (s176_tmp);
  ((s177)[s177_idx]) = (s177_tmp);
  ((s178)[s178_idx]) = (s178_tmp);
  ((s179)[s179_idx]) = (s179_tmp);
  ((s180)[s180_idx]) = (s180_tmp);
  ((s181)[s181_idx]) = (s181_tmp);
  ((s182)[s182_idx]) = (s182_tmp);
  ((s183)[s183_idx]) = (s183_tmp);
  ((s184)[s184_idx]) = (s184_tmp);
  ((s185)[s185_idx]) = (s185_tmp);
  ((s186)[s186_idx]) = (s186_tmp);
  ((s187)[s187_idx]) = (s187_tmp);
  ((s188)[s188_idx]) = (s188_tmp);
  ((s189)[s189_idx]) = (s189_tmp);
  ((s190)[s190_idx]) = (s190_tmp);
  ((s191)[s191_idx]) = (s191_tmp);
  ((s192)[s192_idx]) = (s192_tmp);
  ((s193)[s193_idx]) = (s193_tmp);
  ((s194)[s194_idx]) = (s194_tmp);
  ((s195)[s195_idx]) = (s195_tmp);
  ((s196)[s196_idx]) = (s196_tmp);
  ((s197)[s197_idx]) = (s197_tmp);
  ((s198)[s198_idx]) = (s198_tmp);
  ((s199)[s199_idx]) = (s199_tmp);
  ((s200)[s200_idx]) = (s200_tmp);
  ((s201)[s201_idx]) = (s201_tmp);
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
  (s42_idx) = (((s42_idx) + (1)) % (1));
  (s43_idx) = (((s43_idx) + (1)) % (1));
  (s44_idx) = (((s44_idx) + (1)) % (1));
  (s45_idx) = (((s45_idx) + (1)) % (1));
  (s46_idx) = (((s46_idx) + (1)) % (1));
  (s47_idx) = (((s47_idx) + (1)) % (1));
  (s48_idx) = (((s48_idx) + (1)) % (1));
  (s49_idx) = (((s49_idx) + (1)) % (1));
  (s50_idx) = (((s50_idx) + (1)) % (1));
  (s51_idx) = (((s51_idx) + (1)) % (1));
  (s52_idx) = (((s52_idx) + (1)) % (1));
  (s53_idx) = (((s53_idx) + (1)) % (1));
  (s54_idx) = (((s54_idx) + (1)) % (1));
  (s55_idx) = (((s55_idx) + (1)) % (1));
  (s56_idx) = (((s56_idx) + (1)) % (1));
  (s57_idx) = (((s57_idx) + (1)) % (1));
  (s58_idx) = (((s58_idx) + (1)) % (1));
  (s59_idx) = (((s59_idx) + (1)) % (1));
  (s60_idx) = (((s60_idx) + (1)) % (1));
  (s61_idx) = (((s61_idx) + (1)) % (1));
  (s62_idx) = (((s62_idx) + (1)) % (1));
  (s63_idx) = (((s63_idx) + (1)) % (1));
  (s64_idx) = (((s64_idx) + (1)) % (1));
  (s65_idx) = (((s65_idx) + (1)) % (1));
  (s66_idx) = (((s66_idx) + (1)) % (1));
  (s67_idx) = (((s67_idx) + (1)) % (1));
  (s68_idx) = (((s68_idx) + (1)) % (1));
  (s69_idx) = (((s69_idx) + (1)) % (1));
  (s70_idx) = (((s70_idx) + (1)) % (1));
  (s71_idx) = (((s71_idx) + (1)) % (1));
  (s72_idx) = (((s72_idx) + (1)) % (1));
  (s73_idx) = (((s73_idx) + (1)) % (1));
  (s74_idx) = (((s74_idx) + (1)) % (1));
  (s75_idx) = (((s75_idx) + (1)) % (1));
  (s76_idx) = (((s76_idx) + (1)) % (1));
  (s77_idx) = (((s77_idx) + (1)) % (1));
  (s78_idx) = (((s78_idx) + (1)) % (1));
  (s79_idx) = (((s79_idx) + (1)) % (1));
  (s80_idx) = (((s80_idx) + (1)) % (1));
  (s81_idx) = (((s81_idx) + (1)) % (1));
  (s82_idx) = (((s82_idx) + (1)) % (1));
  (s83_idx) = (((s83_idx) + (1)) % (1));
  (s84_idx) = (((s84_idx) + (1)) % (1));
  (s85_idx) = (((s85_idx) + (1)) % (1));
  (s86_idx) = (((s86_idx) + (1)) % (1));
  (s87_idx) = (((s87_idx) + (1)) % (1));
  (s88_idx) = (((s88_idx) + (1)) % (1));
  (s89_idx) = (((s89_idx) + (1)) % (1));
  (s90_idx) = (((s90_idx) + (1)) % (1));
  (s91_idx) = (((s91_idx) + (1)) % (1));
  (s92_idx) = (((s92_idx) + (1)) % (1));
  (s93_idx) = (((s93_idx) + (1)) % (1));
  (s94_idx) = (((s94_idx) + (1)) % (1));
  (s95_idx) = (((s95_idx) + (1)) % (1));
  (s96_idx) = (((s96_idx) + (1)) % (1));
  (s97_idx) = (((s97_idx) + (1)) % (1));
  (s98_idx) = (((s98_idx) + (1)) % (1));
  (s99_idx) = (((s99_idx) + (1)) % (1));
  (s100_idx) = (((s100_idx) + (1)) % (1));
  (s101_idx) = (((s101_idx) + (1)) % (1));
  (s102_idx) = (((s102_idx) + (1)) % (1));
  (s103_idx) = (((s103_idx) + (1)) % (1));
  (s104_idx) = (((s104_idx) + (1)) % (1));
  (s105_idx) = (((s105_idx) + (1)) % (1));
  (s106_idx) = (((s106_idx) + (1)) % (1));
  (s107_idx) = (((s107_idx) + (1)) % (1));
  (s108_idx) = (((s108_idx) + (1)) % (1));
  (s109_idx) = (((s109_idx) + (1)) % (1));
  (s110_idx) = (((s110_idx) + (1)) % (1));
  (s111_idx) = (((s111_idx) + (1)) % (1));
  (s112_idx) = (((s112_idx) + (1)) % (1));
  (s113_idx) = (((s113_idx) + (1)) % (1));
  (s114_idx) = (((s114_idx) + (1)) % (1));
  (s115_idx) = (((s115_idx) + (1)) % (1));
  (s116_idx) = (((s116_idx) + (1)) % (1));
  (s117_idx) = (((s117_idx) + (1)) % (1));
  (s118_idx) = (((s118_idx) + (1)) % (1));
  (s119_idx) = (((s119_idx) + (1)) % (1));
  (s120_idx) = (((s120_idx) + (1)) % (1));
  (s121_idx) = (((s121_idx) + (1)) % (1));
  (s122_idx) = (((s122_idx) + (1)) % (1));
  (s123_idx) = (((s123_idx) + (1)) % (1));
  (s124_idx) = (((s124_idx) + (1)) % (1));
  (s125_idx) = (((s125_idx) + (1)) % (1));
  (s126_idx) = (((s126_idx) + (1)) % (1));
  (s127_idx) = (((s127_idx) + (1)) % (1));
  (s128_idx) = (((s128_idx) + (1)) % (1));
  (s129_idx) = (((s129_idx) + (1)) % (1));
  (s130_idx) = (((s130_idx) + (1)) % (1));
  (s131_idx) = (((s131_idx) + (1)) % (1));
  (s132_idx) = (((s132_idx) + (1)) % (1));
  (s133_idx) = (((s133_idx) + (1)) % (1));
  (s134_idx) = (((s134_idx) + (1)) % (1));
  (s135_idx) = (((s135_idx) + (1)) % (1));
  (s136_idx) = (((s136_idx) + (1)) % (1));
  (s137_idx) = (((s137_idx) + (1)) % (1));
  (s138_idx) = (((s138_idx) + (1)) % (1));
  (s139_idx) = (((s139_idx) + (1)) % (1));
  (s140_idx) = (((s140_idx) + (1)) % (1));
  (s141_idx) = (((s141_idx) + (1)) % (1));
  (s142_idx) = (((s142_idx) + (1)) % (1));
  (s143_idx) = (((s143_idx) + (1)) % (1));
  (s144_idx) = (((s144_idx) + (1)) % (1));
  (s145_idx) = (((s145_idx) + (1)) % (1));
  (s146_idx) = (((s146_idx) + (1)) % (1));
  (s147_idx) = (((s147_idx) + (1)) % (1));
  (s148_idx) = (((s148_idx) + (1)) % (1));
  (s149_idx) = (((s149_idx) + (1)) % (1));
  (s150_idx) = (((s150_idx) + (1)) % (1));
  (s151_idx) = (((s151_idx) + (1)) % (1));
  (s152_idx) = (((s152_idx) + (1)) % (1));
  (s153_idx) = (((s153_idx) + (1)) % (1));
  (s154_idx) = (((s154_idx) + (1)) % (1));
  (s155_idx) = (((s155_idx) + (1)) % (1));
  (s156_idx) = (((s156_idx) + (1)) % (1));
  (s157_idx) = (((s157_idx) + (1)) % (1));
  (s158_idx) = (((s158_idx) + (1)) % (1));
  (s159_idx) = (((s159_idx) + (1)) % (1));
  (s160_idx) = (((s160_idx) + (1)) % (1));
  (s161_idx) = (((s161_idx) + (1)) % (1));
  (s162_idx) = (((s162_idx) + (1)) % (1));
  (s163_idx) = (((s163_idx) + (1)) % (1));
  (s164_idx) = (((s164_idx) + (1)) % (1));
  (s165_idx) = (((s165_idx) + (1)) % (1));
  (s166_idx) = (((s166_idx) + (1)) % (1));
  (s167_idx) = (((s167_idx) + (1)) % (1));
  (s168_idx) = (((s168_idx) + (1)) % (1));
  (s169_idx) = (((s169_idx) + (1)) % (1));
  (s170_idx) = (((s170_idx) + (1)) % (1));
  (s171_idx) = (((s171_idx) + (1)) % (1));
  (s172_idx) = (((s172_idx) + (1)) % (1));
  (s173_idx) = (((s173_idx) + (1)) % (1));
  (s174_idx) = (((s174_idx) + (1)) % (1));
  (s175_idx) = (((s175_idx) + (1)) % (1));
  (s176_idx) = (((s176_idx) + (1)) % (1));
  (s177_idx) = (((s177_idx) + (1)) % (1));
  (s178_idx) = (((s178_idx) + (1)) % (1));
  (s179_idx) = (((s179_idx) + (1)) % (1));
  (s180_idx) = (((s180_idx) + (1)) % (1));
  (s181_idx) = (((s181_idx) + (1)) % (1));
  (s182_idx) = (((s182_idx) + (1)) % (1));
  (s183_idx) = (((s183_idx) + (1)) % (1));
  (s184_idx) = (((s184_idx) + (1)) % (1));
  (s185_idx) = (((s185_idx) + (1)) % (1));
  (s186_idx) = (((s186_idx) + (1)) % (1));
  (s187_idx) = (((s187_idx) + (1)) % (1));
  (s188_idx) = (((s188_idx) + (1)) % (1));
  (s189_idx) = (((s189_idx) + (1)) % (1));
  (s190_idx) = (((s190_idx) + (1)) % (1));
  (s191_idx) = (((s191_idx) + (1)) % (1));
  (s192_idx) = (((s192_idx) + (1)) % (1));
  (s193_idx) = (((s193_idx) + (1)) % (1));
  (s194_idx) = (((s194_idx) + (1)) % (1));
  (s195_idx) = (((s195_idx) + (1)) % (1));
  (s196_idx) = (((s196_idx) + (1)) % (1));
  (s197_idx) = (((s197_idx) + (1)) % (1));
  (s198_idx) = (((s198_idx) + (1)) % (1));
  (s199_idx) = (((s199_idx) + (1)) % (1));
  (s200_idx) = (((s200_idx) + (1)) % (1));
  (s201_idx) = (((s201_idx) + (1)) % (1));
}
