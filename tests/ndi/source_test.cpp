// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/service/service.hpp>
#include <palpate/session/reader.hpp>
#include <tests/ndi/aurora_simulator.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/service/demo_frames.hpp>

namespace palpate::service {
namespace {

using Kind = SourceSettings::Kind;

class NdiSourceOfService : public test::TemporaryFolder {
 protected:
  /// What read_settings() makes of these sources, each of a catheter of its own.
  Settings read(const std::vector<std::string>& sources) const {
    write("c.toml", test::demo_catheter().toml);
    std::string text = "schema = 1\n";
    for (std::size_t i = 0; i < sources.size(); ++i)
      text += fmt::format("[[catheter]]\nname = \"c{}\"\nfile = \"c.toml\"\nsource = {{ {} }}\n", i, sources[i]);
    return read_settings(write("serve.toml", text));
  }
  std::string refusal(const std::vector<std::string>& sources) const {
    return error_of([&] { read(sources); });
  }
};

TEST_F(NdiSourceOfService, SettingsNameThePortAndItsTools) {
  const Settings settings = read({R"(kind = "ndi", path = "/dev/ttyUSB0", tools = { tip = "0A", shaft = "1-1" })",
                                  R"(kind = "ndi", path = "/dev/ttyS1")"});
  const SourceSettings& source = settings.catheters[0].source;
  EXPECT_EQ(source.kind, Kind::kNdi);
  EXPECT_EQ(source.path, "/dev/ttyUSB0");
  EXPECT_EQ(source.tools, (std::map<std::string, std::string>{{"tip", "0A"}, {"shaft", "1-1"}}));
  EXPECT_TRUE(settings.catheters[1].source.tools.empty());
}

TEST_F(NdiSourceOfService, ToolsThatCannotBeAreRefused) {
  const std::string port = R"(kind = "ndi", path = "/dev/ttyUSB0", tools = )";
  for (const char* const tools :
       {R"({ tip = "0A" })", R"({ tip = "0A", shaft = "x" })", R"({ tip = "0A", shaft = 1 })"})
    EXPECT_THAT(refusal({port + tools}), testing::HasSubstr("for sensor \"shaft\" a port handle")) << tools;
  EXPECT_THAT(refusal({port + R"({ tip = "0A", shaft = "0B", nose = "0C" })"}), testing::HasSubstr("not \"nose\""));
  EXPECT_THAT(refusal({port + "1"}), testing::HasSubstr("a table"));
  EXPECT_THAT(refusal({port + R"({ tip = "0A", shaft = "0A" })"}), testing::HasSubstr("tool \"0A\" once"));
  EXPECT_THAT(refusal({R"(kind = "ndi")"}), testing::HasSubstr("path"));
  const std::string plain = R"(kind = "ndi", path = "/dev/ttyUSB0")";
  EXPECT_THAT(refusal({plain, plain}),
              testing::HasSubstr("a tool for every sensor, for \"c0\" is on /dev/ttyUSB0 too"));
  EXPECT_EQ(refusal({port + R"({ tip = "0A", shaft = "0B" })", port + R"({ tip = "0C", shaft = "0D" })"}), "no error");
}

TEST_F(NdiSourceOfService, AsTyped) {
  EXPECT_EQ(parse_source("ndi:/dev/ttyUSB0").kind, Kind::kNdi);
  EXPECT_EQ(parse_source("ndi:/dev/ttyUSB0").path, "/dev/ttyUSB0");
  EXPECT_THROW(parse_source("ndi:"), InputError);
}

/// The whole instrument, from the serial port to the recording.
TEST_F(NdiSourceOfService, AWholeServiceFeelsThroughAnAurora) {
  const std::vector<TrackerFrame> frames = test::demo_frames(1.0);
  Settings settings = demo_settings();
  settings.catheters[0].source = {
      .kind = Kind::kNdi, .path = path("aurora"), .tools = {{"tip", "0A"}, {"shaft", "1-1"}}};
  settings.link.port = settings.dashboard.server.port = 0;
  settings.recording.path = path("s.palpate");
  test::AuroraSimulator aurora(path("aurora"), {.frames = frames});
  Service service(settings);
  bool ended = false;
  service.run([&] {
    if (!ended && service.health()["catheters"][0]["frames"] == frames.size()) ended = std::raise(SIGTERM) == 0;
  });
  const nlohmann::json health = service.finish();
  EXPECT_EQ(health["catheters"][0]["frames"], frames.size());
  EXPECT_EQ(health["sources"][0]["server"], path("aurora").string());
  EXPECT_EQ(health["sources"][0]["connections"], 1);
  EXPECT_EQ(health["sources"][0]["frames"], frames.size());

  session::SessionReader reader(path("s.palpate"));
  session::LiveRecord record;
  std::size_t heard = 0;
  std::vector<std::string> events;
  while (reader.next(record)) {
    if (record.kind == session::LiveRecord::Kind::kEvent) events.push_back(record.event);
    if (record.kind != session::LiveRecord::Kind::kFrame) continue;
    for (std::size_t sensor = 0; sensor < 2; ++sensor)
      EXPECT_LT((record.frame.readings[sensor].position_m - frames[heard].readings[sensor].position_m).norm(), 1e-7);
    ++heard;
  }
  EXPECT_EQ(heard, frames.size());
  EXPECT_THAT(events, testing::Contains("connected"));
}

}  // namespace
}  // namespace palpate::service
