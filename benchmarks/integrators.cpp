// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <benchmarks/integrator_methods.hpp>
#include <chrono>
#include <fstream>
#include <iostream>
#include <limits>
#include <palpate/plot/plot.hpp>
#include <palpate/rod/statics.hpp>

#include "tests/rod/rod_cases.hpp"

/// Work against error of several integrators on the 40 rods of reference/rod_statics.json (or, without them, on 40
/// seeded random rods against a fine solution), and the error of the step rule by its angle. Values only, no tangents.
///
///   integrators [folder [svg|png]]     CSV on stdout; in the folder integrators.csv, step_rule.csv and the picture
namespace palpate {
namespace {

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
      errors.reserve(cases.size());
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
