// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <palpate/estimation/consistency.hpp>
#include <palpate/plot/thinning.hpp>
#include <set>

#include "report_json.hpp"

namespace palpate::app {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostWhole = 12000;  // rows; all are kept up to here
constexpr int kBins = 1000;                // beyond, each of them keeps what shows

double lateral(const Vector3d& force_N) { return force_N.head<2>().norm(); }

/// True force at the times of the frames, as `palpate evaluate` takes it; NaN outside the trace.
std::vector<Vector3d> truth_at_frames(const ReportRun& run) {
  std::vector<Vector3d> truth;
  if (!run.truth) return truth;
  for (const EstimateRow& row : run.rows) {
    const ForceTrace::Sample sample = run.truth->interpolate(row.time_s);
    truth.push_back(sample.inside ? sample.force_tip_N : Vector3d::Constant(kNaN));
  }
  return truth;
}

class Channels {
 public:
  explicit Channels(std::size_t rows) : rows_(rows) {}
  template <class Value>
  void add(const Value& value) {
    std::vector<double> channel(rows_);
    for (std::size_t i = 0; i < rows_; ++i) channel[i] = value(i);
    all_.push_back(std::move(channel));
  }
  const std::vector<std::vector<double>>& all() const { return all_; }

 private:
  std::size_t rows_;
  std::vector<std::vector<double>> all_;
};

std::vector<std::size_t> choose_rows(const ReportRun& run, const std::vector<Vector3d>& truth) {
  const auto measured = [&](std::size_t i, double value) { return run.sizes[i].measured ? value : kNaN; };
  const auto force = [&](std::size_t i) -> const Vector3d& { return run.rows[i].force_tip_N; };
  Channels channels(run.rows.size());
  channels.add([&](std::size_t i) { return measured(i, run.sizes[i].size_N); });
  channels.add([&](std::size_t i) { return measured(i, run.sizes[i].sigma_N); });
  channels.add([&](std::size_t i) { return measured(i, lateral(force(i))); });
  for (int axis = 0; axis < 3; ++axis) channels.add([&](std::size_t i) { return measured(i, force(i)(axis)); });
  channels.add([&](std::size_t i) { return run.sizes[i].measured ? kNaN : run.sizes[i].size_N; });
  if (!truth.empty()) {
    channels.add([&](std::size_t i) { return truth[i].norm(); });
    channels.add([&](std::size_t i) { return lateral(truth[i]); });
    for (int axis = 0; axis < 3; ++axis) channels.add([&](std::size_t i) { return truth[i](axis); });
  }
  return telling_rows(run.rows.size(), channels.all(), kMostWhole, kBins);
}

/// One column of the chosen rows.
template <class Value>
nlohmann::json column(const std::vector<std::size_t>& chosen, const Value& value) {
  nlohmann::json out = nlohmann::json::array();
  for (const std::size_t i : chosen) out.push_back(value(i));
  return out;
}

/// Stretches of one status other than measured; each ends where the next frame begins.
nlohmann::json spans_json(const ReportRun& run) {
  nlohmann::json spans = nlohmann::json::array();
  for (std::size_t i = 0; i < run.rows.size();) {
    std::size_t end = i + 1;
    while (end < run.rows.size() && run.rows[end].status == run.rows[i].status) ++end;
    if (!run.sizes[i].measured) {
      const std::size_t last = std::min(end, run.rows.size() - 1);
      spans.push_back({{"from", rounded(run.rows[i].time_s, 9)},
                       {"to", rounded(run.rows[last].time_s, 9)},
                       {"frames", end - i},
                       {"status", describe(run.rows[i].status)}});
    }
    i = end;
  }
  return spans;
}

/// Interval that holds 95 % of NIS / dof, by degrees of freedom.
nlohmann::json nis_bands(const ReportRun& run) {
  nlohmann::json bands = nlohmann::json::object();
  for (const EstimateRow& row : run.rows) {
    const std::string key = fmt::format("{}", row.dof);
    if (row.dof < 1 || bands.contains(key)) continue;
    bands[key] = {rounded(chi_square_tail_quantile(0.975, row.dof) / row.dof, 5),
                  rounded(chi_square_tail_quantile(0.025, row.dof) / row.dof, 5)};
  }
  return bands;
}

}  // namespace

nlohmann::json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

std::vector<std::size_t> telling_rows(std::size_t rows, const std::vector<std::vector<double>>& channels,
                                      std::size_t most_whole, int bins) {
  std::vector<std::size_t> all(rows);
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (rows <= most_whole) return all;
  std::set<std::size_t> kept{0, rows - 1};
  const plot::PixelAxis along{.from = 0.0, .to = static_cast<double>(rows), .pixels = bins};
  for (const std::vector<double>& channel : channels) {
    std::vector<double> row, value;  // where it is a number: else every gap, however short, would keep its ends
    for (std::size_t i = 0; i < rows; ++i)
      if (std::isfinite(channel[i])) row.push_back(static_cast<double>(i)), value.push_back(channel[i]);
    for (const plot::Run& piece : plot::thin_line(row, value, along, {}))
      for (const plot::Point& point : piece) kept.insert(static_cast<std::size_t>(point.x));
  }
  return {kept.begin(), kept.end()};
}

nlohmann::json curves_json(const ReportRun& run) {
  const std::vector<Vector3d> truth = truth_at_frames(run);
  const std::vector<std::size_t> chosen = choose_rows(run, truth);
  const auto& rows = run.rows;
  nlohmann::json out{{"frames", rows.size()}, {"spans", spans_json(run)}, {"nis_bands", nis_bands(run)}};
  out["time_s"] = column(chosen, [&](std::size_t i) { return rounded(rows[i].time_s, 9); });
  const char* axes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    const std::string axis = axes[k];
    out["f" + axis + "_N"] = column(chosen, [&](std::size_t i) { return rounded(rows[i].force_tip_N(k), 9); });
    out["sigma_" + axis + "_N"] =
        column(chosen, [&](std::size_t i) { return rounded(std::sqrt(rows[i].covariance_tip_N2(k, k)), 3); });
    if (!truth.empty())
      out["truth_" + axis + "_N"] = column(chosen, [&](std::size_t i) { return rounded(truth[i](k), 5); });
  }
  out["sigma_size_N"] = column(chosen, [&](std::size_t i) { return rounded(run.sizes[i].sigma_N, 3); });
  out["sigma_lateral_N"] = column(chosen, [&](std::size_t i) {
    const Eigen::VectorXd across = rows[i].force_tip_N.head<2>();
    return rounded(sigma_of_norm(across, rows[i].covariance_tip_N2.topLeftCorner<2, 2>()), 3);
  });
  out["status"] = column(chosen, [&](std::size_t i) { return static_cast<int>(rows[i].status); });
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    out["statuses"].push_back(describe(static_cast<EstimateStatus>(i)));
  out["nis_per_dof"] =
      column(chosen, [&](std::size_t i) { return rows[i].dof > 0 ? rounded(rows[i].nis / rows[i].dof, 3) : nullptr; });
  out["dof"] = column(chosen, [&](std::size_t i) { return rows[i].dof; });
  return out;
}

}  // namespace palpate::app
