// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <list>
#include <tests/http/served.hpp>
#include <tests/seeded_check.hpp>

namespace palpate::http {
namespace {

using test::eventually;
using test::kToken;
using test::Raw;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// A socket that can do all that a hostile one does, and waits for nothing.
class Hostile {
 public:
  explicit Hostile(std::uint16_t port, int receive_bytes = 0) : socket_(io_) {
    socket_.open(test::Tcp::v4());
    if (receive_bytes > 0) socket_.set_option(boost::asio::socket_base::receive_buffer_size(receive_bytes));
    socket_.connect(test::Tcp::endpoint(boost::asio::ip::address_v4::loopback(), port));
    socket_.non_blocking(true);
  }
  void say(const std::string& text) {
    boost::system::error_code ignored;
    socket_.write_some(boost::asio::buffer(text), ignored);
  }
  bool is_closed() {
    char byte[256];
    boost::system::error_code error;
    do socket_.read_some(boost::asio::buffer(byte), error);
    while (!error);
    return error != boost::asio::error::would_block;
  }

 private:
  boost::asio::io_context io_;
  test::Tcp::socket socket_;
};

class HttpLimits : public test::Served {};

/// A request is given so long as a whole, not each of its bytes. With PALPATE_LONG as long as the program gives it.
TEST_F(HttpLimits, WhatDripsIsClosedInTime) {
  ServerOptions options = defaults();
  if (std::getenv("PALPATE_LONG") == nullptr) options.times.request_s = 2.0;
  const double longest_s = options.times.request_s;
  start(options);
  const auto begin = std::chrono::steady_clock::now();
  Hostile silent(port()), header(port()), body(port()), done(port());
  body.say(text("POST", "/api/x", bearer() + "Content-Type: application/json\r\nContent-Length: 60000\r\n"));
  header.say("GET / HTTP/1.1\r\nA: ");
  done.say(text("GET", "/", bearer()));
  for (double last_s = 0.0; last_s < longest_s - 0.5; last_s = seconds_since(begin)) {
    EXPECT_FALSE(silent.is_closed() || header.is_closed() || body.is_closed()) << last_s;
    header.say("x");
    body.say("x");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(eventually([&] {
    header.say("x");
    body.say("x");
    return silent.is_closed() && header.is_closed() && body.is_closed();
  }));
  EXPECT_LT(seconds_since(begin), longest_s + 1.0);
  EXPECT_FALSE(done.is_closed()) << "who has shown the token may wait longer for the next request";
  EXPECT_EQ(server().health().timed_out, 3u);
  EXPECT_TRUE(eventually([&] { return server().health().connections == 1; }));
}

TEST_F(HttpLimits, AHandlerThatNeverRepliesAndAnIdleConnectionAreEnded) {
  ServerOptions options = defaults();
  options.times.handler_s = options.times.idle_s = 0.2;
  start(options);
  Raw raw(port());
  EXPECT_EQ(raw.say(text("GET", "/api/never", bearer())).hear().status, 503);
  EXPECT_EQ(raw.say(text("GET", "/api/x", bearer())).hear().status, 200) << "the next request";
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(raw.is_closed());
  EXPECT_LT(seconds_since(begin), 1.0);
}

/// As long as its size allows, then no longer.
TEST_F(HttpLimits, AnAnswerThatIsNotTakenIsGivenUp) {
  const std::string body(150'000, 'x');
  other_answer_ = [&](const Request&, const Server::Reply& reply) { reply({200, body}); };
  ServerOptions options = defaults();
  options.times.request_s = 0.1;
  start(options);
  Hostile never(port(), 4096);
  const auto begin = std::chrono::steady_clock::now();
  never.say(text("GET", "/api/large", bearer()));
  EXPECT_EQ(asked("GET", "/api/large").body, body + "\n") << "the others are served meanwhile";
  EXPECT_TRUE(eventually([&] { return server().health().connections == 0; }));
  EXPECT_GT(seconds_since(begin), 2.0);
  EXPECT_LT(seconds_since(begin), 3.0);
}

/// Timers that are due when it is told to stop do not keep it.
TEST_F(HttpLimits, StopsWhileItIsBusy) {
  std::atomic<bool> busy = false;
  other_answer_ = [&](const Request&, const Server::Reply& reply) {
    busy = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    reply({200, "{}"});
  };
  ServerOptions options = defaults();
  options.times.request_s = 0.1;
  start(options);
  Raw raw(port());
  raw.say(text("GET", "/api/x", bearer()));
  EXPECT_TRUE(eventually([&] { return busy.load(); }));
  finish();
}

TEST_F(HttpLimits, AFloodLeavesRoomForWhoHasTheToken) {
  start();
  std::list<Hostile> flood;
  const std::clock_t before = std::clock();
  for (int i = 0; i < 300; ++i) {
    flood.emplace_back(port());
    if (i % 2 == 0) flood.back().say("GET / HTTP/1.1\r\nA: ");
    if (i % 50 == 49) {
      EXPECT_EQ(asked("GET", "/").status, 200) << i;
      EXPECT_LE(server().health().connections, 64u);
    }
  }
  const double processor_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  EXPECT_LT(processor_s, 0.5) << "of both sides";
  EXPECT_TRUE(eventually([&] { return server().health().accepted == 306; }));
  EXPECT_GE(server().health().refused, 300u + 6u - 64u - 6u);
  EXPECT_LE(server().health().connections, 64u);
  EXPECT_FALSE(flood.back().is_closed());
  EXPECT_TRUE(flood.front().is_closed());
}

TEST_F(HttpLimits, WhoHasShownTheTokenIsNotPushedOut) {
  ServerOptions options = defaults();
  options.most_connections = 8;
  start(options);
  std::list<Raw> known;
  for (int i = 0; i < 8; ++i) {
    known.emplace_back(port());
    EXPECT_EQ(known.back().say(text("GET", "/", bearer())).hear().status, 200);
  }
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(Raw(port()).is_closed());
  EXPECT_EQ(server().health().refused, 20u);
  for (Raw& each : known) EXPECT_EQ(each.say(text("GET", "/", bearer())).hear().status, 200);
  known.pop_front();
  EXPECT_TRUE(eventually([&] { return server().health().connections == 7; }));
  EXPECT_EQ(asked("GET", "/").status, 200);
}

/// Somebody opens connections as fast as they come, ten thousand in some seconds with PALPATE_LONG.
TEST_F(HttpLimits, APersonGetsInWhileConnectionsPourIn) {
  start();
  std::atomic<bool> over = false;
  std::atomic<int> opened = 0;
  std::thread attacker([&] {
    std::list<Hostile> held;
    while (!over) {
      held.emplace_back(port());
      ++opened;
      if (held.size() > 200) held.pop_front();
      std::this_thread::sleep_for(std::chrono::microseconds(400));
    }
  });
  int in = 0;
  const auto begin = std::chrono::steady_clock::now();
  const int tries = std::getenv("PALPATE_LONG") != nullptr ? 200 : 20;
  for (int i = 0; i < tries; ++i) {
    in += asked("GET", "/dashboard.js").status == 200 ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  over = true;
  attacker.join();
  EXPECT_EQ(in, tries) << opened << " others in " << seconds_since(begin) << " s";
  EXPECT_GT(opened, 128) << "more than twice the places, or it is no flood";
}

TEST_F(HttpLimits, RandomBytesDoNoHarm) {
  start();
  palpate::test::seeded_check(
      "the server answers after random bytes",
      [this](const std::string& noise, unsigned char kind) {
        Hostile hostile(port());
        const std::string head = "POST /api/x HTTP/1.1\r\nHost: localhost\r\n" + bearer();
        switch (kind % 5) {
          case 0:
            hostile.say(noise);
            break;
          case 1:
            hostile.say("GET / HTTP/1.1\r\n" + noise + "\r\n\r\n");
            break;
          case 2:
            hostile.say("GET " + noise + " HTTP/1.1\r\nHost: localhost\r\n" + bearer() + "\r\n");
            break;
          case 3:
            hostile.say(head + "Transfer-Encoding: chunked\r\n\r\n" + noise);
            break;
          default:
            hostile.say("GET /live HTTP/1.1\r\nHost: localhost\r\n" + bearer() +
                        "Connection: upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n");
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            hostile.say(noise);
        }
        RC_ASSERT(asked("GET", "/api/x").status == 200);
      },
      300);
  EXPECT_GT(server().health().malformed, 100u);
  EXPECT_LE(server().health().connections, 64u);
}

}  // namespace
}  // namespace palpate::http
