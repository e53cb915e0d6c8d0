// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <igtlCapabilityMessage.h>
#include <igtlClientSocket.h>
#include <igtlSensorMessage.h>
#include <sys/resource.h>

#include <optional>
#include <palpate/link/decode.hpp>
#include <palpate/link/server.hpp>
#include <palpate/math/errors.hpp>
#include <tests/link/library_peer.hpp>
#include <tests/link/loopback.hpp>

/// The server over real sockets on loopback: rows 11 and 12 of the list of faults, and whatever else clients may do.
namespace palpate::link::test {
namespace {

using ::testing::HasSubstr;

class LinkServer : public ::testing::Test {
 protected:
  Server& start(ServerOptions options = {}) {
    options.port = 0;
    server_.emplace(io_, options);
    return *server_;
  }

  std::unique_ptr<Reader> reader() { return std::make_unique<Reader>(connected(io_, server_->port())); }
  bool until(const std::function<bool()>& holds, double longest_s = 5.0) { return run_until(io_, holds, longest_s); }
  bool until_clients(std::size_t count) {
    return until([this, count] { return server_->health().clients == count; });
  }

  /// So many messages, evenly over so many seconds.
  void broadcast(int count, double duration_s, const std::shared_ptr<const Bytes>& message) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) {
      server_->broadcast(message);
      io_.poll();  // behind its time or not
      until([&] { return seconds_since(start) >= duration_s * (i + 1) / count; });
    }
  }

  boost::asio::io_context io_;
  std::optional<Server> server_;
};

std::shared_ptr<const Bytes> shared(const Message& message) { return std::make_shared<const Bytes>(encoded(message)); }

Message text_of(std::size_t bytes) {
  return {.version = 1, .device = "Text", .time_s = 0.0, .body = String{std::string(bytes, 'x')}, .metadata = {}};
}

template <typename LibraryMessage>
typename LibraryMessage::Pointer received(igtl::ClientSocket& socket) {
  Bytes bytes(IGTL_HEADER_SIZE);
  socket.Receive(bytes.data(), IGTL_HEADER_SIZE);
  const auto body_bytes = static_cast<std::size_t>(read_header(ByteReader(bytes)).body_bytes);
  bytes.resize(IGTL_HEADER_SIZE + body_bytes);
  socket.Receive(bytes.data() + IGTL_HEADER_SIZE, static_cast<int>(body_bytes));
  return unpacked<LibraryMessage>(bytes);
}

TEST_F(LinkServer, AClientOfTheLibraryReadsIt) {
  start();
  const auto client = igtl::ClientSocket::New();
  ASSERT_EQ(client->ConnectToServer("127.0.0.1", server_->port()), 0);
  ASSERT_TRUE(until_clients(1));
  const Sensor force{0, kNewton, {0.1, -0.02, 0.005, 4e-3, 4e-3, 9e-3}};
  server_->broadcast(shared({.version = 1, .device = "Force", .time_s = 1.0, .body = force, .metadata = {}}));
  run_for(io_, 0.02);
  const auto message = received<igtl::SensorMessage>(*client);
  ASSERT_EQ(message->GetLength(), 6U);
  for (unsigned int i = 0; i < 6; ++i) EXPECT_EQ(message->GetValue(i), force.values[i]);
  EXPECT_EQ(server_->health().sent, 1U);

  const auto question = igtl::GetCapabilityMessage::New();
  question->Pack();
  client->Send(question->GetPackPointer(), question->GetPackSize());
  run_for(io_, 0.02);
  EXPECT_EQ(received<igtl::CapabilityMessage>(*client)->GetTypes(), type_names());
  client->CloseSocket();
  EXPECT_TRUE(until_clients(0));
}

TEST_F(LinkServer, EveryClientGetsEveryMessage) {
  start();
  std::vector<std::unique_ptr<Reader>> readers;
  readers.reserve(8);
  for (int i = 0; i < 8; ++i) readers.push_back(reader());
  ASSERT_TRUE(until_clients(8));
  std::vector<Message> sent;
  for (int i = 0; i < 50; ++i)
    for (const Message& message : example_messages()) {
      sent.push_back(message);
      server_->broadcast(shared(message));
    }
  for (const auto& client : readers) {
    EXPECT_TRUE(until([&] { return client->messages.size() == sent.size(); })) << client->messages.size();
    EXPECT_EQ(client->messages, sent);
  }
  EXPECT_TRUE(until([&] { return server_->health().sent == 8 * sent.size(); })) << server_->health().sent;
  EXPECT_EQ(server_->health().dropped, 0U);
}

TEST_F(LinkServer, ANeverReadingClientIsDroppedAndTheOtherNoticesNothing) {
  ServerOptions options;
  options.stuck_s = 0.5;
  start(options);
  const Tcp::socket stuck = connected(io_, server_->port());
  const auto good = reader();
  ASSERT_TRUE(until_clients(2));
  const auto message = shared(text_of(2000));
  broadcast(1500, 1.5, message);
  EXPECT_TRUE(until([this] { return server_->health().closed_stuck == 1; }));
  EXPECT_EQ(server_->health().clients, 1U);
  EXPECT_TRUE(until([&] { return good->messages.size() == 1500; }));  // all of them, the mark is 99 %
}

TEST_F(LinkServer, ANeverReadingClientOfASlowServerIsDroppedToo) {
  ServerOptions options;
  options.stuck_s = 0.5;
  start(options);
  Tcp::socket stuck(io_);
  stuck.open(Tcp::v4());
  stuck.set_option(boost::asio::socket_base::receive_buffer_size(4096));
  stuck.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
  ASSERT_TRUE(until_clients(1));
  broadcast(40, 1.0, shared(text_of(500)));  // 20 kB: far below what the server's kernel would take
  EXPECT_TRUE(until([this] { return server_->health().closed_stuck == 1; }));
}

TEST_F(LinkServer, ASlowReaderLosesMessagesAndNoBytes) {
  ServerOptions options;
  options.queue_bytes = 20000;
  start(options);
  Tcp::socket slow(io_);
  slow.open(Tcp::v4());
  slow.set_option(boost::asio::socket_base::receive_buffer_size(4096));
  slow.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
  ASSERT_TRUE(until_clients(1));
  const auto message = shared(text_of(3000));
  for (int i = 0; i < 500; ++i) server_->broadcast(message), io_.poll();
  EXPECT_GT(server_->health().dropped, 100U);
  Reader late(std::move(slow));
  EXPECT_TRUE(until([&] { return late.messages.size() + server_->health().dropped == 500; }));
  EXPECT_EQ(late.fault, "");
  EXPECT_GT(late.messages.size(), 5U);
  server_->broadcast(message);
  EXPECT_TRUE(until([&] { return late.messages.size() + server_->health().dropped == 501; }));
  EXPECT_EQ(server_->health().clients, 1U);
}

TEST_F(LinkServer, MalformedClosesItsSenderAlone) {
  start();
  const auto good = reader(), bad = reader();
  ASSERT_TRUE(until_clients(2));
  Bytes lie = encoded(example_messages()[0]);
  lie.back() ^= std::byte{1};
  boost::asio::write(bad->socket(), boost::asio::buffer(lie));
  EXPECT_TRUE(until([&] { return bad->ended; }));
  EXPECT_EQ(server_->health().closed_malformed, 1U);
  server_->broadcast(shared(example_messages()[0]));
  EXPECT_TRUE(until([&] { return good->messages.size() == 1; }));
  EXPECT_TRUE(bad->messages.empty());
}

TEST_F(LinkServer, WhatClientsSayIsIgnored) {
  start();
  const auto client = reader();
  ASSERT_TRUE(until_clients(1));
  Bytes everything = raw_message("IMAGE", Bytes(100000));
  for (const Message& message : example_messages()) encode(message, everything);
  boost::asio::write(client->socket(), boost::asio::buffer(everything));
  EXPECT_TRUE(until([&] { return client->messages.size() == 1; }));
  EXPECT_EQ(client->messages.at(0).body, Body(Capability{type_names()}));
  EXPECT_EQ(server_->health().clients, 1U);
}

TEST_F(LinkServer, IdleAndDrippingClientsCostTheirSlotAlone) {
  ServerOptions options;
  options.stuck_s = 0.2;
  start(options);
  const auto idle = reader(), dripping = reader();
  ASSERT_TRUE(until_clients(2));
  const Bytes hello = encoded(example_messages()[0]);
  for (std::size_t i = 0; i + 1 < hello.size(); i += 2) {
    boost::asio::write(dripping->socket(), boost::asio::buffer(&hello[i], 2));
    run_for(io_, 0.01);
  }
  EXPECT_EQ(server_->health().clients, 2U);
}

TEST_F(LinkServer, OneClientTooManyIsClosedAtOnce) {
  ServerOptions options;
  options.most_clients = 3;
  start(options);
  std::vector<std::unique_ptr<Reader>> readers;
  readers.reserve(4);
  for (int i = 0; i < 3; ++i) readers.push_back(reader());
  ASSERT_TRUE(until_clients(3));
  for (int i = 0; i < 200; ++i) {
    const auto refused = reader();
    ASSERT_TRUE(until([&] { return refused->ended; }));
  }
  EXPECT_EQ(server_->health().refused, 200U);
  EXPECT_EQ(server_->health().accepted, 3U);
  readers.pop_back();
  ASSERT_TRUE(until_clients(2));
  readers.push_back(reader());
  EXPECT_TRUE(until_clients(3));
}

TEST_F(LinkServer, ThousandClientsLeaveNothingBehind) {
  start();
  const auto first = reader();  // what is made once is made
  ASSERT_TRUE(until_clients(1));
  first->socket().close();
  ASSERT_TRUE(until_clients(0));
  const std::size_t descriptors = open_descriptors(), running = threads(), heap = heap_bytes();
  for (int i = 0; i < 1000; ++i) {
    const auto client = reader();
    ASSERT_TRUE(until_clients(1));
    client->socket().close();
    ASSERT_TRUE(until_clients(0));
  }
  EXPECT_EQ(open_descriptors(), descriptors);
  EXPECT_EQ(threads(), running);
  EXPECT_LE(heap_bytes(), heap + 8192);
}

TEST_F(LinkServer, WithoutDescriptorsItWaits) {
  start();
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  Tcp::socket client(io_);
  client.open(Tcp::v4());
  rlimit none = before;
  none.rlim_cur = static_cast<rlim_t>(client.native_handle()) + 1;
  setrlimit(RLIMIT_NOFILE, &none);
  client.connect({boost::asio::ip::address_v4::loopback(), server_->port()});
  std::size_t handlers = 0;
  const auto start_time = std::chrono::steady_clock::now();
  while (seconds_since(start_time) < 0.5) handlers += io_.run_one_for(std::chrono::milliseconds(10));
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(server_->health().clients, 0U);
  EXPECT_LT(handlers, 30U);  // a few attempts and checks, not a spin
  EXPECT_TRUE(until_clients(1));
}

TEST_F(LinkServer, APortIsFreeAgainAtOnce) {
  start();
  const std::uint16_t port = server_->port();
  const auto client = reader();
  ASSERT_TRUE(until_clients(1));
  server_.reset();
  EXPECT_TRUE(until([&] { return client->ended; }));
  ServerOptions again;
  again.port = port;
  EXPECT_NO_THROW(server_.emplace(io_, again));
}

TEST_F(LinkServer, StopLeavesNothingToDo) {
  start();
  const Tcp::socket client = connected(io_, server_->port());
  ASSERT_TRUE(until_clients(1));
  server_->broadcast(shared(text_of(60000)));
  server_->stop();
  const auto stopped_at = std::chrono::steady_clock::now();
  io_.restart();
  io_.run();
  EXPECT_LT(seconds_since(stopped_at), 0.5);
  EXPECT_EQ(server_->health().clients, 0U);
  server_->broadcast(shared(text_of(10)));  // to nobody
}

TEST_F(LinkServer, WhatCannotBeListenedOnIsRefused) {
  start();
  const auto refusal = [this](auto change) -> std::string {
    ServerOptions options;
    options.port = 0;
    change(options);
    try {
      const Server server(io_, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was refused";
  };
  const std::uint16_t taken = server_->port();
  EXPECT_THAT(refusal([&](auto& o) { o.port = taken; }),
              HasSubstr(fmt::format("127.0.0.1:{}: cannot be listened on: Address already in use", taken)));
  EXPECT_THAT(refusal([](auto& o) { o.address = "here"; }), HasSubstr("address = 'here'"));
  EXPECT_THAT(refusal([](auto& o) { o.address = "192.0.2.1"; }), HasSubstr("192.0.2.1:0: cannot be listened on"));
  EXPECT_THAT(refusal([](auto& o) { o.most_clients = 0; }), HasSubstr("most_clients = 0"));
  EXPECT_THAT(refusal([](auto& o) { o.stuck_s = 11; }), HasSubstr("stuck_s = 11"));
}

}  // namespace
}  // namespace palpate::link::test
