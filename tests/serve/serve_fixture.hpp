// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <tests/recording/temporary_folder.hpp>
#include <tests/serve/plus_server.hpp>
#include <tests/serve/serve_process.hpp>
#include <tests/serve/slicer_client.hpp>

namespace palpate::serve_test {

/// Tests of the real program between a PLUS server and a 3D Slicer, both made of Debian's libopenigtlink. Each has a
/// folder of its own with the catheter file c.toml; the catheter is called `c`.
class Serve : public test::TemporaryFolder {
 protected:
  void SetUp() override;

  /// Writes serve.toml: one catheter whose frames come from plus_; `more`: further tables.
  std::string settings(const std::string& more = "") const;
  /// Runs it.
  std::unique_ptr<ServeProcess> start(const std::string& more = "") const;
  /// The same, and waits until plus_ has it as its client.
  std::unique_ptr<ServeProcess> serve(const std::string& more = "");
  /// One more client of the program's, known to it.
  static std::unique_ptr<SlicerClient> slicer(const ServeProcess& program);
  /// Its health once this holds of it; the latest where it does not within so many seconds, which fails the test.
  static nlohmann::json health_when(const ServeProcess& program,
                                    const std::function<bool(const nlohmann::json& health)>& holds, double longest_s);
  /// The frames of which this test makes its own: 40 Hz, 4 s; made once.
  static const VirtualWire& beating();

  PlusServer plus_;
  CatheterFile catheter_ = catheter_file();
};

/// Forces that came against the observer's offline run: the same frames, the same numbers, NaN where there is none.
/// One force a frame, in order. A frame that was late by what counts as silence (100 ms) may show none: `sent` says
/// which were.
void expect_equal_forces(const std::vector<SlicerClient::Force>& came, const std::vector<Estimate>& offline,
                         const WireFrames& frames, const std::vector<Clock::time_point>& sent);

/// From the socket that sent a frame to the socket that got its force, the two lists alike.
std::vector<double> latencies_s(const std::vector<SlicerClient::Force>& came,
                                const std::vector<Clock::time_point>& sent);

/// Seconds, the share of them below which the percentile lies.
double percentile_s(std::vector<double> values, double share);

}  // namespace palpate::serve_test
