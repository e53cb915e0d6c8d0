// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/run_reader.hpp>
#include <palpate/session/reader.hpp>

namespace palpate::session {

/// A catheter file's text as the parser of catheter files takes it. `name`: for its messages.
TextFile text_file(const std::string& name, const std::string& text);

/// The settings of a catheter as the session began. Throws InputError as parse_catheter does.
CatheterFile settings_of(const SessionCatheter& catheter);

/// Index of the catheter of this name; the only one where it is empty. Throws InputError, with the names there are.
std::size_t find_catheter(const SessionReader& reader, const std::string& path, const std::string& name);

/// One catheter of a session as reports read a run. Events stand at the device's time of the frame before them; what of
/// the session could not be read is an event of the whole run.
class SessionRunReader final : public RunReader {
 public:
  /// `catheter`: its name; empty: the only one. Throws InputError.
  SessionRunReader(const std::filesystem::path& path, const std::string& catheter);

  const RunDescription& description() const override { return description_; }
  bool next(RunMoment& moment) override;
  const std::vector<RunEvent>& events() const override { return events_; }
  const std::vector<RunGap>& gaps() const override { return gaps_; }

 private:
  void finish();

  SessionReader reader_;
  int catheter_ = 0;
  RunDescription description_;
  std::vector<RunEvent> events_;
  std::vector<RunGap> gaps_;
  std::vector<TrackerFrame> times_;  ///< of the frames so far, their times alone
  std::vector<std::string> early_;   ///< events before the first frame
  bool finished_ = false;
};

/// An event in words: its name, and the text or the values that came with it.
std::string in_words(const LiveRecord& event);

}  // namespace palpate::session
