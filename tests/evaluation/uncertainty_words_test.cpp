// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <palpate/evaluation/uncertainty_words.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

UncertaintySummary plain_summary() {
  UncertaintySummary s;
  s.frames_used = 1200;
  s.weakest = {.force_N = {0.006, -0.003, -0.3}, .prior_sigmas = 0.3};
  s.last_covariance_tip_N2 = Vector3d(1e-6, 4e-6, 9e-6).asDiagonal();
  s.last_shaft = {.stiffness_Nm2 = {2.612e-4, 1.6664e-4, 1.645e-4},
                  .stiffness_sigma_Nm2 = {1.306e-5, 8.332e-6, 8.225e-6},
                  .precurvature_per_m = {39.99, 0.25, 0.0},
                  .precurvature_sigma_per_m = {0.5, 0.4, 0.0}};
  return s;
}

/// sqrt(7.8147) = 2.7955 (95 % of chi-square with three degrees of freedom).
constexpr const char* kEllipsoid =
    "95 % ellipsoid of the last frame: semi-axes 0.0084, 0.0056, 0.0028 N, the longest along d3 (0.00, 0.00, 1.00)\n";

TEST(UncertaintyWords, ForceAlone) {
  EXPECT_EQ(in_words(plain_summary(), {}),
            std::string("weakest direction: d3 (-0.02, 0.01, 1.00), known to 0.3 prior sigmas by one frame alone\n"
                        "stiffness scale: the catheter file's, known to 5.0 %\n") +
                kEllipsoid);
  EXPECT_EQ(in_words({}, {}), "");
}

TEST(UncertaintyWords, NoiseAlone) {
  EXPECT_EQ(in_words(plain_summary(), {.consider_uncertainty = false}),
            std::string("sigma is of noise alone: what the catheter file calls uncertain is left out\n"
                        "weakest direction: d3 (-0.02, 0.01, 1.00), known to 0.3 prior sigmas by one frame alone\n"
                        "stiffness scale: the catheter file's, taken as exact\n") +
                kEllipsoid);
  EXPECT_THAT(
      in_words(plain_summary(), {.estimate_precurvature = true, .consider_uncertainty = false}),
      HasSubstr("sigma is of noise and of what is estimated: what else the catheter file calls uncertain is left "
                "out\n"));
}

TEST(UncertaintyWords, SourcesThatAreNotZero) {
  UncertaintySummary s = plain_summary();
  s.median_sigma_by_source_N[static_cast<std::size_t>(UncertaintySource::kNoise)] = {0.0012, 0.0034, 0.005};
  s.median_sigma_by_source_N[static_cast<std::size_t>(UncertaintySource::kBase)] = {0.0, 0.0, 0.012};
  EXPECT_THAT(in_words(s, {}), HasSubstr("what makes the sigma (median, mN):            Fx        Fy        Fz\n"
                                         "  noise                                    1.200     3.400     5.000\n"
                                         "  base                                     0.000     0.000    12.000\n"
                                         "weakest direction"));
}

TEST(UncertaintyWords, WeakestDirectionWithParameters) {
  UncertaintySummary s = plain_summary();
  s.weakest.prior_sigmas = std::numeric_limits<double>::infinity();
  EXPECT_THAT(in_words(s, {}),
              HasSubstr("weakest direction: d3 (-0.02, 0.01, 1.00), of which one frame alone says nothing\n"));
  s.weakest.force_N = {0.3, 0.3, 0.0};
  EXPECT_THAT(in_words(s, {}), HasSubstr("weakest direction: (0.71, 0.71, 0.00), "));
  s.weakest = {.force_N = {0.01, 0.0, 0.12},
               .log_stiffness = {0.049, 0.05, 0.048},
               .precurvature_per_m = {0.1, -0.2, 0.0},
               .prior_sigmas = 0.984};
  EXPECT_THAT(in_words(s, {}),
              HasSubstr("weakest direction: force (0.010, 0.000, 0.120) N with stiffness (4.9, 5.0, 4.8) % with "
                        "precurvature (0.10, -0.20) 1/m, known to 0.98 prior sigmas by one frame alone\n"));
}

TEST(UncertaintyWords, HiddenFrames) {
  UncertaintySummary s = plain_summary();
  s.hidden = {.axial_force = 320, .axial_force_straight = 312, .lateral_force = 3};
  EXPECT_THAT(in_words(s, {}), HasSubstr("not observable: axial force in 312 of 1200 frames (shaft is straight)\n"
                                         "hardly observable: axial force in 8 of 1200 frames\n"
                                         "not observable: lateral force in 3 of 1200 frames\n"));
}

TEST(UncertaintyWords, EstimatedParameters) {
  UncertaintySummary s = plain_summary();
  s.last_observability.stiffness_scale_sigma = s.last_observability.stiffness_scale_prior_sigma = 0.05;
  s.last_observability.stiffness_rests_on_prior = true;
  ObserverOptions options{.estimate_stiffness = true};
  EXPECT_THAT(in_words(s, options),
              HasSubstr("stiffness scale: 5.0 % (prior 5.0 %): rests on the prior\n"
                        "EI1 = 0.0002612 +- 1.3e-05 N m^2; EI2 = 0.0001666 +- 8.3e-06 N m^2 (last frame)\n"));
  s.last_observability.stiffness_scale_sigma = 0.012;
  s.last_observability.stiffness_rests_on_prior = false;
  options.free_torsion = options.estimate_precurvature = true;
  EXPECT_THAT(
      in_words(s, options),
      HasSubstr("stiffness scale: 1.2 % (prior 5.0 %)\n"
                "EI1 = 0.0002612 +- 1.3e-05 N m^2; EI2 = 0.0001666 +- 8.3e-06 N m^2; GJ = 0.0001645 +- 8.2e-06 N "
                "m^2; k1,0 = 39.99 +- 0.5 1/m; k2,0 = 0.25 +- 0.4 1/m (last frame)\n"));
  EXPECT_THAT(in_words(s, options), Not(HasSubstr("precurvature: rests on the prior")));
  s.last_observability.precurvature_rests_on_prior = true;
  EXPECT_THAT(in_words(s, options), HasSubstr("precurvature: rests on the prior\n"));
}

}  // namespace
}  // namespace palpate
