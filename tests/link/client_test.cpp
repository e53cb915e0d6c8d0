// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <igtlServerSocket.h>
#include <igtlTransformMessage.h>

#include <optional>
#include <palpate/link/client.hpp>
#include <palpate/math/errors.hpp>
#include <tests/link/library_peer.hpp>
#include <tests/link/loopback.hpp>
#include <thread>

/// The client over real sockets on loopback: rows 9 and 10 of the list of faults, and whatever else a server may do.
namespace palpate::link::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class LinkClient : public ::testing::Test {
 protected:
  Client& start(const ClientOptions& options) {
    client_.emplace(io_, options,
                    Client::Handlers{[this](const Message& message) { messages_.push_back(message); },
                                     [this](bool connected, const std::string& why) {
                                       states_.push_back(connected ? "connected" : why);
                                     }});
    client_->start();
    return *client_;
  }

  static ClientOptions options(std::uint16_t port) {
    ClientOptions options;
    options.port = port;
    return options;
  }

  bool until(const std::function<bool()>& holds, double longest_s = 5.0) { return run_until(io_, holds, longest_s); }

  boost::asio::io_context io_;
  std::vector<Message> messages_;
  std::vector<std::string> states_;
  std::optional<Client> client_;
};

/// A port on which nobody listens.
std::uint16_t free_port(boost::asio::io_context& io) {
  return Tcp::acceptor(io, {boost::asio::ip::address_v4::loopback(), 0}).local_endpoint().port();
}

void send(const std::shared_ptr<Tcp::socket>& socket, const Bytes& bytes) {
  boost::asio::write(*socket, boost::asio::buffer(bytes));
}

TEST_F(LinkClient, ReadsAServerOfTheLibrary) {
  const auto server = igtl::ServerSocket::New();
  ASSERT_EQ(server->CreateServer(0), 0);
  std::thread peer([&server] {
    const auto socket = server->WaitForConnection(5000);
    if (socket.IsNull()) return;
    for (int i = 0; i < 100; ++i) {
      const auto message = igtl::TransformMessage::New();
      igtl::Matrix4x4 matrix;
      igtl::IdentityMatrix(matrix);
      matrix[0][3] = static_cast<float>(i);
      message->SetMatrix(matrix);
      message->SetDeviceName("TipToTracker");
      message->Pack();
      socket->Send(message->GetPackPointer(), message->GetPackSize());
    }
    char end = 0;
    socket->Receive(&end, 1);  // the request that the client began with
    socket->CloseSocket();
  });
  start(options(static_cast<std::uint16_t>(server->GetServerPort())));
  EXPECT_TRUE(until([this] { return messages_.size() >= 100; }));
  peer.join();
  ASSERT_GE(messages_.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_EQ(std::get<Transform>(messages_[i].body).matrix.columns[9], static_cast<float>(i));
  EXPECT_EQ(client_->health().messages, messages_.size());
  EXPECT_EQ(states_.at(0), "connected");
}

TEST_F(LinkClient, AsksForTrackingInVersionTwo) {
  std::shared_ptr<Reader> reader;
  Acceptor server(io_, [&](const auto& socket) { reader = std::make_shared<Reader>(std::move(*socket)); });
  start(options(server.port()));
  ASSERT_TRUE(until([&] { return reader && !reader->messages.empty(); }));
  EXPECT_EQ(reader->messages[0].version, 2);
  EXPECT_EQ(reader->messages[0].body, Body(StartTracking{}));
}

TEST_F(LinkClient, AsksForNothingWhereToldSo) {
  std::shared_ptr<Reader> reader;
  Acceptor server(io_, [&](const auto& socket) { reader = std::make_shared<Reader>(std::move(*socket)); });
  ClientOptions quiet = options(server.port());
  quiet.ask_for_tracking = false;
  start(quiet);
  ASSERT_TRUE(until([this] { return client_->health().connected; }));
  run_for(io_, 0.1);
  EXPECT_EQ(reader->bytes, 0U);
}

TEST_F(LinkClient, ThousandReconnectsLeaveNothingBehind) {
  const Bytes hello = encoded(example_messages()[0]);
  Acceptor server(io_, [&](const auto& socket) { send(socket, hello); });  // and closes
  ClientOptions eager = options(server.port());
  eager.longest_wait_s = 0.0005;
  client_.emplace(io_, eager, Client::Handlers{});
  client_->start();
  const ClientHealth& health = client_->health();
  ASSERT_TRUE(until([&] { return health.connections >= 20; }));
  const std::size_t descriptors = open_descriptors(), running = threads(), heap = heap_bytes();
  ASSERT_TRUE(until([&] { return health.connections >= 1020; }, 20.0));
  EXPECT_LE(open_descriptors(), descriptors + 2);  // one end may be on its way, or was not when counted
  EXPECT_EQ(threads(), running);
  EXPECT_LE(heap_bytes(), heap + 8192);
  EXPECT_GE(health.messages, 900U);  // one that is reset before it is read may be lost
}

TEST_F(LinkClient, WaitsLongerAndLongerUntilAMessageComes) {
  std::vector<std::chrono::steady_clock::time_point> times;
  const Bytes hello = encoded(example_messages()[0]);
  Acceptor server(io_, [&](const auto& socket) {
    times.push_back(std::chrono::steady_clock::now());
    if (times.size() == 6) send(socket, hello);
  });
  ClientOptions patient = options(server.port());
  patient.longest_wait_s = 0.3;
  patient.ask_for_tracking = false;  // else the request may reset the connection before the greeting is read
  start(patient);
  ASSERT_TRUE(until([&] { return times.size() >= 7; }));
  const double expected_s[] = {0.05, 0.1, 0.2, 0.3, 0.3, 0.05};
  for (std::size_t i = 0; i < 6; ++i) {
    const double wait_s = std::chrono::duration<double>(times[i + 1] - times[i]).count();
    EXPECT_GT(wait_s, expected_s[i] - 0.002) << i;
    EXPECT_LT(wait_s, expected_s[i] + 0.15) << i;
  }
}

TEST_F(LinkClient, SilentPeerIsDeadWithinTwoSeconds) {
  std::vector<std::shared_ptr<Tcp::socket>> held;  // neither read from nor written to, as by a half-open connection
  Acceptor server(io_, [&](const auto& socket) { held.push_back(socket); });
  start(options(server.port()));
  ASSERT_TRUE(until([this] { return client_->health().connected; }));
  const auto connected_at = std::chrono::steady_clock::now();
  ASSERT_TRUE(until([this] { return !client_->health().connected; }));
  EXPECT_LE(seconds_since(connected_at), 2.0);
  EXPECT_GE(seconds_since(connected_at), 1.4);
  EXPECT_THAT(client_->health().error, HasSubstr("silent for 1.5 s"));
  EXPECT_TRUE(until([&] { return held.size() == 2; }));
}

TEST_F(LinkClient, APeerThatSaysALittleIsAlive) {
  std::shared_ptr<Tcp::socket> peer;
  Acceptor server(io_, [&](const auto& socket) { peer = socket; });
  ClientOptions brisk = options(server.port());
  brisk.silence_s = 0.2;
  start(brisk);
  ASSERT_TRUE(until([&] { return peer != nullptr; }));
  const Bytes hello = encoded(example_messages()[0]);
  for (std::size_t i = 0; i < hello.size(); i += 10) {  // 0.1 s between pieces, 1 s in all
    boost::asio::write(*peer, boost::asio::buffer(&hello[i], std::min<std::size_t>(10, hello.size() - i)));
    run_for(io_, 0.1);
  }
  EXPECT_EQ(messages_.size(), 1U);
  EXPECT_EQ(client_->health().connections, 1U);
}

TEST_F(LinkClient, MalformedStreamIsCountedAndLeft) {
  Bytes bad = encoded(example_messages()[0]);
  bad.back() ^= std::byte{1};
  int served = 0;
  Acceptor server(io_, [&](const auto& socket) { send(socket, ++served < 3 ? bad : encoded(example_messages()[0])); });
  ClientOptions silent = options(server.port());
  silent.ask_for_tracking = false;
  start(silent);
  ASSERT_TRUE(until([this] { return !messages_.empty(); }));
  EXPECT_EQ(client_->health().malformed, 2U);
  EXPECT_EQ(client_->health().messages, 1U);
  EXPECT_THAT(states_.at(1), HasSubstr("malformed message: TRANSFORM: wrong CRC"));
}

TEST_F(LinkClient, NobodyThereIsSaidOnce) {
  const std::uint16_t port = free_port(io_);
  start(options(port));
  run_for(io_, 0.5);
  EXPECT_THAT(states_, ElementsAre(fmt::format("127.0.0.1:{}: Connection refused", port)));
  EXPECT_FALSE(client_->health().connected);
  EXPECT_EQ(client_->health().error, states_[0]);
}

TEST_F(LinkClient, DataComeWithinASecondOfThePeersReturn) {
  const std::uint16_t port = free_port(io_);
  start(options(port));
  run_for(io_, 2.0);  // the waits are at their longest
  const Bytes hello = encoded(example_messages()[0]);
  const auto back_at = std::chrono::steady_clock::now();
  std::vector<std::shared_ptr<Tcp::socket>> held;
  Acceptor server(
      io_, [&](const auto& socket) { send(socket, hello), held.push_back(socket); }, port);
  ASSERT_TRUE(until([this] { return !messages_.empty(); }));
  EXPECT_LE(seconds_since(back_at), 1.0);
}

TEST_F(LinkClient, NamesAreResolved) {
  std::vector<std::shared_ptr<Tcp::socket>> held;
  Acceptor server(io_, [&](const auto& socket) { held.push_back(socket); });
  ClientOptions named = options(server.port());
  named.host = "localhost";
  start(named);
  EXPECT_TRUE(until([this] { return client_->health().connected; }));
}

TEST_F(LinkClient, StopLeavesNothingToDo) {
  // Connecting, connected, and waiting for the next attempt.
  for (const auto& [run_s, somebody] : {std::pair{0.0, true}, {0.3, true}, {0.3, false}}) {
    std::vector<std::shared_ptr<Tcp::socket>> held;
    Acceptor server(io_, [&](const auto& socket) { held.push_back(socket); });  // the system answers for it
    boost::asio::io_context io;
    Client client(io, options(somebody ? server.port() : free_port(io)), {});
    client.start();
    run_for(io, run_s);
    client.stop();
    const auto stopped_at = std::chrono::steady_clock::now();
    io.restart();
    io.run();
    EXPECT_LT(seconds_since(stopped_at), 0.5);
    EXPECT_EQ(client.health().error, "stopped");
    client.start();  // and again
    EXPECT_TRUE(run_until(io, [&] { return client.health().connected == somebody; }));
  }
}

TEST_F(LinkClient, AHandlerMayEndTheClient) {
  Bytes many;
  for (int i = 0; i < 10; ++i) encode(example_messages()[0], many);
  std::vector<std::shared_ptr<Tcp::socket>> held;
  Acceptor server(io_, [&](const auto& socket) { send(socket, many), held.push_back(socket); });
  auto client = std::unique_ptr<Client>();
  int seen = 0;
  const Client::Handlers handlers{[&](const Message&) { ++seen, client.reset(); }, {}};
  client = std::make_unique<Client>(io_, options(server.port()), handlers);
  client->start();
  EXPECT_TRUE(until([&] { return seen > 0; }));
  run_for(io_, 0.05);
  EXPECT_EQ(seen, 1);
}

TEST_F(LinkClient, OptionsOutsideTheirRangesAreRefused) {
  const auto refusal = [this](auto change) -> std::string {
    ClientOptions changed;
    change(changed);
    try {
      const Client client(io_, changed, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was refused";
  };
  EXPECT_THAT(refusal([](auto& o) { o.host = ""; }), HasSubstr("host"));
  EXPECT_THAT(refusal([](auto& o) { o.port = 0; }), HasSubstr("port = 0"));
  EXPECT_THAT(refusal([](auto& o) { o.silence_s = 0; }), HasSubstr("silence_s = 0"));
  EXPECT_THAT(refusal([](auto& o) { o.longest_wait_s = -1; }), HasSubstr("longest_wait_s = -1"));
}

}  // namespace
}  // namespace palpate::link::test
