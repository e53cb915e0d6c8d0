// SPDX-License-Identifier: Apache-2.0
#include "progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace palpate::app {

ProgressLine::ProgressLine(std::string verb) : verb_(std::move(verb)), shown_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (shown_) fmt::print(stderr, "\r\033[K");
}

void ProgressLine::show(double share) {
  const int percent = static_cast<int>(100.0 * share);
  if (!shown_ || percent == percent_) return;
  percent_ = percent;
  show(fmt::format("{:3} %", percent));
}

void ProgressLine::show(const std::string& words) const {
  if (!shown_) return;
  fmt::print(stderr, "\rpalpate: {} {}\033[K", verb_, words);
  std::fflush(stderr);
}

}  // namespace palpate::app
