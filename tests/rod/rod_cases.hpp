// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <palpate/rod/statics.hpp>
#include <random>
#include <vector>

#include "tests/shared_data.hpp"

/// Rods that several tests and benchmarks use.
namespace palpate::test {

inline constexpr const char* kRodStatics = "reference/rod_statics.json";

/// One rod of reference/rod_statics.json: solutions made by two other programs that agree to 8e-13 of the length.
struct ReferenceRod {
  struct Station {
    double s_m;
    Pose T_base_local;
    Vector3d curvature_per_m;
  };
  Rod rod;
  TipLoad load;
  Vector3d force_base_N;
  std::vector<Station> stations;
};

inline double number(const nlohmann::json& j) { return j.get<double>(); }
inline Vector3d vector3(const nlohmann::json& j) { return {number(j.at(0)), number(j.at(1)), number(j.at(2))}; }

inline std::vector<ReferenceRod> reference_rods() {
  const nlohmann::json file = nlohmann::json::parse(std::ifstream(shared_data(kRodStatics)));
  std::vector<ReferenceRod> rods;
  for (const auto& c : file.at("cases")) {
    const double length_m = number(c.at("length_m"));
    const Stiffness K(number(c.at("bending_stiffness_1_Nm2")), number(c.at("bending_stiffness_2_Nm2")),
                      number(c.at("torsional_stiffness_Nm2")));
    ReferenceRod reference;
    reference.rod = uniform_rod(length_m, K, vector3(c.at("precurvature_1_per_m")));
    reference.load.force_tip_N = vector3(c.at("tip_force_tip_frame_N"));
    reference.load.moment_tip_Nm = vector3(c.at("tip_moment_tip_frame_Nm"));
    reference.force_base_N = vector3(c.at("tip_force_base_frame_N"));
    for (const auto& s : c.at("shape")) {
      const auto& q = s.at("quaternion_wxyz");
      const Eigen::Quaterniond rotation(number(q.at(0)), number(q.at(1)), number(q.at(2)), number(q.at(3)));
      reference.stations.push_back({std::min(number(s.at("s_m")), length_m),
                                    {rotation.normalized().toRotationMatrix(), vector3(s.at("position_m"))},
                                    vector3(s.at("curvature_1_per_m"))});
    }
    rods.push_back(std::move(reference));
  }
  return rods;
}

/// The paper's catheter (Table 2), with precurvature k1,0.
inline Rod paper_catheter(double k1_per_m) {
  return uniform_rod(0.07, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {k1_per_m, 0, 0});
}

inline Vector3d uniform_in_ball(std::mt19937_64& random, double radius) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit;
  const Vector3d v(normal(random), normal(random), normal(random));
  return radius * std::cbrt(unit(random)) * v.normalized();
}

inline RodSolution<0> solve(const Rod& rod, const TipLoad& load, std::vector<double> arc_lengths_m,
                            Accuracy accuracy = Accuracy::kReference) {
  const RodSolver solver(rod, arc_lengths_m, accuracy);
  RodSolution<0> solution = solver.make_solution<0>();
  solver.solve(load, solution);
  return solution;
}

}  // namespace palpate::test
