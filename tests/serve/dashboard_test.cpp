// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <tests/serve/frame_player.hpp>
#include <tests/serve/page_client.hpp>
#include <tests/serve/raw_client.hpp>
#include <tests/serve/serve_fixture.hpp>

/// What the page in the browser is told by the real program, and what others do at its port (FAULTS 12, 14).
namespace palpate::serve_test {
namespace {

constexpr double kRate_hz = 250.0;

class ServeDashboard : public Serve {
 protected:
  void SetUp() override {
    Serve::SetUp();
    program_ = serve();
    wire_ = virtual_wire(catheter_.catheter, kRate_hz, 10.0).frames;
  }
  /// Status of the answer to this request; 0 where it is closed without one.
  int answer(const std::string& head, const std::string& body = "") const {
    boost::asio::ip::tcp::iostream stream;
    stream.expires_after(std::chrono::seconds(8));
    stream.connect(boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4::loopback(),
                                                  static_cast<std::uint16_t>(program_->dashboard_port())));
    stream << head << "\r\n" << body << std::flush;
    std::string line;
    std::getline(stream, line);
    return line.size() > 12 ? std::stoi(line.substr(9, 3)) : 0;
  }
  std::string bearer() const { return "Authorization: Bearer " + program_->token() + "\r\n"; }
  std::string upgrade(const std::string& more) const {
    return "GET /live HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           more;
  }
  /// Connects as a page does, then reads only what it is asked to.
  std::unique_ptr<RawClient> deaf() const {
    auto out = std::make_unique<RawClient>(program_->dashboard_port(), 4096);
    const std::string text = upgrade("Host: 127.0.0.1\r\n" + bearer()) + "\r\n";
    out->send(std::as_bytes(std::span(text)));
    return out;
  }
  std::unique_ptr<ServeProcess> program_;
  WireFrames wire_;
};

TEST_F(ServeDashboard, ThePageHearsForcesHealthAndEvents) {
  PageClient page(*program_);
  ASSERT_TRUE(eventually([&] { return !page.hello().is_null(); }, 2.0));
  EXPECT_EQ(page.hello()["catheters"][0]["name"], "c");
  EXPECT_FALSE(page.hello()["catheters"][0]["simulated"]);
  FramePlayer player(plus_, wire_, kRate_hz);
  ASSERT_TRUE(eventually([&] { return page.rows() > 100; }, 5.0));
  EXPECT_EQ(page.latest("shown"), 1.0);
  EXPECT_TRUE(std::isfinite(page.latest("size_N")));
  EXPECT_EQ(program_->post("/api/notes", {{"text", "hello"}})["http"], 200);
  ASSERT_TRUE(
      eventually([&] { return !page.texts("event").empty() && page.texts("event").back()["event"] == "note"; }, 2.0));
  EXPECT_EQ(page.texts("event").back()["data"]["text"], "hello");
  page.say({{"ping", 7}});
  ASSERT_TRUE(eventually([&] { return !page.texts("pong").empty(); }, 2.0));
  player.stop();
  const Clock::time_point last = Clock::now();
  ASSERT_TRUE(eventually([&] { return page.latest("state") == 3.0; }, 1.0));
  EXPECT_LT(seconds_since(last), 0.2) << "silence is told late";
  EXPECT_TRUE(std::isnan(page.latest("size_N")));
  const auto latencies = page.latencies_s();
  RecordProperty("to_the_page", fmt::format("p50 {:.2f} ms, p95 {:.2f} ms", 1e3 * percentile_s(latencies, 0.5),
                                            1e3 * percentile_s(latencies, 0.95)));
  ASSERT_TRUE(eventually([&] { return page.texts("status").back()["catheters"][0]["state"] == "STALE"; }, 1.0));
}

/// Row 12: one that reads nothing costs the others nothing, and is gone within ten seconds.
TEST_F(ServeDashboard, APageThatNeverReadsIsDropped) {
  PageClient page(*program_);
  const auto stuck = deaf();
  ASSERT_TRUE(eventually([&] { return program_->health()["dashboard"]["clients"] == 2; }, 2.0));
  const double memory_MB = program_->memory_MB();
  const Clock::time_point start = Clock::now();
  FramePlayer player(plus_, wire_, kRate_hz);
  health_when(
      *program_, [](const auto& h) { return h["dashboard"]["closed_stuck"] == 1; }, 30.0);
  const double dropped_s = seconds_since(start);
  RecordProperty("dropped_after_s", fmt::format("{:.1f}", dropped_s));
  EXPECT_LT(dropped_s, 10.0);
  // 60 a second at most of 250: one each five frames (20 ms), or each four where frames come a little late.
  EXPECT_GE(static_cast<double>(page.rows()), 0.99 * 50.0 * (dropped_s - 0.2));
  const std::size_t sent = player.stop().size();
  health_when(
      *program_, [&](const auto& h) { return h["catheters"][0]["frames"] == sent; }, 2.0);
  EXPECT_FALSE(page.closed());
  EXPECT_LT(program_->memory_MB(), memory_MB + 20.0);
}

/// Row 14: refused, counted, said, and nothing leaks.
TEST_F(ServeDashboard, StrangersAreRefused) {
  const std::string own = "Host: 127.0.0.1\r\n", close = "Connection: close\r\n";
  const std::string wrong = "Authorization: Bearer 00000000000000000000000000000000\r\n";
  PageClient page(*program_);
  ASSERT_TRUE(eventually([&] { return !page.hello().is_null(); }, 2.0));
  const std::size_t descriptors = program_->descriptors();
  EXPECT_EQ(answer("GET /api/health HTTP/1.1\r\n" + own + close), 401);
  EXPECT_EQ(answer("GET / HTTP/1.1\r\n" + own + close), 401);
  EXPECT_EQ(answer("GET /api/health HTTP/1.1\r\n" + own + wrong + close), 401);
  EXPECT_EQ(answer("GET /api/health?token= HTTP/1.1\r\n" + own + close), 401);
  EXPECT_EQ(answer("GET /api/health HTTP/1.1\r\nHost: evil.example\r\n" + bearer() + close), 403);
  EXPECT_EQ(answer("GET /api/health HTTP/1.1\r\n" + own + "Origin: http://evil.example\r\n" + bearer() + close), 403);
  EXPECT_EQ(answer(upgrade(own)), 401);
  EXPECT_EQ(answer(upgrade(own + wrong)), 401);
  EXPECT_EQ(answer(upgrade(own + "Origin: http://evil.example\r\n" + bearer())), 403);
  EXPECT_EQ(answer(upgrade(own + "Origin: null\r\n" + bearer())), 403);
  EXPECT_EQ(answer(upgrade("Host: 192.0.2.1\r\n" + bearer())), 403);
  EXPECT_EQ(answer("GET /api/health?token=" + program_->token() + " HTTP/1.1\r\n" + own + close), 200);
  EXPECT_EQ(answer(upgrade(own + bearer())), 101);
  const auto health = health_when(
      *program_, [](const auto& h) { return h["dashboard"]["clients"] == 1; }, 5.0);
  EXPECT_TRUE(eventually([&] { return !page.texts("event").empty(); }, 2.0));
  EXPECT_EQ(page.texts("event").back()["event"], "stranger refused") << "it is an event of the recording";
  EXPECT_EQ(health["dashboard"]["unauthorized"], 6);
  EXPECT_EQ(health["dashboard"]["forbidden"], 5);
  EXPECT_EQ(health.dump().find(program_->token()), std::string::npos);
  EXPECT_EQ(program_->err().find(program_->token()), std::string::npos);
  EXPECT_TRUE(eventually([&] { return program_->descriptors() <= descriptors; }, 5.0)) << program_->descriptors();
}

/// Row 14: what is too large closes that connection and no other.
TEST_F(ServeDashboard, OversizedFramesCloseTheirOwnConnection) {
  PageClient page(*program_);
  const std::string own = "Host: 127.0.0.1\r\n" + bearer();
  const auto head = [&](std::size_t bytes) {
    return "POST /api/notes HTTP/1.1\r\n" + own +
           "Content-Type: application/json\r\nContent-Length: " + std::to_string(bytes) + "\r\n";
  };
  const auto note = [](std::size_t bytes) { return "{\"text\": \"" + std::string(bytes - 12, 'x') + "\"}"; };
  EXPECT_EQ(answer(head(70000), note(70000)), 413);
  EXPECT_EQ(answer(head(1ULL << 40)), 413);
  EXPECT_NE(answer("GET /api/health HTTP/1.1\r\n" + own + "X-Long: " + std::string(20000, 'x') + "\r\n"), 200);
  // A WebSocket frame that says it has 2^40 bytes.
  const auto liar = deaf();
  ASSERT_TRUE(eventually([&] { return program_->health()["dashboard"]["clients"] == 2; }, 2.0));
  const std::string frame = std::string("\x81\xff\x00\x00\x01\x00\x00\x00\x00\x00", 10) + std::string(4, '\0') + "lies";
  liar->send(std::as_bytes(std::span(frame)));
  EXPECT_TRUE(liar->closed_within(5.0));
  EXPECT_FALSE(page.closed());
  EXPECT_EQ(program_->catheter()["state"], "WAITING");
}

/// What a client says is work for the thread that serves everybody: who talks without end is closed.
TEST_F(ServeDashboard, AChattererIsClosed) {
  const PageClient page(*program_);
  PageClient chatterer(*program_);
  const auto chatters = [&] {
    try {
      for (int i = 0; i < 100000; ++i) chatterer.say({{"ping", i}});
    } catch (const std::exception&) {
      return false;
    }
    return true;
  };
  EXPECT_FALSE(chatters());
  EXPECT_TRUE(eventually([&] { return chatterer.closed(); }, 5.0));
  EXPECT_LE(chatterer.texts("pong").size(), 200U);
  EXPECT_FALSE(page.closed());
}

/// "The latest second" of a source that has fallen silent is long ago.
TEST_F(ServeDashboard, ASilentCatheterIsNotTared) {
  EXPECT_EQ(program_->post("/api/catheters/c/tare", {{"seconds", 1}})["http"], 409);
  FramePlayer player(plus_, wire_, kRate_hz);
  health_when(
      *program_, [](const auto& h) { return h["catheters"][0]["state"] == "LIVE"; }, 5.0);
  player.stop();
  health_when(
      *program_, [](const auto& h) { return h["catheters"][0]["state"] == "STALE"; }, 2.0);
  const auto answer = program_->post("/api/catheters/c/tare", {{"seconds", 1}});
  EXPECT_EQ(answer["http"], 409);
  EXPECT_NE(answer["error"].get<std::string>().find("STALE"), std::string::npos) << answer.dump();
  EXPECT_EQ(program_->post("/api/catheters/c/tare", {{"straight", 1}})["http"], 409);
  EXPECT_EQ(program_->post("/api/notes", {{"text", "x"}, {"catheter", 5}})["error"].get<std::string>().find("json"),
            std::string::npos);
}

/// A day in the life of a page: opened and closed again, nothing is left behind.
TEST_F(ServeDashboard, PagesComeAndGo) {
  FramePlayer player(plus_, wire_, kRate_hz);
  for (int i = 0; i < 3; ++i) PageClient(*program_).say({{"ping", 1}});
  ASSERT_TRUE(eventually([&] { return program_->health()["dashboard"]["clients"] == 0; }, 5.0));
  const std::size_t descriptors = program_->descriptors(), threads = program_->threads();
  const int times = in_full() ? 1000 : 50;
  for (int i = 0; i < times; ++i) PageClient(*program_).say({{"ping", 1}});
  ASSERT_TRUE(eventually([&] { return program_->health()["dashboard"]["clients"] == 0; }, 5.0));
  EXPECT_LE(program_->descriptors(), descriptors);
  EXPECT_EQ(program_->threads(), threads);
  player.stop();
  program_->signal(SIGTERM);
  EXPECT_EQ(program_->wait(3.0), 0) << program_->err();
}

}  // namespace
}  // namespace palpate::serve_test
