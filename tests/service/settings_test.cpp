// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <palpate/service/settings.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/service/demo_frames.hpp>

namespace palpate::service {
namespace {

using Kind = SourceSettings::Kind;

class ServeSettings : public test::TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    write("c.toml", test::demo_catheter().toml);
  }
  Settings read(const std::string& text) const {
    write("serve.toml", text);
    return read_settings(path("serve.toml"));
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
};

constexpr const char* kWhole = R"(schema = 1
[service]
stale_ms = 200
real_time_priority = 50
lock_memory = true
[recording]
path = "s.palpate"
durability = "full"
batch_ms = 50
queue = 1000
[openigtlink]
address = "0.0.0.0"
port = 18950
shape_hz = 10
most_clients = 3
[dashboard]
on = false
address = "192.168.1.5"
port = 18951
hosts = ["lab", "lab.example.org"]
certificate = "lab.pem"
key = "/etc/lab.key"
most_connections = 20
bands_g = [10, 20.5]
unit = "mN"
[[catheter]]
name = "ablation"
file = "c.toml"
source = { kind = "openigtlink", host = "tracker", port = 18944, devices = { tip = "StylusToTracker" }, hold_ms = 5 }
[[catheter]]
name = "sheath"
file = "c.toml"
source = { kind = "file", path = "run.csv", speed = 2.5, loop = true }
)";

TEST_F(ServeSettings, EveryKeyIsRead) {
  const Settings out = read(kWhole);
  EXPECT_DOUBLE_EQ(out.stale_s, 0.2);
  EXPECT_EQ(out.real_time_priority, 50);
  EXPECT_TRUE(out.lock_memory);
  EXPECT_EQ(out.recording.path, path("s.palpate"));
  EXPECT_EQ(out.recording.options.durability, session::Durability::kFull);
  EXPECT_DOUBLE_EQ(out.recording.options.batch_s, 0.05);
  EXPECT_EQ(out.recording.options.queue, 1000u);
  EXPECT_EQ(out.link.address, "0.0.0.0");
  EXPECT_EQ(out.link.port, 18950);
  EXPECT_DOUBLE_EQ(out.link.shape_hz, 10.0);
  EXPECT_EQ(out.link.most_clients, 3u);
  EXPECT_FALSE(out.dashboard.on);
  EXPECT_EQ(out.dashboard.server.address, "192.168.1.5");
  EXPECT_EQ(out.dashboard.server.port, 18951);
  EXPECT_EQ(out.dashboard.server.hosts, (std::vector<std::string>{"lab", "lab.example.org"}));
  EXPECT_EQ(out.dashboard.server.certificate, path("lab.pem"));
  EXPECT_EQ(out.dashboard.server.key, "/etc/lab.key");
  EXPECT_EQ(out.dashboard.server.most_connections, 20U);
  EXPECT_EQ(out.dashboard.bands_g, (std::vector<double>{10.0, 20.5}));
  EXPECT_EQ(out.dashboard.unit, "mN");
  ASSERT_EQ(out.catheters.size(), 2u);
  EXPECT_EQ(out.catheters[0].sensor_names, (std::vector<std::string>{"tip", "shaft"}));
  EXPECT_EQ(out.catheters[0].source.host, "tracker");
  EXPECT_EQ(out.catheters[0].source.devices.at("tip"), "StylusToTracker");
  EXPECT_DOUBLE_EQ(out.catheters[0].source.hold_s, 0.005);
  EXPECT_EQ(out.catheters[1].source.kind, Kind::kFile);
  EXPECT_EQ(out.catheters[1].source.path, path("run.csv"));
  EXPECT_TRUE(out.catheters[1].source.loop);
  EXPECT_EQ(out.catheters[1].toml, test::demo_catheter().toml);
}

constexpr const char* kOne =
    "schema = 1\n[[catheter]]\nname = \"a\"\nfile = \"c.toml\"\nsource = { kind = \"stdin\" }\n";

TEST_F(ServeSettings, FilesAreFoundFromTheSettingsFolder) { EXPECT_EQ(read(kOne).catheters[0].file, path("c.toml")); }

TEST_F(ServeSettings, WhatCannotBeIsRefusedAtItsPlace) {
  const auto with = [](const std::string& more) { return kOne + more; };
  EXPECT_THAT(refusal(with("[service]\nstale_msec = 5\n")),
              testing::AllOf(testing::HasSubstr("serve.toml:7"), testing::HasSubstr("stale_ms")));
  EXPECT_THAT(refusal(with("[service]\nstale_ms = 5\n")), testing::HasSubstr("service.stale_ms = 5: expected"));
  EXPECT_THAT(refusal(with("[openigtlink]\nport = 70000\n")), testing::HasSubstr("openigtlink.port = 70000"));
  EXPECT_THAT(refusal(with("[recording]\ndurability = \"full\"\n")), testing::HasSubstr("path"));
  EXPECT_THAT(refusal("schema = 1\n"), testing::HasSubstr("catheter"));
  EXPECT_THAT(refusal("schema = 2\n"), testing::HasSubstr("schema = 2"));
}

TEST_F(ServeSettings, NamesMustFitAndDiffer) {
  const auto named = [](const std::string& name) {
    return "[[catheter]]\nname = \"" + name + "\"\nfile = \"c.toml\"\nsource = { kind = \"openigtlink\" }\n";
  };
  EXPECT_THAT(refusal("schema = 1\n" + named("a") + named("a")), testing::HasSubstr("no other catheter has"));
  EXPECT_THAT(refusal("schema = 1\n" + named("ablation-left")), testing::HasSubstr("1 to 11"));
  EXPECT_THAT(refusal("schema = 1\n" + named("a b")), testing::HasSubstr("letters"));
}

TEST_F(ServeSettings, ADeviceIsOfASensorThatIsThere) {
  EXPECT_THAT(refusal("schema = 1\n[[catheter]]\nname = \"a\"\nfile = \"c.toml\"\n"
                      "source = { kind = \"openigtlink\", devices = { tipp = \"X\" } }\n"),
              testing::HasSubstr("\"tipp\""));
}

TEST_F(ServeSettings, SourcesAsTyped) {
  EXPECT_EQ(parse_source("-").kind, Kind::kStandardInput);
  EXPECT_EQ(parse_source("run.tracker.csv").kind, Kind::kFile);
  EXPECT_EQ(parse_source("heart.toml").kind, Kind::kSimulation);
  const SourceSettings server = parse_source("tracker.lab:18944");
  EXPECT_EQ(server.kind, Kind::kOpenIgtLink);
  EXPECT_EQ(server.host, "tracker.lab");
  EXPECT_EQ(server.port, 18944);
  EXPECT_THROW(parse_source("tracker.lab:0"), InputError);
  EXPECT_THROW(parse_source("tracker.lab:port"), InputError);
  write("a:b.csv", "x");
  EXPECT_EQ(parse_source(path("a:b.csv")).kind, Kind::kFile);
}

}  // namespace
}  // namespace palpate::service
