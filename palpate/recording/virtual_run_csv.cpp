// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/recording/virtual_run_csv.hpp>

namespace palpate {
namespace {

/// A text as a CSV field: in quotes where it must be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string moment_fields(const TendonReading& tendon) {
  if (!tendon.present) return ",,";
  const std::string sigma = tendon.sigma_Nm > 0.0 ? fmt::format("{:.9g}", tendon.sigma_Nm) : "";
  return fmt::format("{:.9g},{:.9g},{}", tendon.moment_Nm.x(), tendon.moment_Nm.y(), sigma);
}

}  // namespace

void write_true_force_csv(OutputFile& file, const VirtualRun& run) {
  file.write("time_s,fx_tip_N,fy_tip_N,fz_tip_N,fx_base_N,fy_base_N,fz_base_N\n");
  for (const Truth& truth : run.truth) {
    const Vector3d &f = truth.force_tip_N, &b = truth.force_base_N;
    file.write(fmt::format("{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", truth.time_s, f.x(), f.y(), f.z(),
                           b.x(), b.y(), b.z()));
  }
}

bool has_tendon_trace(const VirtualRun& run) {
  return !run.knob_rad.empty() ||
         std::any_of(run.frames.begin(), run.frames.end(), [](const auto& frame) { return frame.tendon.present; });
}

void write_tendon_csv(OutputFile& file, const VirtualRun& run) {
  const bool knob = !run.knob_rad.empty();
  file.write(knob ? "time_s,moment_1_Nm,moment_2_Nm,sigma_Nm,knob_rad\n" : "time_s,moment_1_Nm,moment_2_Nm,sigma_Nm\n");
  for (std::size_t i = 0; i < run.truth.size(); ++i)
    file.write(fmt::format("{:.6f},{}{}\n", run.truth[i].time_s, moment_fields(run.frames[i].tendon),
                           knob ? fmt::format(",{:.9g}", run.knob_rad[i]) : ""));
}

void write_stiffness_csv(OutputFile& file, const VirtualRun& run) {
  file.write("time_s,EI1_Nm2,EI2_Nm2,GJ_Nm2\n");
  for (const Truth& truth : run.truth) {
    const Stiffness& K = truth.stiffness_Nm2;
    file.write(fmt::format("{:.6f},{:.9g},{:.9g},{:.9g}\n", truth.time_s, K.x(), K.y(), K.z()));
  }
}

void write_events_csv(OutputFile& file, const VirtualRun& run) {
  file.write("time_s,what\n");
  for (const ScenarioEvent& event : run.events) file.write(fmt::format("{:.6f},{}\n", event.time_s, field(event.what)));
}

}  // namespace palpate
