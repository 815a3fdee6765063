#include "core/povray_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/noise.h"

namespace oktett::povray_noise_test {
namespace {

// Printed by POV-Ray 3.7.0.10: f_noise_generator with 1, 2 and 3, and vturbulence(2, 0.5, 1, p).
TEST(PovrayNoise, HasItsValues) {
  struct Known {
    Vec3d p;
    double of[3];
    Vec3d vector;
  };
  constexpr Known kKnown[] = {{{-21.116152821005237, -31.746717261542734, -8.3153405911455209},
                               {0.35954716373125672, 0.44673242280264897, 0.38252146459862441},
                               {-0.14045283626874328, -0.36517098067181314, -0.21481976114898477}},
                              {{-27.60221833580718, -34.678792345632807, -7.8727188411940148},
                               {0.42114545971447070, 0.47690670659210899, 0.59480105598984645},
                               {-0.07885454028552932, 0.03580101815464259, 0.34020088905201945}},
                              {{33.436403447017511, 24.036188119664686, 21.213008200435077},
                               {0.52064391214758632, 0.52564660259746376, 0.37841965510669273},
                               {0.02064391214758630, 0.01034865630720820, -0.17393467075122995}},
                              {{-22.24574594477459, 2.9344006539850795, -17.865388524683983},
                               {0.21817118324810925, 0.37747857595477280, 0.47238102058776571},
                               {-0.28182881675189075, 0.02501240619799541, 0.07997904312470142}}};
  for (const Known& known : kKnown) {
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(povray_noise(known.p, static_cast<NoiseGenerator>(i + 1)), known.of[i], 1e-15);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(povray_noise_vector(known.p)[k], known.vector[k], 1e-15);
    EXPECT_NEAR(noise_value(known.p, NoiseKind::povray), known.of[0] - 0.5, 1e-15);
  }
}

TEST(PovrayNoise, RepeatsAfter4096AndNeedsNoBounds) {
  using enum NoiseGenerator;
  const Vec3d p{0.3, -7.25, 12.5};
  for (int k = 0; k < 3; ++k) {
    Vec3d q = p;
    q[k] += 4096;
    EXPECT_NEAR(povray_noise(q, povray_2), povray_noise(p, povray_2), 1e-9);
  }
  const double inf = std::numeric_limits<double>::infinity();
  for (const double far : {1e9, -1e18, 1e300, inf, -inf, std::nan("")})
    for (const NoiseGenerator generator : {povray_1, povray_2, povray_3}) {
      const double value = povray_noise({far, 0.5, far}, generator);
      EXPECT_FALSE(value < 0 || value > 1) << far;
    }
  EXPECT_FALSE(povray_cell_number(std::int64_t{1} << 62, -5, 0, 2) >= 1);
}

}  // namespace
}  // namespace oktett::povray_noise_test
