// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <future>
#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/service/service.hpp>
#include <palpate/session/reader.hpp>
#include <palpate/session/replay.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/service/demo_frames.hpp>
#include <thread>

namespace palpate::service {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

/// A whole service in this process, so that a thread sanitizer sees all its threads.
class WholeService : public test::TemporaryFolder {
 protected:
  /// `uncertain`: the bend of the catheter is not known exactly, so that a tare has something to find.
  Settings settings(double speed, double duration_s = 2.0, bool uncertain = false) const {
    Settings out = demo_settings();
    if (uncertain) {
      std::string text = out.catheters[0].toml;
      text.insert(text.find("precurvature_per_m"), "precurvature_sigma_per_m = [1.0, 1.0, 0.0]\n");
      out.catheters[0] = read_catheter("demo", write("demo.toml", text));
    }
    OutputFile file(path("run.csv"));
    write_tracker_csv(file, out.catheters[0].settings.catheter, test::demo_frames(duration_s));
    file.commit();
    out.catheters[0].source = {.kind = SourceSettings::Kind::kFile, .path = path("run.csv"), .speed = speed};
    out.link.port = out.dashboard.server.port = 0;
    out.dashboard.server.token = kToken;
    out.recording.path = path("s.palpate");
    return out;
  }
};

std::string http(std::uint16_t port, const std::string& request) {
  namespace asio = boost::asio;
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect({asio::ip::address_v4::loopback(), port});
  asio::write(socket, asio::buffer(request));
  std::string answer;
  boost::system::error_code end;
  asio::read(socket, asio::dynamic_buffer(answer), end);
  return answer;
}

std::string get(std::uint16_t port, const std::string& target, const std::string& more = "Host: 127.0.0.1\r\n") {
  return http(port, "GET " + target + " HTTP/1.1\r\nAuthorization: Bearer " + kToken + "\r\n" + more +
                        "Connection: close\r\n\r\n");
}

std::string post(std::uint16_t port, const std::string& target, const std::string& body,
                 const std::string& more = "Content-Type: application/json\r\n") {
  return http(port, "POST " + target + " HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer " + kToken + "\r\n" +
                        more + "Connection: close\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
                        body);
}

int status_of(const std::string& answer) { return std::stoi(answer.substr(9, 3)); }
nlohmann::json body_of(const std::string& answer) {
  return nlohmann::json::parse(answer.substr(answer.find("\r\n\r\n") + 4), nullptr, false);
}

TEST_F(WholeService, AFinishedFileIsEstimatedRecordedAndEnds) {
  Service service(settings(0.0));
  service.run();
  const nlohmann::json health = service.finish();
  EXPECT_EQ(health["catheters"][0]["frames"], 80);
  EXPECT_EQ(health["recording"]["committed_frames"], 80);
  EXPECT_EQ(health["recording"]["dropped"], 0);

  session::SessionReader reader(path("s.palpate"));
  ForceObserver offline(test::demo_catheter().settings.catheter, test::demo_catheter().settings.observer);
  session::LiveRecord record;
  int frames = 0;
  while (reader.next(record)) {
    if (record.kind != session::LiveRecord::Kind::kFrame) continue;
    EXPECT_EQ(record.estimate.force_tip_N, offline.update(record.frame).force_tip_N) << frames;
    ++frames;
  }
  EXPECT_EQ(frames, 80);
}

TEST_F(WholeService, TheOperatorIsAnsweredAndRecorded) {
  Settings what = settings(1.0, 3.0, true);
  Service service(what);
  const std::uint16_t port = service.dashboard_port();
  auto talk = std::async(std::launch::async, [port] {
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    std::vector<std::string> answers;
    answers.push_back(get(port, "/api/health"));
    answers.push_back(post(port, "/api/catheters/demo/tare", R"({"seconds": 0.3})"));
    answers.push_back(post(port, "/api/notes", R"({"text": "contact"})"));
    answers.push_back(
        post(port, "/api/catheters/demo/base", R"({"position_mm": [0, 0, 0], "quaternion_wxyz": [1, 0, 0, 0]})"));
    answers.push_back(
        post(port, "/api/catheters/demo/base", R"({"position_mm": [0, 0], "quaternion_wxyz": [1, 0, 0, 0]})"));
    answers.push_back(post(port, "/api/catheters/demo/tendon", R"({"moment_Nm": [0, 0]})"));
    answers.push_back(post(port, "/api/catheters/nobody/tare", "{}"));
    answers.push_back(post(port, "/api/notes", "not JSON"));
    answers.push_back(post(port, "/api/notes", R"({"text": "x"})", ""));
    answers.push_back(get(port, "/api/health", "Host: example.org\r\n"));
    answers.push_back(get(port, "/api/health", "Host: 127.0.0.1\r\nOrigin: http://example.org\r\n"));
    answers.push_back(get(port, "/"));
    return answers;
  });
  service.run();
  service.finish();
  const std::vector<std::string> answers = talk.get();
  std::vector<int> statuses;
  for (const std::string& answer : answers) statuses.push_back(status_of(answer));
  EXPECT_EQ(statuses, (std::vector<int>{200, 200, 200, 200, 400, 409, 404, 400, 415, 403, 403, 404}));
  EXPECT_EQ(body_of(answers[0])["catheters"][0]["state"], "LIVE");

  session::SessionReader reader(path("s.palpate"));
  session::LiveRecord record;
  std::vector<std::string> events;
  while (reader.next(record))
    if (record.kind == session::LiveRecord::Kind::kEvent) events.push_back(record.event);
  // A tare under load is inconsistent, a computer that is busy makes the source stale.
  // Strangers are told of once a second, maybe not before the end.
  std::erase_if(events, [](const std::string& e) {
    return e.ends_with("consistent") || e == "stale" || e == "live" || e == "stranger refused";
  });
  EXPECT_EQ(events, (std::vector<std::string>{"tare", "note", "base"}));
  const session::ReplayReport replay = session::replay(path("s.palpate"));
  EXPECT_TRUE(replay.identical());
  EXPECT_EQ(replay.observers, 3u);  // as it began, tared, registered anew
}

TEST_F(WholeService, WhatCannotBeLeavesNoRecording) {
  Settings what = settings(0.0);
  const Service first(what);
  what.recording.path = path("other.palpate");
  what.link.port = first.link_port();
  EXPECT_THROW(Service{what}, InputError);
  EXPECT_FALSE(std::filesystem::exists(path("other.palpate")));
}

TEST_F(WholeService, TheReferenceOfTheFileIsUsedOnceItIsOver) {
  Settings what = settings(1.0, 1.0, true);
  what.catheters[0].settings.reference = {.given = true, .from_s = 0.0, .to_s = 0.5};
  Service service(what);
  service.run();
  service.finish();
  session::SessionReader reader(path("s.palpate"));
  session::LiveRecord record;
  int tares = 0, frames_before = 0;
  while (reader.next(record)) {
    tares += record.event == "tare" && record.kind == session::LiveRecord::Kind::kEvent ? 1 : 0;
    if (tares == 0) ++frames_before;
  }
  EXPECT_EQ(tares, 1);
  EXPECT_GE(frames_before, 20);
}

}  // namespace
}  // namespace palpate::service
