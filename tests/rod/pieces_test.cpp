// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/rod/rod_cases.hpp"

/// Stations cut the rod into pieces. However they do, the promised accuracy holds: 1e-6 and 1e-8 of the length.
namespace palpate {
namespace {

constexpr double kLength_m = 0.07;

struct Cuts {
  const char* name;
  std::vector<double> places_m;
};

std::vector<Cuts> cuts() {
  std::vector<Cuts> all{{"tip alone", {kLength_m}},
                        {"just behind the tip", {kLength_m, 0.0685}},
                        {"paper's second sensor", {kLength_m, 0.0653}},
                        {"short piece in the middle", {kLength_m, 0.035, 0.033}},
                        {"just before the clamp", {kLength_m, 0.002}}};
  for (const int pieces : {12, 20, 30}) {
    Cuts equal{"equal pieces", {}};
    for (int i = 1; i <= pieces; ++i) equal.places_m.push_back(kLength_m * i / pieces);
    std::reverse(equal.places_m.begin(), equal.places_m.end());
    all.push_back(equal);
  }
  return all;
}

Vector3d tip(const Rod& rod, const TipLoad& load, const std::vector<double>& places_m, Accuracy accuracy) {
  return test::solve(rod, load, places_m, accuracy).points[0].T_base_local.p;
}

/// Against 256 pieces of order 8 each; the paper's catheters with k1,0 in 0 to 60 1/m, up to 0.4 N.
TEST(Pieces, KeepThePromisedAccuracy) {
  std::vector<double> fine{kLength_m};
  for (int i = 1; i < 256; ++i) fine.push_back(kLength_m * i / 256);
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> k1_per_m(0.0, 60.0);
  for (int i = 0; i < 400; ++i) {
    const Rod rod = test::paper_catheter(k1_per_m(random));
    const TipLoad load{.force_tip_N = test::uniform_in_ball(random, 0.4)};
    const Vector3d exact = tip(rod, load, fine, Accuracy::kReference);
    for (const Cuts& c : cuts()) {
      EXPECT_LT((tip(rod, load, c.places_m, Accuracy::kRealtime) - exact).norm(), 1e-6 * kLength_m) << c.name;
      EXPECT_LT((tip(rod, load, c.places_m, Accuracy::kReference) - exact).norm(), 1e-8 * kLength_m) << c.name;
    }
  }
}

}  // namespace
}  // namespace palpate
