// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/evaluation/force_size.hpp>
#include <tests/serve/serve_fixture.hpp>

namespace palpate::serve_test {

void Serve::SetUp() {
  TemporaryFolder::SetUp();
  write("c.toml", catheter_text());
}

std::string Serve::settings(const std::string& more) const {
  write("serve.toml", "schema = 1\n" + more + R"(
[[catheter]]
name = "c"
file = "c.toml"
[catheter.source]
kind = "openigtlink"
port = )" + std::to_string(plus_.port()) +
                          "\n");
  return path("serve.toml").string();
}

std::unique_ptr<ServeProcess> Serve::start(const std::string& more) const {
  return std::make_unique<ServeProcess>(
      path(""), std::vector<std::string>{settings(more), "--openigtlink-port", "0", "--dashboard-port", "0"});
}

std::unique_ptr<ServeProcess> Serve::serve(const std::string& more) {
  auto process = start(more);
  EXPECT_TRUE(plus_.accept()) << "the program did not connect, or did not ask for STT_TDATA: " << process->err();
  return process;
}

nlohmann::json Serve::health_when(const ServeProcess& program,
                                  const std::function<bool(const nlohmann::json& health)>& holds, double longest_s) {
  nlohmann::json health;
  EXPECT_TRUE(eventually([&] { return holds(health = program.health()); }, longest_s, 0.01)) << health.dump(1);
  return health;
}

const VirtualWire& Serve::beating() {
  static const VirtualWire made = virtual_wire(catheter_file().catheter, 40.0, 4.0);
  return made;
}

std::unique_ptr<SlicerClient> Serve::slicer(const ServeProcess& program) {
  const auto accepted = [&] { return program.health().at("openigtlink").at("accepted").get<std::size_t>(); };
  const std::size_t before = accepted();
  auto client = std::make_unique<SlicerClient>(program.link_port());
  EXPECT_TRUE(eventually([&] { return accepted() > before; }, 5.0));
  return client;
}

namespace {

/// How old each force was when it came: on its way, and before the test itself got round to sending its frame.
std::vector<double> ages_s(std::vector<double> latencies, const WireFrames& frames,
                           const std::vector<Clock::time_point>& sent) {
  const auto lag_s = [&](std::size_t i) {
    return std::chrono::duration<double>(sent[i] - sent[0]).count() - (frames[i].time_s - frames[0].time_s);
  };
  double least_s = 0.0;
  for (std::size_t i = 0; i < latencies.size(); ++i) least_s = std::min(least_s, lag_s(i));
  for (std::size_t i = 0; i < latencies.size(); ++i) latencies[i] += lag_s(i) - least_s;
  return latencies;
}

}  // namespace

void expect_equal_forces(const std::vector<SlicerClient::Force>& came, const std::vector<Estimate>& offline,
                         const WireFrames& frames, const std::vector<Clock::time_point>& sent) {
  constexpr double kSilence_s = 0.1;
  ASSERT_EQ(came.size(), offline.size());
  const std::vector<double> ages = ages_s(latencies_s(came, sent), frames, sent);
  for (std::size_t i = 0; i < came.size(); ++i) {
    const Estimate& estimate = offline[i];
    const bool live = is_measured(estimate.status) && (came[i].live() || ages[i] < kSilence_s);
    EXPECT_EQ(came[i].time_s, frames[i].time_s) << "frame " << i;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      if (live)
        ASSERT_EQ(came[i].values[axis], estimate.force_tip_N(a)) << "frame " << i;
      else
        ASSERT_TRUE(std::isnan(came[i].values[axis])) << "frame " << i;
      ASSERT_EQ(came[i].values[axis + 3], std::sqrt(estimate.covariance_tip_N2(a, a))) << "frame " << i;
    }
  }
}

std::vector<double> latencies_s(const std::vector<SlicerClient::Force>& came,
                                const std::vector<Clock::time_point>& sent) {
  std::vector<double> out;
  for (std::size_t i = 0; i < std::min(came.size(), sent.size()); ++i)
    out.push_back(std::chrono::duration<double>(came[i].received - sent[i]).count());
  return out;
}

double percentile_s(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

}  // namespace palpate::serve_test
