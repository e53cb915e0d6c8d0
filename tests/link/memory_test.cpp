// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <palpate/link/decode.hpp>
#include <palpate/link/server.hpp>
#include <tests/link/loopback.hpp>

/// At most 1 MiB a connection, whatever the peer does (row 11 of the list of faults).
namespace palpate::link::test {
namespace {

constexpr std::size_t kMost = 1 << 20;

/// The largest message of each type that is kept, and a mesh that is one long line.
std::vector<Message> largest_messages() {
  const std::string text(kMostTextBytes, 't'), name(kDeviceBytes, 'n');
  std::vector<Message> all;
  const auto add = [&](Body body) {
    all.push_back({.version = 1, .device = name, .time_s = 0.0, .body = std::move(body), .metadata = {}});
  };
  add(TrackingData{std::vector<TrackingData::Tool>(kMostTools, {name, 0, {}})});
  add(QuaternionTrackingData{std::vector<QuaternionTrackingData::Tool>(kMostTools, {name, 0, {}, {}})});
  add(Status{1, 0, name, text});
  add(String{text});
  add(Sensor{0, 0, std::vector<double>(255)});
  add(Capability{std::vector<std::string>(kMostCapabilities, std::string(kTypeBytes, 'c'))});
  add(PolyData{std::vector<std::array<float, 3>>((kMostBodyBytes - 40) / 12), {}});
  add(PolyData{{{0, 0, 0}}, {std::vector<std::uint32_t>((kMostBodyBytes - 56) / 4)}});
  add(PolyData{{{0, 0, 0}}, std::vector<std::vector<std::uint32_t>>(kMostLines, std::vector<std::uint32_t>(60))});
  add(String{text});
  all.back().version = 2;
  all.back().metadata.assign(kMostMetadata, {std::string(100, 'k'), std::string(156, 'v')});
  return all;
}

TEST(LinkMemory, DecoderAndMessageStayBelowAMebibyte) {
  Bytes stream;
  for (const Message& message : largest_messages()) encode(message, stream);
  std::size_t most = 0, messages = 0;
  const std::size_t before = heap_bytes();
  Decoder decoder;
  Message message;
  for (std::span<const std::byte> rest(stream); !rest.empty();) {
    std::span<const std::byte> piece = rest.first(std::min<std::size_t>(4096, rest.size()));
    rest = rest.subspan(piece.size());
    while (decoder.take(piece, message) == Decoder::Result::kMessage) {
      ++messages;
      most = std::max(most, heap_bytes() - before);
    }
    most = std::max(most, heap_bytes() - before);
  }
  EXPECT_EQ(messages, largest_messages().size()) << decoder.fault();
  EXPECT_LE(most, kMost - kMostBodyBytes);  // while the buffer grows, a part of it is there twice
}

TEST(LinkMemory, ClientsThatSendMuchAndReadNothing) {
  boost::asio::io_context io;
  ServerOptions options;
  options.port = 0;
  Server server(io, options);
  std::vector<Tcp::socket> clients;
  for (std::size_t i = 0; i < options.most_clients; ++i) clients.push_back(connected(io, server.port()));
  ASSERT_TRUE(run_until(io, [&] { return server.health().clients == options.most_clients; }));
  const std::size_t before = heap_bytes();
  const Bytes mesh = encoded(largest_messages()[6]);
  for (int round = 0; round < 2; ++round)  // the first is decoded, the second stays unfinished
    for (Tcp::socket& client : clients) {
      boost::asio::write(client, boost::asio::buffer(mesh, mesh.size() / 2));
      run_for(io, 0.005);
      const std::size_t rest = mesh.size() - mesh.size() / 2 - static_cast<std::size_t>(round);
      boost::asio::write(client, boost::asio::buffer(mesh.data() + mesh.size() / 2, rest));
      run_for(io, 0.005);
    }
  while (server.health().dropped < 1000) {
    server.broadcast(std::make_shared<const Bytes>(encoded(example_messages()[1])));
    io.poll();
  }
  EXPECT_EQ(server.health().clients, options.most_clients);
  EXPECT_LE((heap_bytes() - before) / options.most_clients, kMost - kMostBodyBytes);
}

}  // namespace
}  // namespace palpate::link::test
