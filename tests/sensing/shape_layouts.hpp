// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>
#include <palpate/sensing/shape_model.hpp>
#include <tests/rod/tangent_columns.hpp>
#include <tests/sensing/virtual_setups.hpp>

/// Every layout of a state x = (f, p_rod), and what the layout means for the rod: said here by hand.
namespace palpate::test {

inline constexpr unsigned kAllSensors = 0xff;
inline const Eigen::Vector2d kTendonReading_Nm{1.5e-3, -0.8e-3};

struct Layout {
  const char* name;
  std::function<Catheter()> make;
  ParameterChoice choice;
  MeasurementKind kind = MeasurementKind::kPoses;

  friend void PrintTo(const Layout& layout, std::ostream* out) { *out << layout.name; }
};

inline Catheter with_stiffness(Catheter catheter) {
  catheter.stiffness_sigma_fraction = 0.05;
  return catheter;
}

inline Catheter with_precurvature(Catheter catheter) {
  catheter.precurvature_sigma_per_m = {0.6, 0.5, 0.4};
  return catheter;
}

inline Catheter with_tendon(TendonModel model, Catheter catheter) {
  catheter.tendon = {.present = true, .model = model, .offset_m = 1e-3, .moment_sigma_fraction = 0.1};
  return catheter;
}

inline Catheter with_all(TendonModel model, Catheter catheter) {
  return with_stiffness(with_precurvature(with_tendon(model, std::move(catheter))));
}

/// Sections of unequal stiffness, a rigid joint among them and at the clamp, a rigid tip, the force off its axis.
inline Catheter jointed() {
  Catheter catheter = mixed_sensors();
  std::vector<Section>& sections = (catheter.rod = jointed_rod()).sections;
  sections.front().from_m = 0.004;
  sections.insert(sections.begin(), {0.0, 0.004, Stiffness::Zero(), {10.0, 0.0, 0.0}, true});
  return catheter;
}

inline const Layout kLayouts[] = {
    {"force_only", [] { return mixed_sensors(); }, {}},
    {"stiffness_tied", [] { return with_stiffness(mixed_sensors()); }, {.consider = true}},
    {"stiffness_free", [] { return with_stiffness(mixed_sensors()); }, {.consider = true, .free_torsion = true}},
    {"stiffness_estimated", [] { return mixed_sensors(); }, {.estimate_stiffness = true}},
    {"precurvature", [] { return with_precurvature(mixed_sensors()); }, {.consider = true}},
    {"tendon_noise", [] { return with_tendon(TendonModel::kCouple, mixed_sensors()); }, {}},
    {"tendon_couple", [] { return with_tendon(TendonModel::kCouple, mixed_sensors()); }, {.consider = true}},
    {"end_moment", [] { return with_tendon(TendonModel::kEndMoment, mixed_sensors()); }, {.consider = true}},
    {"all_tied", [] { return with_all(TendonModel::kCouple, mixed_sensors()); }, {.consider = true}},
    {"all_free",
     [] { return with_all(TendonModel::kEndMoment, mixed_sensors()); },
     {.consider = true, .free_torsion = true}},
    {"all_own_weight",
     [] { return with_own_weight(with_all(TendonModel::kCouple, mixed_sensors())); },
     {.consider = true, .free_torsion = true}},
    {"all_jointed", [] { return with_all(TendonModel::kCouple, jointed()); }, {.consider = true}},
    {"all_curvature",
     [] { return with_all(TendonModel::kCouple, mounted(two_sensors())); },
     {.consider = true, .free_torsion = true},
     MeasurementKind::kTipAndCurvature},
    {"all_curvature_own_weight",
     [] { return with_own_weight(with_all(TendonModel::kEndMoment, two_sensors())); },
     {.consider = true},
     MeasurementKind::kTipAndCurvature},
};

inline double typical(ParameterKind kind) {
  if (kind == ParameterKind::kPrecurvature) return 5.0;
  return kind == ParameterKind::kTendonMoment ? 3e-4 : 0.3;
}

/// What matters alike: 0.1 N, a stiffness off by a third, and so on.
inline StateVector typical_state(const UncertainParameters& parameters) {
  StateVector x = StateVector::Constant(3 + parameters.rod_count, 0.1);
  for (int i = 0; i < parameters.rod_count; ++i) x(3 + i) = typical(parameters.all[static_cast<std::size_t>(i)].kind);
  return x;
}

inline StateVector drawn_state(const UncertainParameters& parameters, Draws& draws) {
  StateVector x = typical_state(parameters);
  for (int i = 3; i < x.size(); ++i) x(i) *= draws.uniform(-1.0, 1.0);
  x.head<3>() = draws.in_ball(0.12);
  return x;
}

inline double value_of(const UncertainParameters& parameters, const StateVector& x, ParameterKind kind, int axis) {
  const int i = parameters.find(kind, axis);
  return i < 0 ? 0.0 : x(3 + i);
}

/// A catheter that is what x says `stated` is, and what loads it.
struct Reality {
  Catheter catheter;
  TipLoad load;
};

inline Reality reality_of(const Catheter& stated, const UncertainParameters& parameters, const StateVector& x) {
  using Kind = ParameterKind;
  const auto value = [&](Kind kind, int axis) { return value_of(parameters, x, kind, axis); };
  Vector3d stiffer, bent;
  for (int axis = 0; axis < 3; ++axis) {
    stiffer(axis) = std::exp(value(Kind::kLogStiffness, axis));
    bent(axis) = value(Kind::kPrecurvature, axis);
  }
  const std::vector<Section>& sections = stated.rod.sections;
  const Stiffness& K = sections[sections.front().rigid ? 1 : 0].stiffness_Nm2;
  if (parameters.torsion_tied) stiffer.z() = (stiffer.x() * K.x() + stiffer.y() * K.y()) / (K.x() + K.y());
  Reality real{stated, {}};
  real.catheter.rod = changed_rod(stated.rod, stiffer.array().log(), bent);
  real.load.force_tip_N = {stiffer.y() * x(0), stiffer.x() * x(1), stiffer.x() * x(2)};
  if (!stated.tendon.present) return real;
  const Eigen::Vector2d noise(value(Kind::kTendonMoment, 0), value(Kind::kTendonMoment, 1));
  Vector3d moment_Nm = Vector3d::Zero();
  moment_Nm.head<2>() = std::exp(value(Kind::kTendonScale, 0)) * (kTendonReading_Nm + noise);
  (stated.tendon.model == TendonModel::kCouple ? real.load.tendon_couple_Nm : real.load.moment_tip_Nm) = moment_Nm;
  return real;
}

/// Fourth-order central differences of the residual, h = 1 % of what is typical, against the Jacobian; both by
/// parameters in typical units, row by row. h^4 leaves 1e-9; a step of the integrator more or less on one side of x
/// (1e-8 of the length) dominates.
inline void expect_jacobian_is_difference(ShapeModel& model, const StateVector& x, const StateVector& unit,
                                          double allowed) {
  const auto residual = [&](const StateVector& at) {
    Linearization l;
    EXPECT_TRUE(model.linearize(at, l));
    return l.residual;
  };
  Linearization here;
  ASSERT_TRUE(model.linearize(x, here));
  const Eigen::MatrixXd J = here.jacobian * unit.asDiagonal();
  Eigen::MatrixXd slopes(J.rows(), J.cols());
  constexpr double h = 0.01;
  for (int j = 0; j < x.size(); ++j) {
    const StateVector step = h * unit(j) * StateVector::Unit(x.size(), j);
    slopes.col(j) =
        (8.0 * (residual(x + step) - residual(x - step)) - (residual(x + 2.0 * step) - residual(x - 2.0 * step))) /
        (12.0 * h);
  }
  for (int i = 0; i < J.rows(); ++i)
    for (int j = 0; j < J.cols(); ++j)
      EXPECT_NEAR(-slopes(i, j), J(i, j), allowed * J.row(i).cwiseAbs().maxCoeff()) << "row " << i << ", column " << j;
}

/// The shape model of a layout, ready to be shown a frame.
class ShapeModelOfLayout : public ::testing::TestWithParam<Layout> {
 protected:
  ShapeModelOfLayout() {
    if (catheter_.tendon.present) model_.set_tendon_moment(kTendonReading_Nm);
  }
  void show(const TrackerFrame& frame) {
    register_frame(catheter_, frame, measurement_);
    model_.select(measurement_, kAllSensors);
  }
  Linearization at(const StateVector& x) {
    Linearization out;
    EXPECT_TRUE(model_.linearize(x, out));
    return out;
  }

  Catheter catheter_ = GetParam().make();
  UncertainParameters parameters_ = uncertain_parameters(catheter_, GetParam().choice);
  ShapeModel model_{catheter_, GetParam().kind, parameters_, Accuracy::kReference};
  Measurement measurement_;
};

}  // namespace palpate::test
