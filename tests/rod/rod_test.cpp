// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/math/errors.hpp>
#include <palpate/rod/rod.hpp>
#include <string>

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Rod two_sections() {
  Rod rod = uniform_rod(0.07, {2.612e-4, 1.6664e-4, 1.645e-4}, {39.99, 0.0, 0.0});
  rod.sections[0].to_m = 0.04;
  rod.sections.push_back(rod.sections[0]);
  rod.sections[1].from_m = 0.04;
  rod.sections[1].to_m = 0.07;
  return rod;
}

std::string error_of(const Rod& rod) {
  try {
    rod.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Rod, TorsionFollowsThePaper) {
  // Section 3.1.2: GJ = (EI1 + EI2) / (2 (1 + nu)); Table 2 gives 0.1645e-3 for nu = 0.3.
  EXPECT_NEAR(torsional_stiffness_Nm2(0.2612e-3, 0.16664e-3, 0.3), 0.1645e-3, 1e-7);
}

TEST(Rod, RoundShaft) {
  const Stiffness K = round_shaft_stiffness(2e9, 2e-3, 0.25);
  EXPECT_NEAR(K.x(), 2e9 * std::numbers::pi * 16e-12 / 64.0, 1e-15);
  EXPECT_EQ(K.x(), K.y());
  EXPECT_NEAR(K.z(), K.x() / 1.25, 1e-15);
}

TEST(Rod, UniformRodIsValid) {
  const Rod rod = uniform_rod(0.07, {1e-4, 1e-4, 1e-4}, {20.0, 0.0, 0.0});
  EXPECT_EQ(error_of(rod), "no error");
  EXPECT_EQ(rod.length_m(), 0.07);
  EXPECT_FALSE(rod.shears());
  EXPECT_EQ(error_of(two_sections()), "no error");
}

TEST(Rod, ValidateNamesSectionAndValue) {
  EXPECT_EQ(error_of(Rod{}), "rod: sections = []: expected at least one section");
  Rod rod = two_sections();
  rod.sections[1].from_m = 0.05;
  EXPECT_EQ(error_of(rod), "rod: sections[1].from_m = 0.05: expected 0.04, where the section before ends");
  rod = two_sections();
  rod.sections[1].to_m = kNaN;
  EXPECT_EQ(error_of(rod), "rod: sections[1].to_m = nan: expected more than from_m, 0.04");
  rod = two_sections();
  rod.sections[0].stiffness_Nm2.y() = -1.0;
  EXPECT_EQ(
      error_of(rod),
      "rod: sections[0].stiffness_Nm2 = [0.0002612, -1, 0.0001645]: expected three positive numbers (EI1, EI2, GJ)");
  rod.sections[0].rigid = true;
  EXPECT_EQ(error_of(rod), "no error");
  rod.sections[0].precurvature_per_m.x() = kNaN;
  EXPECT_EQ(error_of(rod),
            "rod: sections[0].precurvature_per_m = [nan, 0, 0]: expected three finite numbers (k1, k2, tau)");
}

TEST(Rod, ValidateNamesWholeRodValues) {
  Rod rod = two_sections();
  rod.rigid_tip_m = -0.001;
  EXPECT_EQ(error_of(rod), "rod: rigid_tip_m = -0.001: expected 0 or more");
  rod = two_sections();
  rod.contact_offset_m.z() = kNaN;
  EXPECT_EQ(error_of(rod), "rod: contact_offset_m = [0, 0, nan]: expected three finite numbers");
  rod = two_sections();
  rod.shear_stiffness_N = 10.0;
  EXPECT_EQ(error_of(rod),
            "rod: shear_stiffness_N, axial_stiffness_N = 10, 0: expected both positive, or both 0 for no shear and no "
            "stretch");
  rod.axial_stiffness_N = 20.0;
  EXPECT_EQ(error_of(rod), "no error");
  rod.distributed_load_base_N_per_m.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of(rod), "rod: distributed_load_base_N_per_m = [inf, 0, 0]: expected three finite numbers");
}

}  // namespace
}  // namespace palpate
