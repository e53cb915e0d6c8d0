// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/identification/stiffness_steps.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::stiffness {

namespace {

using Unknowns = StiffnessOptions::Unknowns;

void check_shaft(const Catheter& catheter, const StiffnessOptions& options) {
  const Rod& rod = catheter.rod;
  rod.validate();
  const double length = rod.length_m();
  if (!(length >= 1e-3 && length <= 10.0))
    throw InputError(
        fmt::format("catheter: length {} m: expected a shaft of 1 mm to 10 m; is the unit right?", length));
  if (std::all_of(rod.sections.begin(), rod.sections.end(), [](const Section& section) { return section.rigid; }))
    throw InputError("catheter: every section is rigid: expected one that bends");
  if (options.free_shear && !rod.shears())
    throw InputError(
        "shear stiffness free: expected a catheter that shears (shear_stiffness_N and axial_stiffness_N above 0)");
  if (options.poisson_ratio && !(*options.poisson_ratio > -1.0 && *options.poisson_ratio <= 0.5))
    throw InputError(fmt::format("Poisson's ratio {}: expected more than -1 and at most 0.5", *options.poisson_ratio));
  if (options.poisson_ratio && options.unknowns != Unknowns::kBending)
    throw InputError("Poisson's ratio: of use only where EI1 and EI2 are identified and GJ follows them");
}

/// A chord is no longer than its arc; half as much again, and what the clamp and the point are unsure of, is allowed.
void check_distance(const Catheter& catheter, const ShapePoint& point, const std::string& where) {
  const double reach = catheter.rod.length_m() + catheter.rod.rigid_tip_m;
  const bool known = !std::isnan(point.arc_length_m);
  const double arc = (known ? point.arc_length_m : reach) + point.T_local_sensor.p.norm();
  const Vector3d p = point.position_base_m.array().isNaN().select(0.0, point.position_base_m);
  const double clamp = 5.0 * (catheter.base.position_sigma_m + reach * catheter.base.rotation_sigma_rad);
  if (p.norm() > 1.5 * arc + 0.05 * reach + clamp + 10.0 * point.sigma_m.norm())
    throw InputError(
        fmt::format("{}: {:.6g} m from the clamp: expected at most its arc length, {:.6g} m; is the unit "
                    "right, and is it in the base frame?",
                    where, p.norm(), arc));
}

/// Along a shaft the chord from the clamp is a good part of the arc.
void check_chords(std::span<const LoadCase> cases) {
  double chords_m = 0.0, arcs_m = 0.0;
  for (const LoadCase& one : cases)
    for (const ShapePoint& point : one.points) {
      if (std::isnan(point.arc_length_m) || !point.position_base_m.allFinite()) continue;
      chords_m += point.position_base_m.norm();
      arcs_m += point.arc_length_m;
    }
  if (chords_m < 0.02 * arcs_m)
    throw InputError(
        fmt::format("the points are {:.3g} m from the clamp in all, and {:.3g} m along the shaft: expected distances "
                    "that fit the arc lengths (are the positions in metres?)",
                    chords_m, arcs_m));
}

void check_point(const Catheter& catheter, const ShapePoint& point, const std::string& where,
                 const StiffnessOptions& options) {
  const double reach = catheter.rod.length_m() + catheter.rod.rigid_tip_m, s = point.arc_length_m;
  if (!std::isnan(s) && !(s >= 0.0 && s <= reach * (1.0 + 1e-9)))
    throw InputError(fmt::format("{}: arc length {} m: expected a place on the shaft, 0 to {} m", where, s, reach));
  if (std::isnan(s) && std::isnan(point.position_base_m.z()))
    throw InputError(fmt::format("{}: neither arc length nor z: expected one of them", where));
  if (std::isnan(s) && !point.T_local_sensor.p.isZero(0.0))
    throw InputError(fmt::format("{}: no arc length: expected one for a sensor beside the centre line", where));
  if (point.position_base_m.array().isInf().any())
    throw InputError(fmt::format("{}: infinite position: expected finite numbers", where));
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = point.sigma_m(axis);
    const bool needed = !point.sigma_m.isZero(0.0) && !std::isnan(point.position_base_m(axis));
    if (!(sigma >= 0.0) || (needed && !(sigma > 0.0 && std::isfinite(sigma))))
      throw InputError(fmt::format("{}: sigma {} m: expected a positive number, or 0 along all axes", where, sigma));
  }
  if (point.R_base_sensor && !(point.sigma_rad > 0.0 && !point.sigma_m.isZero(0.0)))
    throw InputError(fmt::format("{}: orientation measured: expected sigmas of position and orientation", where));
  if (point.R_base_sensor && std::isnan(point.arc_length_m))
    throw InputError(fmt::format("{}: orientation measured: expected its arc length", where));
  if (point.R_base_sensor && options.own_weight == StiffnessOptions::OwnWeight::kSubtracted &&
      catheter.rod.has_distributed_load())
    throw InputError(fmt::format("{}: own weight subtracted: expected points, not orientations", where));
  check_distance(catheter, point, where);
}

/// All or none; throws where some have one.
bool with_sigma(std::span<const LoadCase> cases) {
  int with = 0, without = 0;
  for (const LoadCase& one : cases)
    for (const ShapePoint& point : one.points) ++(point.sigma_m.isZero(0.0) ? without : with);
  if (with > 0 && without > 0)
    throw InputError(fmt::format("sigma stated for {} points and not for {}: expected all or none", with, without));
  return with > 0;
}

}  // namespace

void check_input(const Catheter& catheter, std::span<const LoadCase> cases, const StiffnessOptions& options) {
  check_shaft(catheter, options);
  int measured = 0;
  bool loaded = false;
  for (const LoadCase& one : cases) {
    if (!one.force_base_N.allFinite())
      throw InputError(fmt::format("load case {}: force not finite: expected newtons", one.name));
    loaded = loaded || !one.force_base_N.isZero(0.0);
    for (std::size_t i = 0; i < one.points.size(); ++i) {
      check_point(catheter, one.points[i], fmt::format("load case {}, point {}", one.name, i + 1), options);
      measured += rows_of(one.points[i]);
    }
  }
  check_chords(cases);
  const bool hangs =
      options.own_weight == StiffnessOptions::OwnWeight::kIncluded && catheter.rod.has_distributed_load();
  if (!loaded && !hangs)
    throw InputError("no load case has a load: stiffness shows only under a known load; expected one or more");
  const stiffness::Unknowns unknowns(catheter, options);
  const int wanted = unknowns.free_stiffnesses();
  if (measured < wanted + (with_sigma(cases) ? 0 : 1))
    throw InputError(fmt::format("{} measured components for {} unknown stiffnesses: expected more", measured, wanted));
}

}  // namespace palpate::stiffness
