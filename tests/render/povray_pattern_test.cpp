#include <gtest/gtest.h>

#include <utility>
#include <variant>

#include "render/pattern.h"

namespace oktett::povray_pattern_test {
namespace {

constexpr Vec3d kPlaces[] = {{-2.114, -4.19, 1.811}, {-5.131, 0.431, -1.612}, {-5.304, 0.089, -5.55}};

struct Known {
  PatternTexture texture;
  double values[3];
};

PatternTexture of(Pattern pattern, NoiseGenerator generator = NoiseGenerator::povray_2) {
  PatternTexture texture;
  texture.pattern = std::move(pattern);
  texture.set_noise_generator(generator);
  return texture;
}
PatternTexture turbulent(Pattern pattern, PatternTurbulence turbulence) {
  PatternTexture texture = of(std::move(pattern));
  turbulence.generator = texture.turbulence.generator;
  texture.turbulence = turbulence;
  return texture;
}
PatternTexture frequent(Pattern pattern, double frequency) {
  PatternTexture texture = of(std::move(pattern));
  texture.wave.frequency = frequency;
  return texture;
}

// Printed by POV-Ray 3.7.0.10: functions of `pattern` with the words in the comments.
TEST(PovrayPatterns, HaveItsValues) {
  using enum NoiseGenerator;
  const Known known[] = {
      // crackle, `form <1, 0, 0>`, `solid`, `metric 1 offset 0.2`
      {of(CracklePattern{}), {0.632677002540, 0.204797192258, 0.121597621623}},
      {of(CracklePattern{{1, 0, 0}}), {0.365764824202, 0.638234815834, 0.366897448759}},
      {of(CracklePattern{{-1, 1, 0}, 2, 0, true}), {0.464728828936, 0.479194742804, 0.363705375977}},
      {of(CracklePattern{{-1, 1, 0}, 1, 0.2}), {0.857244980315, 0.109539162531, 0.132834014550}},
      {of(CellsPattern{}), {0.096454530722, 0.430813850835, 0.851695741760}},
      {of(GranitePattern{}), {0.383915318756, 0.463655672987, 0.252452134959}},
      {of(GranitePattern{}, povray_1), {0.402766457321, 0.440099220901, 0.300292366446}},
      {of(GranitePattern{}, povray_3), {0.404919690174, 0.392667255157, 0.645499731727}},
      {of(WrinklesPattern{}), {0.473358725546, 0.592023199005, 0.436620989520}},
      {of(WrinklesPattern{}, povray_1), {0.441136606040, 0.564887552258, 0.403638086552}},
      {of(AgatePattern{}), {0.986373226336, 0.015117655094, 0.602220417976}},
      // bozo
      {of(NoisePattern{1, {1, 0.5}}), {0.565208659015, 0.559420359754, 0.375705125842}},
      {of(BumpsPattern{}), {0.565208659015, 0.559420359754, 0.375705125842}},
      {of(DentsPattern{}), {0.180562026329, 0.175071238713, 0.053032409668}},
      // ripples frequency 2, waves frequency 3
      {frequent(RipplesPattern{}, 2), {0.071832446354, 0.144179856123, 0.525054527358}},
      {frequent(WavesPattern{}, 3), {0.587525843718, 0.702461964725, 0.773189440191}},
      // marble turbulence 0.7, wood turbulence 0.1, spiral1 3 turbulence 0.5
      {turbulent(LayersPattern{}, {{0.7, 0.7, 0.7}}), {0.919009273192, 0.644103294880, 0.588103766803}},
      {turbulent(RingsPattern{}, {{0.1, 0.1, 0.1}}), {0.672614844299, 0.285703716196, 0.015326007317}},
      {turbulent(SpiralPattern{3}, {{0.5, 0.5, 0.5}}), {0.080894148707, 0.760830628974, 0.856336051485}},
      // gradient x turbulence <0.4, 0.3, 0.2> octaves 3 lambda 2.5 omega 0.7
      {turbulent(LinearPattern{{1, 0, 0}}, {{0.4, 0.3, 0.2}, 3, 2.5, 0.7}),
       {0.029343229057, 0.811286355612, 0.533584498294}}};
  for (std::size_t i = 0; i < std::size(known); ++i) {
    // In spirals many turns are counted, each of a period of 1.00001.
    const double off = std::holds_alternative<SpiralPattern>(known[i].texture.pattern) ? 1e-4 : 1e-6;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(double{pattern_color(known[i].texture, kPlaces[k]).x}, known[i].values[k], off)
          << i << " " << k;
  }
}

}  // namespace
}  // namespace oktett::povray_pattern_test
