// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>
#include <palpate/plot/plot.hpp>
#include <palpate/rod/field.hpp>
#include <palpate/rod/runge_kutta.hpp>
#include <palpate/rod/statics.hpp>

#include "tests/rod/rod_cases.hpp"

/// Work against error of several integrators on the 40 rods of reference/rod_statics.json (or, without them, on 40
/// seeded random rods against a fine solution), and the error of the step rule by its angle. Values only, no tangents.
///
///   integrators [folder [svg|png]]     CSV on stdout; in the folder integrators.csv, step_rule.csv and the picture
namespace palpate {
namespace {

/// A rod of one section under a tip load, and where its tip is.
struct Case {
  double length_m = 0.0;
  Vector3d force_N, moment_Nm, compliance_per_Nm2, free_curvature_per_m;
  Vector3d tip_m = Vector3d::Zero();
};

/// Tip position by one integrator with so many equal steps.
using Solver = std::function<Vector3d(const Case&, int steps)>;

struct Method {
  std::string name;
  int stages;
  Solver solve;
};

// ---------------------------------------------------------------------------------------------------------------
// On the quaternion and the position; what palpate does is Runge-Kutta

rod_lanes::Vec<double> scaled(double factor, const Vector3d& v) {
  return {factor * v.x(), factor * v.y(), factor * v.z()};
}

constexpr int kRows = rod_lanes::kRows<false>;

/// `step(field, y)` in units of the step, from the tip to the clamp.
template <class Step>
Vector3d along_quaternion(const Case& c, int steps, const Step& step) {
  using namespace rod_lanes;
  const double h = c.length_m / steps;
  const Parameters<double> p{.force = scaled(h, c.force_N),
                             .moment = scaled(1.0, c.moment_Nm),
                             .compliance = scaled(h, c.compliance_per_Nm2),
                             .free_curvature = scaled(h, c.free_curvature_per_m),
                             .distributed = {},
                             .shear_compliance = {}};
  const auto field = [&p](double tau, const double* y, double* dy) { rate<false>(section<false>(tau, y, p), y, dy); };
  double y[rod_lanes::kRows<false>] = {1.0};
  for (int i = 0; i < steps; ++i) {
    step(field, y);
    normalise(y);
  }
  const Eigen::Quaterniond q(y[0], y[1], y[2], y[3]);
  return h * (q.conjugate() * Vector3d(y[4], y[5], y[6]));  // -R^T r
}

template <const auto& method>
Vector3d on_quaternion(const Case& c, int steps) {
  return along_quaternion(
      c, steps, [](const auto& field, double* y) { runge_kutta_step<method, kRows, 1>(0.0, 1.0, 1, y, field); });
}

/// Collocation in the points x of [-1, 1]: y' is the polynomial through the rates there. Its stages are found by so
/// many Picard iterations, from a constant rate.
template <int Points>
struct Collocation {
  Eigen::Matrix<double, Points, Points> A;  ///< a_ij, integral of the j-th Lagrange polynomial up to point i
  Eigen::Matrix<double, Points, 1> b;       ///< up to 1

  explicit Collocation(const std::array<double, Points>& x) {
    Eigen::Matrix<double, Points, Points> powers;
    Eigen::Matrix<double, Points + 1, Points> integrals;
    for (int i = 0; i <= Points; ++i)
      for (int k = 0; k < Points; ++k) {
        const double at = i < Points ? x[i] : 1.0;
        if (i < Points) powers(i, k) = std::pow(at, k);
        integrals(i, k) = 0.5 * (std::pow(at, k + 1) - std::pow(-1.0, k + 1)) / (k + 1);
      }
    const Eigen::Matrix<double, Points + 1, Points> all = integrals * powers.inverse();
    A = all.template topRows<Points>();
    b = all.row(Points).transpose();
  }

  Vector3d solve(const Case& c, int steps, int iterations) const {
    return along_quaternion(c, steps, [&](const auto& field, double* y) {
      using State = Eigen::Matrix<double, kRows, 1>;
      Eigen::Map<State> start(y);
      Eigen::Matrix<double, kRows, Points> rates, at = start.replicate<1, Points>();
      for (int i = 0; i < iterations; ++i) {
        for (int j = 0; j < Points; ++j) field(0.0, at.col(j).data(), rates.col(j).data());
        at = start.replicate<1, Points>() + rates * A.transpose();
      }
      start += rates * b;
    });
  }
};

constexpr int kGaussIterations = 8, kChebyshevPoints = 12, kChebyshevIterations = 12;

Vector3d gauss_6(const Case& c, int steps) {
  static const Collocation<3> method({-std::sqrt(0.6), 0.0, std::sqrt(0.6)});
  return method.solve(c, steps, kGaussIterations);
}

Vector3d chebyshev(const Case& c, int steps) {
  static const Collocation<kChebyshevPoints> method([] {
    std::array<double, kChebyshevPoints> x{};
    for (int i = 0; i < kChebyshevPoints; ++i) x[i] = -std::cos(std::numbers::pi * (i + 0.5) / kChebyshevPoints);
    return x;
  }());
  return method.solve(c, steps, kChebyshevIterations);
}

// ---------------------------------------------------------------------------------------------------------------
// Lie group methods on SE(3): T' = T hat(A(T)), A = -(u, e3); twists are (angular, linear)

using Twist = Eigen::Matrix<double, 6, 1>;

Pose exp_se3(const Twist& x) {
  const Vector3d w = x.head<3>(), v = x.tail<3>();
  const double a2 = w.squaredNorm(), a = std::sqrt(a2);
  const bool small = a < 1e-4;
  const double s = small ? 1.0 - a2 / 6.0 : std::sin(a) / a, c = small ? 0.5 - a2 / 24.0 : (1.0 - std::cos(a)) / a2,
               d = small ? 1.0 / 6.0 - a2 / 120.0 : (1.0 - s) / a2;
  const Vector3d wv = w.cross(v);
  const Matrix3d H = hat(w);
  return {Matrix3d::Identity() + s * H + c * H * H, v + c * wv + d * w.cross(wv)};
}

Twist bracket(const Twist& x, const Twist& y) {
  Twist z;
  z.head<3>() = x.head<3>().cross(y.head<3>());
  z.tail<3>() = x.head<3>().cross(y.tail<3>()) + x.tail<3>().cross(y.head<3>());
  return z;
}

Twist body_rate(const Case& c, const Pose& T) {
  Twist A;
  A << -(c.free_curvature_per_m +
         c.compliance_per_Nm2.cwiseProduct(T.R.transpose() * (c.moment_Nm - T.p.cross(c.force_N)))),
      -Vector3d::UnitZ();
  return A;
}

template <class Step>
Vector3d on_se3(const Case& c, int steps, const Step& step) {
  Pose T;
  for (int i = 0; i < steps; ++i) T = T * step(T, c.length_m / steps);
  return T.inverse().p;
}

/// Runge-Kutta-Munthe-Kaas: T = T0 exp(x), x' = dexp^-1(A) = A + [x,A]/2 + [x,[x,A]]/12 - ad^4/720 + ad^6/30240 - ...
template <const auto& method>
Vector3d munthe_kaas(const Case& c, int steps) {
  constexpr int stages = std::decay_t<decltype(method)>::stages;
  return on_se3(c, steps, [&c](const Pose& T0, double h) {
    const auto field = [&](double, const double* at, double* rate) {
      const Eigen::Map<const Twist> x(at);
      Eigen::Map<Twist> dx(rate);
      const Twist A = body_rate(c, T0 * exp_se3(x));
      const Twist xA = bracket(x, A), xxA = bracket(x, xA);
      dx = A + 0.5 * xA + xxA / 12.0;
      if constexpr (stages > 4) {
        const Twist ad4 = bracket(x, bracket(x, xxA));
        dx -= ad4 / 720.0;
        if constexpr (stages > 7) dx += bracket(x, bracket(x, ad4)) / 30240.0;
      }
    };
    Twist x = Twist::Zero();
    runge_kutta_step<method, 6, 1>(0.0, h, 1, x.data(), field);
    return exp_se3(x);
  });
}

/// Commutator-free method of order 4 in 4 stages and 5 exponentials (Celledoni, Marthinsen, Owren 2003).
Vector3d commutator_free_4(const Case& c, int steps) {
  return on_se3(c, steps, [&c](const Pose& T, double h) {
    const auto rate = [&](const Pose& at) -> Twist { return h * body_rate(c, at); };
    const Twist k1 = rate(T);
    const Pose half = exp_se3(0.5 * k1);
    const Twist k2 = rate(T * half), k3 = rate(T * exp_se3(0.5 * k2));
    const Twist k4 = rate(T * half * exp_se3(k3 - 0.5 * k1));
    return exp_se3((3.0 * k1 + 2.0 * k2 + 2.0 * k3 - k4) / 12.0) *
           exp_se3((-k1 + 2.0 * k2 + 2.0 * k3 + 3.0 * k4) / 12.0);
  });
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"Dormand-Prince 8", 12, on_quaternion<kDormandPrince8>},  // the chosen one: first, so drawn boldest
      {"Runge-Kutta 4", 4, on_quaternion<kRungeKutta4>},
      {"Butcher 6", 7, on_quaternion<kButcher6>},
      {"Cooper-Verner 8", 11, on_quaternion<kCooperVerner8>},
      {"CF4 on SE(3)", 4, commutator_free_4},
      {"RKMK 4 on SE(3)", 4, munthe_kaas<kRungeKutta4>},
      {"RKMK 6 on SE(3)", 7, munthe_kaas<kButcher6>},
      {"RKMK 8 on SE(3)", 12, munthe_kaas<kDormandPrince8>},
      {"Gauss 6 (Picard)", 3 * kGaussIterations, gauss_6},
      {"Chebyshev 12 (Picard)", kChebyshevPoints * kChebyshevIterations, chebyshev},
  };
  return all;
}

// ---------------------------------------------------------------------------------------------------------------
// Cases

Case make_case(const Rod& rod, const TipLoad& load) {
  const Section& section = rod.sections[0];
  const Vector3d compliance = section.stiffness_Nm2.cwiseInverse();
  Case c{rod.length_m(), load.force_tip_N, load.moment_tip_Nm + rod.contact_offset_m.cross(load.force_tip_N),
         compliance, section.precurvature_per_m + compliance.cwiseProduct(load.tendon_couple_Nm)};
  c.tip_m = on_quaternion<kDormandPrince8>(c, 400);
  return c;
}

TipLoad random_tip_force(std::mt19937_64& random) { return {.force_tip_N = test::uniform_in_ball(random, 0.4)}; }

std::vector<Case> paper_catheters(int count) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> k1_per_m(0.0, 60.0);
  std::vector<Case> cases;
  for (int i = 0; i < count; ++i) {
    const Rod rod = test::paper_catheter(k1_per_m(random));
    cases.push_back(make_case(rod, random_tip_force(random)));
  }
  return cases;
}

std::vector<Case> reference_cases() {
  if (!std::filesystem::exists(test::shared_data(test::kRodStatics))) {
    std::cerr << "reference rods absent: 40 random ones instead\n";
    return paper_catheters(40);
  }
  std::vector<Case> cases;
  for (const test::ReferenceRod& reference : test::reference_rods()) {
    cases.push_back(make_case(reference.rod, reference.load));
    cases.back().tip_m = reference.stations.back().T_base_local.p;
  }
  return cases;
}

// ---------------------------------------------------------------------------------------------------------------
// Measuring

struct Row {
  std::string method;
  int steps, evaluations;
  double median_error, worst_error, microseconds;
};

double error_of(const Case& c, const Vector3d& tip_m) { return (tip_m - c.tip_m).norm() / c.length_m; }

double microseconds_each(const std::vector<Case>& cases, const Method& method, int steps) {
  double best = 1e9;
  [[maybe_unused]] volatile double sink = 0.0;  // keeps the compiler from dropping the work
  for (int repeat = 0; repeat < 7; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (const Case& c : cases) sink = method.solve(c, steps).x();
    const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count() / static_cast<double>(cases.size()));
  }
  return best;
}

std::vector<Row> measure(const std::vector<Case>& cases) {
  constexpr int kMostEvaluations = 1200;
  std::vector<Row> rows;
  for (const Method& method : methods())
    for (const int steps :
         {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 64, 80, 96, 128, 160, 192, 256, 300}) {
      if (steps * method.stages > kMostEvaluations) continue;
      std::vector<double> errors;
      for (const Case& c : cases) errors.push_back(error_of(c, method.solve(c, steps)));
      std::sort(errors.begin(), errors.end());
      rows.push_back({method.name, steps, steps * method.stages, errors[errors.size() / 2], errors.back(),
                      microseconds_each(cases, method, steps)});
    }
  return rows;
}

std::string work_table(const std::vector<Row>& rows) {
  std::string csv = "method,steps,evaluations,median_error_per_length,worst_error_per_length,microseconds\n";
  for (const Row& r : rows)
    csv += fmt::format("{},{},{},{:.3e},{:.3e},{:.3f}\n", r.method, r.steps, r.evaluations, r.median_error,
                       r.worst_error, r.microseconds);
  return csv;
}

/// The rule of RodSolver: steps = ceil(L |u|_max / angle).
int steps_by_rule(const Case& c, double angle) {
  const double compliance = c.compliance_per_Nm2.maxCoeff();
  const double bound =
      c.free_curvature_per_m.norm() + compliance * c.moment_Nm.norm() + 2.0 * std::sqrt(compliance * c.force_N.norm());
  return std::max(1, static_cast<int>(std::ceil(c.length_m * bound / angle)));
}

std::string step_rule_table(const std::vector<Case>& reference, const std::vector<Case>& catheters) {
  std::string csv =
      "angle_rad,mean_steps_catheter,median_error_catheter,worst_error_catheter,mean_steps_reference,worst_error_"
      "reference\n";
  for (const double angle : {2.0, 1.6, 1.4, 1.3, 1.25, 1.2, 1.1, 1.0, 0.9, 0.8, 0.7, 0.65, 0.6, 0.5}) {
    const auto run = [angle](const std::vector<Case>& cases) {
      double steps = 0.0;
      std::vector<double> errors;
      for (const Case& c : cases) {
        const int n = steps_by_rule(c, angle);
        steps += n;
        errors.push_back(error_of(c, on_quaternion<kDormandPrince8>(c, n)));
      }
      std::sort(errors.begin(), errors.end());
      return std::tuple(steps / static_cast<double>(cases.size()), errors[errors.size() / 2], errors.back());
    };
    const auto [steps, median, worst] = run(catheters);
    const auto [reference_steps, reference_median, reference_worst] = run(reference);
    csv += fmt::format("{},{:.2f},{:.2e},{:.2e},{:.2f},{:.2e}\n", angle, steps, median, worst, reference_steps,
                       reference_worst);
  }
  return csv;
}

/// An error beyond the length says nothing: a gap in the picture.
double shown(double error) { return error < 1.0 ? error : std::numeric_limits<double>::quiet_NaN(); }

plot::Figure picture(const std::vector<Row>& rows) {
  plot::Figure figure{
      .title = "Tip position of 40 rods: error against work", .panels = {}, .width_px = 900, .height_px = 1300};
  const auto panel = [&](const char* title, const char* x_label, const char* y_label, const auto& x, const auto& y) {
    plot::Panel p{.title = title, .x_label = x_label, .y_label = y_label, .log_x = true, .log_y = true};
    for (const Method& method : methods()) {
      plot::Series series{.label = method.name};
      for (const Row& row : rows)
        if (row.method == method.name) series.x.push_back(x(row)), series.y.push_back(y(row));
      p.series.push_back(series);
    }
    figure.panels.push_back(p);
  };
  const auto evaluations = [](const Row& r) { return static_cast<double>(r.evaluations); };
  panel("worst", "field evaluations", "error / length", evaluations, [](const Row& r) { return shown(r.worst_error); });
  panel("median", "field evaluations", "error / length", evaluations,
        [](const Row& r) { return shown(r.median_error); });
  panel(
      "worst, by time", "time of one solution [us]", "error / length", [](const Row& r) { return r.microseconds; },
      [](const Row& r) { return shown(r.worst_error); });
  return figure;
}

int run(int argc, char** argv) {
  const std::vector<Case> reference = reference_cases();
  const std::vector<Row> rows = measure(reference);
  const std::string work = work_table(rows), rule = step_rule_table(reference, paper_catheters(20000));
  std::cout << work << '\n' << rule;
  if (argc > 1) {
    const std::filesystem::path folder = argv[1];
    std::ofstream(folder / "integrators.csv") << work;
    std::ofstream(folder / "step_rule.csv") << rule;
    plot::write_figure(picture(rows), folder / (std::string("integrators.") + (argc > 2 ? argv[2] : "svg")));
  }
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
