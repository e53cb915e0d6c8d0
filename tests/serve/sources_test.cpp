// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tests/apps/run_program.hpp>
#include <tests/link/example_messages.hpp>
#include <tests/serve/serve_fixture.hpp>

/// Wrong port, wrong name, wrong version, wrong settings: said clearly, nothing left behind (issue 8, point 5).
namespace palpate::serve_test {
namespace {

class ServeSources : public Serve {
 protected:
  static bool connected(const nlohmann::json& health) { return health["sources"][0]["connected"].get<bool>(); }

  /// `palpate serve` is to refuse: exit code 2, nothing on stdout, one line on stderr (given back), no new file.
  std::string refusal(const std::vector<std::string>& arguments) const {
    const auto files = [&] {
      std::vector<std::string> names;
      for (const auto& entry : std::filesystem::recursive_directory_iterator(path("")))
        names.push_back(entry.path().string());
      std::sort(names.begin(), names.end());
      return names;
    };
    const auto before = files();
    std::vector<std::string> all{"serve"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    for (const char* const port : {"--openigtlink-port", "--dashboard-port"})
      if (std::find(all.begin(), all.end(), port) == all.end()) all.insert(all.end(), {port, "0"});
    const test::ProgramRun run = test::run_program(PALPATE_BINARY, all, path(""));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(files(), before);
    return run.err;
  }

  void expect_words(const std::string& text, const std::vector<std::string>& words) const {
    for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
  }
};

TEST_F(ServeSources, NothingListens) {
  plus_.close();
  const auto program = start();
  auto health = health_when(
      *program, [](const auto& h) { return h["sources"][0]["error"] != "not started"; }, 5.0);
  EXPECT_FALSE(connected(health));
  EXPECT_EQ(health["catheters"][0]["state"], "WAITING");
  expect_words(health["sources"][0]["error"], {"127.0.0.1:" + std::to_string(plus_.port()), "refused"});
  plus_.listen();
  ASSERT_TRUE(plus_.accept(5.0)) << "it has given up";
  plus_.play(moved_to(beating().frames, utc_s()), 200.0, 0, 20);
  auto live = health_when(
      *program, [](const auto& h) { return h["catheters"][0]["frames"] == 20; }, 5.0);
  EXPECT_EQ(live["sources"][0]["error"], "");
}

TEST_F(ServeSources, AnUnknownDeviceIsNamed) {
  const auto program = serve();
  WireFrames frames = moved_to(beating().frames, utc_s());
  for (WireFrame& frame : frames) frame.poses = {{"ProbeToTracker", frame.of(kTip)}};
  plus_.play(frames, 200.0, 0, 20);
  auto health = health_when(
      *program, [](const auto& h) { return h["sources"][0]["messages"] == 20; }, 5.0);
  EXPECT_EQ(health["sources"][0]["unknown_device"], "ProbeToTracker");
  EXPECT_EQ(health["catheters"][0]["state"], "WAITING");
  EXPECT_TRUE(connected(health));
}

TEST_F(ServeSources, AVersionThatIsNotKnown) {
  const auto program = serve();
  const link::test::Bytes body(48, std::byte{0});
  ASSERT_TRUE(plus_.send_raw(link::test::raw_message("TRANSFORM", body, 3)));
  auto health = health_when(
      *program, [](const auto& h) { return h["sources"][0]["malformed"] == 1; }, 5.0);
  expect_words(health["sources"][0]["error"], {"malformed", "version"});
  EXPECT_TRUE(plus_.accept(1.2)) << "no second connection";
}

TEST_F(ServeSources, AnotherProtocol) {
  const auto program = serve();
  const std::string text = "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain; charset=utf-8\r\nX: 1234567\r\n";
  ASSERT_TRUE(plus_.send_raw(std::as_bytes(std::span(text))));
  health_when(
      *program, [](const auto& h) { return h["sources"][0]["malformed"] == 1; }, 5.0);
  EXPECT_TRUE(plus_.accept(1.2)) << "no second connection";
  plus_.play(moved_to(beating().frames, utc_s()), 200.0, 0, 20);
  health_when(
      *program, [](const auto& h) { return h["catheters"][0]["frames"] == 20; }, 5.0);
}

TEST_F(ServeSources, SettingsWithATypo) {
  settings("[recording]\npath = \"s.palpate\"\nbatch_msec = 50\n");
  expect_words(refusal({"serve.toml"}), {"serve.toml:4", "batch_msec", "batch_ms"});
  settings("[service]\nstale_ms = 5\n");
  expect_words(refusal({"serve.toml"}), {"serve.toml:3", "stale_ms", "5", "20 to 10000"});
}

TEST_F(ServeSources, RecordingsThatCannotBe) {
  write("old.palpate", "older");
  settings("[recording]\npath = \"old.palpate\"\n");
  expect_words(refusal({"serve.toml"}), {"old.palpate", "exist"});
  EXPECT_EQ(contents(path("old.palpate")), "older");
  settings("[recording]\npath = \"absent/s.palpate\"\n");
  expect_words(refusal({"serve.toml"}), {"absent/s.palpate"});
  settings("[recording]\npath = \"/proc/s.palpate\"\n");
  expect_words(refusal({"serve.toml"}), {"/proc/s.palpate"});
}

TEST_F(ServeSources, PortsInUse) {
  settings("[recording]\npath = \"s.palpate\"\n");
  const std::string taken = std::to_string(plus_.port());
  expect_words(refusal({"serve.toml", "--dashboard-port", taken}), {taken, "in use"});
  expect_words(refusal({"serve.toml", "--openigtlink-port", taken}), {taken, "in use"});
}

TEST_F(ServeSources, DashboardsThatCannotBe) {
  const auto with = [&](const std::string& line) {
    settings("[recording]\npath = \"s.palpate\"\n[dashboard]\n" + line + "\n");
    return refusal({"serve.toml"});
  };
  expect_words(with("address = \"0.0.0.0\""), {"address", "0.0.0.0", "TLS"});
  expect_words(with("address = \"laboratory\""), {"laboratory"});
  expect_words(with("certificate = \"c.toml\""), {"key"});
  expect_words(with("certificate = \"absent.pem\"\nkey = \"absent.key\""),
               {"certificate", "absent.pem", "No such file"});
  expect_words(with("certificate = \"c.toml\"\nkey = \"c.toml\""), {"certificate", "c.toml", "PEM"});
  expect_words(with("bands_g = [10, 5]"), {"serve.toml:5", "bands_g", "rising"});
  expect_words(with("unit = \"kg\""), {"serve.toml:5", "unit", "kg"});
  expect_words(with("adress = \"127.0.0.1\""), {"serve.toml:5", "adress", "address"});
}

}  // namespace
}  // namespace palpate::serve_test
