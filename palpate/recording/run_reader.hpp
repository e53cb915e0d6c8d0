// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <vector>

namespace palpate {

/// What a run is of, known before its first frame.
struct RunDescription {
  std::string source;                     ///< where it is read from, for messages
  std::string catheter_source;            ///< likewise of the catheter file
  std::string catheter_text;              ///< the catheter file as it was written
  CatheterFile settings;                  ///< and what it says, options of the command line applied
  std::vector<std::string> sensor_names;  ///< order of the readings: as Catheter::sensors, a tracked base last
  bool has_estimates = false;             ///< every frame brings a stored estimate
};

/// One frame, and what was made of it at the time.
struct RunMoment {
  TrackerFrame frame;
  std::optional<EstimateRow> estimate;  ///< as RunDescription::has_estimates
};

/// Something that was said about a run: a note of the device, a mark of the operator.
struct RunEvent {
  std::optional<double> time_s;  ///< none: of the whole run
  std::string text;
};

/// Time without any frame although frames were due.
struct RunGap {
  double from_s = 0.0, to_s = 0.0;
};

/// The one way in which reports, replays and exports read a run, wherever it is kept. Forward only, once; frames in the
/// order in which they came. Every call throws InputError where the store cannot be read.
class RunReader {
 public:
  virtual ~RunReader() = default;
  virtual const RunDescription& description() const = 0;
  /// False at the end: `moment` is then as it was.
  [[nodiscard]] virtual bool next(RunMoment& moment) = 0;
  /// In time order, those of the whole run first; complete once next() has said false, and so are the gaps.
  virtual const std::vector<RunEvent>& events() const = 0;
  virtual const std::vector<RunGap>& gaps() const = 0;
};

/// A run kept in files: a recording of any format, bound to its catheter, and, where there is one, its estimate CSV.
class FileRunReader final : public RunReader {
 public:
  /// `estimate_path` empty: no estimates. Throws InputError naming the line where the rows of the estimate are not
  /// those of the recording: one a frame, of equal time.
  FileRunReader(TrackerRecording recording, RunDescription description, const std::string& estimate_path);

  const RunDescription& description() const override { return description_; }
  bool next(RunMoment& moment) override;
  const std::vector<RunEvent>& events() const override { return events_; }
  const std::vector<RunGap>& gaps() const override { return gaps_; }

 private:
  TrackerRecording recording_;
  RunDescription description_;
  std::vector<EstimateRow> estimate_;
  std::vector<RunEvent> events_;
  std::vector<RunGap> gaps_;
  std::size_t next_ = 0;
};

/// Where a frame comes later after the one before than 5 times the median period, and than 0.25 s.
std::vector<RunGap> find_gaps(const std::vector<TrackerFrame>& frames);

}  // namespace palpate
