// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <iterator>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/sensing/tendon_map.hpp>
#include <palpate/simulation/virtual_run.hpp>
#include <palpate/study/run_model.hpp>
#include <palpate/study/settings.hpp>
#include <stdexcept>
#include <string>

/// A run as `palpate simulate`, `estimate` and `evaluate` make it, without the files between them.
namespace palpate::study {

namespace {

constexpr double kProbeFrames = 40.0;

void replace(std::string& text, const std::string& part, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += by.size())
    text.replace(at, part.size(), by);
}

/// A full disk is no failure of the run, which would be kept: whoever plays it ends, and it is played again.
void write_text(const std::filesystem::path& path, const std::string& text) {
  try {
    OutputFile file(path);
    file.write(text);
    file.commit();
  } catch (const InputError& error) {
    throw std::runtime_error(error.what());
  }
}

bool holds(const std::filesystem::path& path, const std::string& text) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {}) == text;
}

/// The two files of a point, in the scratch folder.
class PointFiles {
 public:
  PointFiles(const Plan& plan, const std::filesystem::path& scratch)
      : plan_(&plan), scenario_(scratch / "scenario.toml"), catheter_(scratch / "catheter.toml") {}

  void write(Documents documents) {
    toml::table* head = documents.scenario.get_as<toml::table>("scenario");
    if (head != nullptr) head->insert_or_assign("catheter", catheter_.string());
    write_text(catheter_, catheter_text_ = toml_text(documents.catheter));
    write_text(scenario_, scenario_text_ = toml_text(documents.scenario));
  }

  ScenarioFile read(const ScenarioChanges& changes) const {
    try {
      return read_scenario_file(scenario_, changes);
    } catch (const InputError& error) {
      if (!holds(scenario_, scenario_text_) || !holds(catheter_, catheter_text_))
        throw std::runtime_error("the folder for temporary files was changed while the study was played");
      std::string text = error.what();  // by the names that the user knows
      replace(text, scenario_.string(), plan_->scenario_source);
      replace(text, catheter_.string(), plan_->catheter_source);
      throw InputError(text);
    }
  }

 private:
  const Plan* plan_;
  std::filesystem::path scenario_, catheter_;
  std::string scenario_text_, catheter_text_;
};

/// What the handle's map tells the estimator, frame by frame, as it would from a tendon file.
void attach_bends(const Catheter& believed, VirtualRun& run) {
  if (run.knob_rad.empty() || !believed.tendon_map.present) return;
  const TendonPlay play(believed.tendon_map, believed.precurvature_per_m().head<2>());
  TendonPlay::Memory memory;
  for (std::size_t i = 0; i < run.frames.size(); ++i) run.frames[i].bend = play.advance(run.knob_rad[i], memory);
}

/// Of the frames that are judged, as `evaluate` chooses them.
class FrameMeans {
 public:
  void add(const Estimate& estimate) {
    ++frames_;
    evaluations_ += estimate.evaluations;
    if (estimate.dof <= 0) return;
    ++used_;
    nis_per_dof_ += estimate.nis / estimate.dof;
  }
  void put(Figures& figures) const {
    figures.evaluations = evaluations_ / static_cast<double>(frames_);
    figures.nis_per_dof = nis_per_dof_ / static_cast<double>(used_);  // NaN where no frame was used
  }

 private:
  std::size_t frames_ = 0, used_ = 0;
  double evaluations_ = 0.0, nis_per_dof_ = 0.0;
};

ForceTrace true_force(const VirtualRun& run, const std::string& source) {
  ForceTrace trace{.source = source, .times_s = {}, .force_tip_N = {}, .force_base_N = {}};
  for (const Truth& truth : run.truth) {
    trace.times_s.push_back(truth.time_s);
    trace.force_tip_N.push_back(truth.force_tip_N);
  }
  return trace;
}

Figures judge(const CatheterFile& believed, const VirtualRun& run, double skip_s, const std::string& source) {
  const bool mapped = believed.catheter.tendon_map.present && !run.knob_rad.empty();
  ForceObserver observer(mapped ? driven_by_map(believed.catheter) : believed.catheter, believed.observer);
  std::vector<EstimateRow> rows;
  FrameMeans means;
  for (const TrackerFrame& frame : run.frames) {
    const Estimate estimate = observer.update(frame);
    rows.push_back(row_of(estimate));
    if (estimate.time_s >= rows.front().time_s + skip_s) means.add(estimate);
  }
  const Evaluation e = evaluate(rows, true_force(run, source), skip_s);
  Figures figures{.rmse_N = e.rmse_N, .bias_N = e.mean_N, .inside_95 = e.inside_95, .nees = e.mean_nees};
  figures.updated = static_cast<double>(e.updated) / static_cast<double>(e.frames);
  means.put(figures);
  return figures;
}

class ScenarioModel final : public RunModel {
 public:
  ScenarioModel(const Plan& plan, const std::filesystem::path& scratch) : plan_(&plan), files_(plan, scratch) {}

  Figures run(const RunKey& key) override { return judge_played(read(key), plan_->skip_s); }

  Figures probe(const RunKey& key) override {
    ScenarioFile file = read(key);
    file.scenario.duration_s = std::min(file.scenario.duration_s, kProbeFrames / file.scenario.tracker.rate_hz);
    return judge_played(file, 0.0);
  }

 private:
  ScenarioFile read(const RunKey& key) {
    if (!started_ || key.point != point_) files_.write(documents_at(*plan_, point_values(*plan_, key.point)));
    started_ = true;
    point_ = key.point;
    ScenarioChanges changes;
    changes.seed = key.seed;
    return files_.read(changes);  // again: the seed may draw the catheter, too
  }

  Figures judge_played(const ScenarioFile& file, double skip_s) const {
    VirtualRun played = run_scenario(file.scenario);
    attach_bends(file.believed.catheter, played);
    attach_known_loads(file.believed.known_loads, played.frames);
    return judge(file.believed, played, skip_s, plan_->scenario_source);
  }

  const Plan* plan_;
  PointFiles files_;
  std::uint64_t point_ = 0;
  bool started_ = false;
};

}  // namespace

std::unique_ptr<RunModel> make_scenario_model(const Plan& plan, const std::filesystem::path& scratch) {
  return std::make_unique<ScenarioModel>(plan, scratch);
}

void check_scenario_documents(const Plan& plan, const Documents& documents, const std::filesystem::path& scratch) {
  PointFiles files(plan, scratch);
  files.write(documents);
  const ScenarioFile file = files.read({});
  ForceObserver(file.believed.catheter, file.believed.observer);
}

}  // namespace palpate::study
