// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/rod/statics.hpp>

/// A rod whose equilibrium may still be violated: curve and tip force are unknown together. Shooting from the tip
/// multiplies an error of the force along a coiled shaft, so its cost has many local minima; with the curvature free
/// the pose of the tip depends on it mildly, and the equilibrium is drawn in little by little (multiple shooting's
/// idea).
///
///   u(x) = u0 + K^-1 (m_t + M + c x F) + sum_b c_b x^b / L,   b = 1..3,  x = sigma / L = (L - s) / L
///
/// with u0 and K as the load changes them (TipLoad::log_stiffness, precurvature_per_m);
/// exact at the tip, where the moment is known. The equilibrium asks for no defect, with mu as in field.hpp:
///
///   e(x) = u - u0 - K^-1 (m_t + R^T mu) = 0
///
/// Coarse on purpose (midpoint rule, a dozen cells, each of one section; no shear, no stretch): what comes out is a
/// start, not an answer.
namespace palpate {

class RelaxedRod {
 public:
  static constexpr int kCells = 12, kPowers = 3, kUnknowns = 3 * kPowers + 3;

  /// c_1, c_2, c_3 [rad], each about d1, d2, d3; then F, the tip force in tip components [N].
  using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

  /// Caller-owned; reused without allocation.
  struct Shape {
    RodSolution<kUnknowns> curve;                                    ///< poses at the stations with their tangents
    Eigen::Matrix<double, 3 * kCells, 1> defect;                     ///< e L / sqrt(cells) [rad]
    Eigen::Matrix<double, 3 * kCells, kUnknowns> defect_by_unknown;  ///< how the weight's lever moves left out
  };

  /// Stations as in RodSolver: arc lengths in [0, length + rigid tip].
  RelaxedRod(const Rod& rod, std::span<const double> arc_lengths_m);

  Shape make_shape() const;

  /// Curve and defect at `z`. `load`: all but the tip force; its distributed part is the own weight in tip components.
  /// One integration; no allocation, no exception.
  void evaluate(const TipLoad& load, const Unknowns& z, Shape& shape) const;

  /// The unknowns that come nearest to the equilibrium under `load`, its tip force included, and the poses at the
  /// stations there. One coarse integration; the tangents of `shape` are zero then, its defect is left as it was.
  Unknowns start(const TipLoad& load, Shape& shape) const;

  /// What a column buckles at, pi^2 EI / (4 L^2) with the mean EI described [N]: the scale on which shapes change.
  double buckling_force_N() const { return buckling_force_N_; }
  double length_m() const { return length_m_; }

 private:
  static constexpr int kForce = 3 * kPowers;  ///< first column of F
  /// What a cell and the load make of K^-1 (diagonal) and of u0 + K^-1 m_t.
  struct Bending {
    Vector3d compliance, free_curvature;
  };
  struct Cell {
    Vector3d compliance = Vector3d::Zero();  ///< diagonal of K^-1; zero in a rigid section
    Vector3d precurvature = Vector3d::Zero();
    Eigen::Matrix<double, kPowers, 1> powers = Eigen::Matrix<double, kPowers, 1>::Zero();  ///< x^b / L; zero if rigid
    bool rigid = false;
    Bending under(const TipLoad& load, const Vector3d& factor) const;  ///< compliance_factor(load)
  };
  struct Station {
    int cell = 0;
    double into_m = 0.0;        ///< from the cell's distal end
    double beyond_tip_m = 0.0;  ///< on the rigid tip
  };
  struct March;

  Vector3d moment_at(const TipLoad& load, const Vector3d& force, double sigma, const March& at) const;
  void record_cell(int cell, const March& from, const Vector3d& u, const Eigen::Matrix<double, 3, kUnknowns>& d_u,
                   RodSolution<kUnknowns>& curve) const;
  static void to_base_frame(const March& clamp, RodSolution<kUnknowns>& curve);

  std::array<Cell, kCells> cells_;
  std::vector<Station> stations_;
  Eigen::Matrix<double, kPowers, kCells> projection_;  ///< node values to coefficients, least squares
  Vector3d contact_offset_m_;
  double length_m_ = 0.0, cell_m_ = 0.0, buckling_force_N_ = 0.0;
};

}  // namespace palpate
