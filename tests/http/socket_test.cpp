// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <tests/http/web_client.hpp>  // before others, for Beast's sake
//
#include <boost/asio/write.hpp>

namespace palpate::http {
namespace {

using test::eventually;
using test::kToken;
using test::WebClient;
using Texts = std::vector<std::string>;

Message message(std::string bytes, bool binary = false, bool droppable = false) {
  return {std::make_shared<const std::string>(std::move(bytes)), binary, droppable};
}

class HttpSocket : public test::Served {
 protected:
  std::unique_ptr<WebClient> connect(ClientId* id, int receive_bytes = 0) {
    std::unique_ptr<WebClient> client;
    *id = next_client([&] {
      client = std::make_unique<WebClient>(port(), WebClient::Headers{{"Authorization", "Bearer " + kToken}}, "/live",
                                           receive_bytes);
    });
    EXPECT_FALSE(client->error()) << client->error().message();
    return client;
  }
};

TEST_F(HttpSocket, CarriesTextAndBytesBothWays) {
  start();
  ClientId id = 0;
  const auto client = connect(&id);
  server().send(id, message("hello"));
  server().send(id, message(std::string("\0\1\xff", 3), true));
  server().send(id, message(std::string(3 << 20, 'x'), true));
  EXPECT_EQ(client->hear(), "hello");
  EXPECT_FALSE(client->is_binary());
  EXPECT_EQ(client->hear(), std::string("\0\1\xff", 3));
  EXPECT_TRUE(client->is_binary());
  EXPECT_EQ(client->hear(), std::string(3 << 20, 'x')) << "a long history comes whole";
  EXPECT_TRUE(client->say("{\"watch\":1}"));
  EXPECT_TRUE(eventually([&] { return events().size() == 2; }));
  EXPECT_EQ(events(), (Texts{"1 opened", "1 text {\"watch\":1}"}));
  const ServerHealth health = server().health();
  EXPECT_EQ(health.clients, 1u);
  EXPECT_EQ(health.connections, 1u);
  EXPECT_EQ(health.sent, 3u);
}

TEST_F(HttpSocket, OpenedTextClosedInThisOrderAndOnce) {
  start();
  for (int i = 0; i < 3; ++i) {
    ClientId id = 0;
    const auto client = connect(&id);
    client->say("x");
    if (i == 1) client->tcp().socket().close();
  }
  EXPECT_TRUE(eventually([&] { return server().health().clients == 0 && server().health().connections == 0; }));
  finish();
  Texts expected;
  for (const char* id : {"1", "2", "3"})
    for (const char* what : {" opened", " text x", " closed"}) expected.push_back(std::string(id) + what);
  EXPECT_THAT(events(), ::testing::UnorderedElementsAreArray(expected));
  for (int i = 0; i < 3; ++i) {
    const auto place = [&, all = events()](const char* what) {
      return std::ranges::find(all, std::to_string(i + 1) + what) - all.begin();
    };
    EXPECT_LT(place(" opened"), place(" text x"));
    EXPECT_LT(place(" text x"), place(" closed"));
  }
}

TEST_F(HttpSocket, IsGuardedAsEverythingElse) {
  start();
  const std::pair<std::string, std::string> token{"Authorization", "Bearer " + kToken};
  const auto status = [&](const WebClient::Headers& headers, const std::string& target = "/live") {
    return WebClient(port(), headers, target).status();
  };
  EXPECT_EQ(status({{"Host", "example.org"}, token}), 403);
  EXPECT_EQ(status({{"Origin", "http://example.org"}, token}), 403);
  EXPECT_EQ(status({{"Origin", "null"}, token}), 403);
  EXPECT_EQ(status({}), 401);
  EXPECT_EQ(status({}, "/live?token=x"), 401);
  EXPECT_EQ(status({token}, "/other"), 404);
  EXPECT_EQ(status({token, {"Sec-WebSocket-Version", "99"}}), 426);
  EXPECT_TRUE(events().empty());
  EXPECT_EQ(status({{"Origin", "http://localhost"}, {"Cookie", "palpate_" + std::to_string(port()) + "=" + kToken}}),
            101);
  EXPECT_EQ(status({}, "/live?token=" + kToken), 101);
  const WebClient own(port());
  EXPECT_EQ(own.header("Server"), "palpate");
  EXPECT_EQ(own.header("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(own.header("Sec-WebSocket-Extensions"), "") << "nothing is compressed";
}

TEST_F(HttpSocket, ClosesWhoSendsWhatIsNotUnderstood) {
  start();
  ClientId id = 0;
  const auto fine = connect(&id);
  const auto binary = connect(&id);
  binary->say("x", true);
  EXPECT_FALSE(binary->hear());
  EXPECT_EQ(binary->close_code(), 1003);
  const auto large = connect(&id);
  large->say(std::string(Server::kMostTextBytes + 1, 'x'));
  EXPECT_FALSE(large->hear());
  EXPECT_EQ(large->close_code(), 1009);
  // A frame that claims 2^62 bytes; one with reserved bits; one that is not masked; text that is no UTF-8.
  for (const std::string& frame : {std::string("\x81\xff\x40\0\0\0\0\0\0\0mask", 14), std::string("\xf1\x81masky", 7),
                                   std::string("\x81\x01y", 3), std::string("\x81\x81\0\0\0\0\xff", 7)}) {
    const auto hostile = connect(&id);
    boost::asio::write(hostile->tcp(), boost::asio::buffer(frame));
    EXPECT_FALSE(hostile->hear());
    EXPECT_TRUE(eventually([&] { return server().health().clients == 1; }));
  }
  EXPECT_EQ(server().health().malformed, 6u);
  EXPECT_TRUE(fine->say(std::string(Server::kMostTextBytes, 'x')));
  server().send(1, message("still here"));
  EXPECT_EQ(fine->hear(), "still here");
}

TEST_F(HttpSocket, ASlowClientGetsTheNewestRows) {
  ServerOptions options = defaults();
  options.times.stuck_s = 60.0;
  start(options);
  ClientId id = 0;
  const auto slow = connect(&id, 4096);
  const std::string padding(100'000, ' ');
  constexpr int kRows = 60;
  for (int row = 0; row < kRows; ++row) server().send(id, message(std::to_string(row) + padding, true, true));
  server().send(id, message("event"));
  EXPECT_TRUE(eventually([&] { return server().health().dropped > 0; }));
  std::vector<int> rows;
  for (auto heard = slow->hear(); heard && *heard != "event"; heard = slow->hear()) rows.push_back(std::stoi(*heard));
  EXPECT_TRUE(std::ranges::is_sorted(rows));
  ASSERT_GE(rows.size(), Server::kMostWaitingRows);
  EXPECT_LT(rows.size(), 20u);
  for (std::size_t i = 0; i < Server::kMostWaitingRows; ++i)
    EXPECT_EQ(rows[rows.size() - 1 - i], kRows - 1 - static_cast<int>(i)) << "the newest ones";
  EXPECT_EQ(server().health().dropped, kRows - rows.size());
}

TEST_F(HttpSocket, WhoLetsTooMuchWaitIsClosed) {
  start();
  ClientId id = 0;
  const auto never = connect(&id);
  const Message megabyte = message(std::string(1 << 20, 'x'));
  for (int i = 0; i < 32; ++i) server().send(id, megabyte);
  EXPECT_TRUE(eventually([&] { return server().health().clients == 0; }, 1.0));
  EXPECT_EQ(server().health().closed_stuck, 1u);
}

/// Rows of the size and at the rate of the page's. With PALPATE_LONG it waits as long as the program does.
TEST_F(HttpSocket, WhoNeverReadsIsClosedAndTheOthersNoticeNothing) {
  ServerOptions options = defaults();
  if (std::getenv("PALPATE_LONG") == nullptr) options.times.stuck_s = 1.0;
  const double longest_s = 10.0 - (Server::kStuck_s - options.times.stuck_s);
  start(options);
  ClientId idle_id = 0, id = 0;
  const auto never = connect(&idle_id);
  const auto reader = connect(&id);
  std::size_t sent = 0, heard = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::thread sender([&] {
    while (server().health().closed_stuck == 0 && std::chrono::steady_clock::now() - begin < std::chrono::seconds(11)) {
      for (const ClientId each : {idle_id, id}) server().send(each, message(std::string(2000, 'x'), true, true));
      ++sent;
      std::this_thread::sleep_for(std::chrono::milliseconds(16));
    }
    server().send(id, message("end"));
  });
  for (auto text = reader->hear(); text && *text != "end"; text = reader->hear()) ++heard;
  sender.join();
  EXPECT_EQ(server().health().closed_stuck, 1u);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::duration<double>(longest_s));
  EXPECT_EQ(server().health().clients, 1u);
  EXPECT_GE(static_cast<double>(heard), 0.99 * static_cast<double>(sent));
}

TEST_F(HttpSocket, WhoIsSilentWhenAskedIsGone) {
  ServerOptions options = defaults();
  options.times.silent_s = 0.3;
  start(options);
  ClientId id = 0;
  const auto dead = connect(&id);  // reads nothing, so it answers no ping
  EXPECT_TRUE(eventually([&] { return server().health().clients == 0; }, 2.0));
  const auto alive = connect(&id);
  EXPECT_FALSE(alive->hear(1.0)) << "it answers pings meanwhile";
  EXPECT_EQ(server().health().clients, 1u);
}

TEST_F(HttpSocket, StopsWithClientsConnected) {
  start();
  ClientId a = 0, b = 0;
  const auto one = connect(&a), two = connect(&b);
  test::Raw http(port());
  http.say("GET / HT");
  for (int i = 0; i < 100; ++i) server().send(a, message(std::string(100'000, 'x'), true, i % 2 == 0));
  const auto begin = std::chrono::steady_clock::now();
  finish();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_THAT(events(), ::testing::UnorderedElementsAre("1 opened", "2 opened", "1 closed", "2 closed"));
  EXPECT_FALSE(two->hear());
}

TEST_F(HttpSocket, ManyThreadsMaySend) {
  start();
  ClientId id = 0;
  const auto client = connect(&id);
  std::vector<std::thread> senders;
  for (char letter : {'a', 'b', 'c'})
    senders.emplace_back([&, letter] {
      for (int i = 0; i < 300; ++i) server().send(id, message(letter + std::to_string(i)));
    });
  std::map<char, int> next;
  for (int i = 0; i < 900; ++i) {
    const auto text = client->hear();
    ASSERT_TRUE(text);
    EXPECT_EQ(std::stoi(text->substr(1)), next[(*text)[0]]++);
  }
  for (std::thread& sender : senders) sender.join();
}

}  // namespace
}  // namespace palpate::http
