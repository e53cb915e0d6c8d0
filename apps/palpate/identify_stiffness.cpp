// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>

#include "file_paths.hpp"
#include "identify_stiffness_input.hpp"
#include "identify_stiffness_picture.hpp"
#include "identify_stiffness_report.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

/// The command line, as typed; empty: not given.
struct StiffnessCommand {
  std::string catheter, cases, out, unknowns, method, plot;
  std::optional<double> poisson_ratio;
  bool free_shear = false, json = false;
};

template <class Enum, std::size_t Size>
Enum chosen(std::string_view flag, const std::string& value,
            const std::array<std::pair<std::string_view, Enum>, Size>& known) {
  if (value.empty()) return known[0].second;
  std::string names;
  for (const auto& [name, meaning] : known) {
    if (value == name) return meaning;
    names += fmt::format("{}{}", names.empty() ? "" : " or ", name);
  }
  throw InputError(fmt::format("{} {}: expected {}", flag, printable(value), names));
}

StiffnessOptions parse_options(const StiffnessCommand& command) {
  using Unknowns = StiffnessOptions::Unknowns;
  using Method = StiffnessOptions::Method;
  StiffnessOptions options;
  options.unknowns = chosen<Unknowns, 3>("--unknowns", command.unknowns,
                                         {{{"bending", Unknowns::kBending},
                                           {"scale", Unknowns::kScale},
                                           {"bending,torsion", Unknowns::kBendingAndTorsion}}});
  options.method = chosen<Method, 2>("--method", command.method,
                                     {{{"lm", Method::kLevenbergMarquardt}, {"nelder-mead", Method::kNelderMead}}});
  options.poisson_ratio = command.poisson_ratio;
  options.free_shear = command.free_shear;
  if (!command.poisson_ratio) return options;
  if (options.unknowns != Unknowns::kBending)
    throw InputError(fmt::format("--poisson {}: expected with --unknowns bending, where it ties GJ to EI1 and EI2",
                                 *command.poisson_ratio));
  if (!(*command.poisson_ratio > -1.0 && *command.poisson_ratio <= 0.5))
    throw InputError(fmt::format("--poisson {}: expected Poisson's ratio, -0.99 to 0.5", *command.poisson_ratio));
  return options;
}

void check_shear(const StiffnessOptions& options, const Catheter& catheter, const std::string& path) {
  if (!options.free_shear || catheter.rod.shears()) return;
  throw InputError(
      fmt::format("--free-shear: expected shear_stiffness_N and axial_stiffness_N in {} to start from", path));
}

/// Fewer loads than unknowns may still do, but rarely.
void warn_of_few_loads(StiffnessReport& report) {
  std::size_t loaded = 0;
  for (const LoadCase& load : report.load_cases) loaded += load.force_base_N.isZero(0.0) ? 0 : 1;
  if (loaded >= report.fit.unknowns.size()) return;
  report.warnings.push_back(fmt::format("{}: {} case{} with a load for {} unknowns: are there loads across both axes?",
                                        report.cases, loaded, loaded == 1 ? "" : "s", report.fit.unknowns.size()));
}

void refuse_to_overwrite_measurements(const StiffnessCommand& command, const LoadCaseFile& cases) {
  std::vector<InputPath> measured;
  for (const auto& one : cases.cases) {
    const std::string path = (one.recorded() ? one.recording : one.points_file).string();
    measured.push_back({command.cases, path, path});
  }
  check_paths(measured, {{"--out", command.out}, {"--plot", command.plot}});
}

/// Loads in grams or points in metres make a stiffness as wrong as that.
void warn_of_large_change(const Catheter& stated, StiffnessReport& report) {
  constexpr double kLarge = 100.0;
  const double ratio = report.fit.rod.sections.front().stiffness_Nm2.head<2>().sum() /
                       stated.rod.sections.front().stiffness_Nm2.head<2>().sum();
  if (std::abs(std::log(ratio)) < std::log(kLarge)) return;
  report.warnings.push_back(
      fmt::format("{}: the stiffness is {:.3g} times that of {}: are the forces in N, the places in mm?", report.cases,
                  ratio, report.catheter));
}

/// A check that the cases do not allow is none that failed.
void leave_out(const StiffnessInput& input, StiffnessReport& report) {
  if (input.cases.size() < 2) return;
  try {
    report.left_out = leave_one_out(input.catheter, input.cases, report.options);
  } catch (const InputError& error) {
    report.warnings.push_back(fmt::format("{}: no case can be left out as a check: {}", report.cases, error.what()));
  }
}

int run(const StiffnessCommand& command) {
  StiffnessReport report;
  report.catheter = command.catheter;
  report.cases = command.cases;
  report.out = command.out;
  report.options = parse_options(command);
  check_paths({{"--catheter", "the catheter file", command.catheter}, {"--cases", "the cases file", command.cases}},
              {{"--out", command.out}, {"--plot", command.plot}});
  const CatheterFile file = read_catheter_file(command.catheter);
  check_shear(report.options, file.catheter, command.catheter);
  const LoadCaseFile cases = read_load_cases(command.cases, file.catheter);
  if (cases.own_weight_subtracted) report.options.own_weight = StiffnessOptions::OwnWeight::kSubtracted;
  refuse_to_overwrite_measurements(command, cases);
  const StiffnessInput input = load_stiffness_input(file, cases);
  report.load_cases = input.cases;
  try {
    report.fit = identify_stiffness(input.catheter, input.cases, report.options);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", command.cases, error.what()));
  }
  report.warnings = input.warnings;
  report.warnings.insert(report.warnings.end(), report.fit.warnings.begin(), report.fit.warnings.end());
  warn_of_few_loads(report);
  warn_of_large_change(file.catheter, report);
  leave_out(input, report);
  print_warnings(report.warnings);
  if (!report.fit.converged) {
    fmt::print(stderr, "palpate: {}: the fit did not converge in {} iterations: nothing was written\n", command.cases,
               report.fit.iterations);
    return 1;
  }
  report.sigma = common_sigma(report.fit, report.options.unknowns, file.catheter);
  const TomlEdit edit = with_identified_stiffness(command.catheter, file.catheter, report.fit, report.options.unknowns);
  write_catheter_file(edit, command.out, [&] {
    if (!command.plot.empty()) plot::write_figure(stiffness_figure(report, file.catheter), command.plot);
  });
  command.json ? print_json(report) : print_text(report);
  return 0;
}

}  // namespace

void add_identify_stiffness(CLI::App& identify, int& exit_code) {
  auto command = std::make_shared<StiffnessCommand>();
  CLI::App* verb = identify.add_subcommand("stiffness", "Stiffness from the shape under known loads");
  verb->add_option("--catheter", command->catheter, "Catheter file to start from (TOML)")
      ->type_name("FILE")
      ->required();
  verb->add_option("--cases", command->cases, "Load cases: known loads and where the shaft was (TOML)")
      ->type_name("FILE")
      ->required();
  verb->add_option("--out", command->out, "The catheter file with the stiffness found (TOML)")
      ->type_name("FILE")
      ->required();
  verb->add_option("--unknowns", command->unknowns, "bending: EI1 and EI2; scale: one factor for all")
      ->type_name("bending|scale|bending,torsion");
  verb->add_option("--poisson", command->poisson_ratio, "GJ = (EI1 + EI2) / (2 (1 + NU)), with --unknowns bending")
      ->type_name("NU");
  verb->add_flag("--free-shear", command->free_shear, "The shear stiffness is unknown, too");
  verb->add_option("--method", command->method, "lm: Levenberg-Marquardt; nelder-mead: the paper's")
      ->type_name("lm|nelder-mead");
  verb->add_option("--plot", command->plot, "Points, fitted shapes and residuals (.svg or .png)")->type_name("FILE");
  verb->add_flag("--json", command->json, "Summary for a program");
  verb->footer(
      "Example: palpate identify stiffness --catheter catheter.toml --cases cases.toml --out identified.toml\n"
      "docs/howto/identify_stiffness.md shows a case file.");
  verb->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace palpate::app
