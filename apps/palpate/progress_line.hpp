// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::app {

/// `palpate: VERB 42 %`, or other words, on stderr, one line that is written again and wiped at the end. Only on a
/// terminal: nothing in a pipe.
class ProgressLine {
 public:
  explicit ProgressLine(std::string verb);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(double share);
  void show(const std::string& words) const;

 private:
  std::string verb_;
  bool shown_;
  int percent_ = -1;
};

}  // namespace palpate::app
