// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <palpate/evaluation/contact_finder.hpp>

namespace palpate {
namespace {

ForceSize measured(double time_s, double size_N) {
  return {.time_s = time_s, .size_N = size_N, .sigma_N = 1e-3, .measured = true};
}

TEST(ContactFinder, TellsOfAContactWhileItLasts) {
  ContactFinder finder({.on_N = 0.05, .off_share = 0.7});
  for (int i = 0; i <= 10; ++i) EXPECT_FALSE(finder.add(measured(0.1 * i, 0.0)));
  EXPECT_EQ(finder.current().frames, 0U);
  for (int i = 11; i <= 20; ++i) EXPECT_FALSE(finder.add(measured(0.1 * i, 0.2)));
  EXPECT_NEAR(finder.current().from_s, 1.1, 1e-12);
  EXPECT_NEAR(finder.current().integral_Ns, 0.9 * 0.2, 1e-12);
  const auto ended = finder.add(measured(2.1, 0.01));
  ASSERT_TRUE(ended);
  EXPECT_NEAR(ended->duration_s(), 0.9, 1e-12);
  EXPECT_EQ(finder.current().frames, 0U);
}

/// Live nobody may wait for the next measured frame to hear that there is none.
TEST(ContactFinder, EndsAContactOfWhichNothingIsHeard) {
  ContactFinder finder({.on_N = 0.05, .bridge_s = 0.25});
  for (int i = 0; i <= 10; ++i) finder.add(measured(0.1 * i, 0.2));
  EXPECT_FALSE(finder.add({.time_s = 1.2, .size_N = 0.2, .sigma_N = 1.0, .measured = false}));
  EXPECT_FALSE(finder.add({.time_s = std::nan(""), .size_N = 0.2, .sigma_N = 1.0, .measured = false}));
  EXPECT_EQ(finder.current().frames, 11U);
  const auto ended = finder.add({.time_s = 1.3, .size_N = 0.2, .sigma_N = 1.0, .measured = false});
  ASSERT_TRUE(ended);
  EXPECT_NEAR(ended->to_s, 1.0, 1e-12);
}

TEST(ForceIntegral, OfARamp) {
  ForceIntegral integral;
  for (int i = 0; i <= 100; ++i) integral.add(measured(5.0 + 0.02 * i, 0.1 * i * 0.02));
  EXPECT_NEAR(integral.integral_Ns, 0.5 * 0.1 * 2.0 * 2.0, 1e-12);
  EXPECT_NEAR(integral.sigma_Ns, 2e-3, 1e-12);
  EXPECT_NEAR(integral.measured_s, 2.0, 1e-12);
  EXPECT_EQ(integral.unmeasured_s, 0.0);
}

TEST(ForceIntegral, ShortGapsAreBridgedLongOnesAreNot) {
  ForceIntegral integral(0.25);
  const auto lost = [](double time_s) { return ForceSize{time_s, 9.0, 9.0, false}; };
  for (const double t : {0.0, 0.1}) integral.add(measured(t, 0.1));
  integral.add(lost(0.2));
  integral.add(measured(0.3, 0.1));  // 0.2 s after the measured one before
  for (const double t : {0.4, 0.5, 0.6, 0.7}) integral.add(lost(t));
  EXPECT_NEAR(integral.unmeasured_s, 0.4, 1e-12);  // said at once, not when it is over
  integral.add(measured(0.8, 0.1));
  integral.add(measured(0.9, 0.1));
  EXPECT_NEAR(integral.integral_Ns, 0.1 * 0.4, 1e-12);
  EXPECT_NEAR(integral.measured_s, 0.4, 1e-12);
  EXPECT_NEAR(integral.unmeasured_s, 0.5, 1e-12);
  integral.add(measured(0.5, 0.1));  // a clock that steps back costs nothing, and bridges nothing
  EXPECT_NEAR(integral.measured_s + integral.unmeasured_s, 0.9, 1e-12);
}

}  // namespace
}  // namespace palpate
