// SPDX-License-Identifier: Apache-2.0
#include <igtlPolyDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include <cerrno>
#include <palpate/link/header.hpp>
#include <stdexcept>
#include <tests/link/library_peer.hpp>
#include <tests/serve/eventually.hpp>
#include <tests/serve/slicer_client.hpp>

namespace palpate::serve_test {

namespace {

double time_of(igtl::MessageBase& message) {
  unsigned seconds = 0, fraction = 0;
  message.GetTimeStamp(&seconds, &fraction);
  return link::seconds_of((static_cast<std::uint64_t>(seconds) << 32) | fraction);
}

}  // namespace

SlicerClient::SlicerClient(int port) : socket_(igtl::ClientSocket::New()) {
  if (socket_->ConnectToServer("127.0.0.1", port) != 0) throw std::runtime_error("SlicerClient: nobody listens");
  socket_->SetTimeout(50);
  thread_ = std::thread([this] { receive(); });
}

SlicerClient::~SlicerClient() {
  stopping_ = true;
  thread_.join();
  socket_->CloseSocket();
}

/// The library loses its place where it times out within a message: bytes are gathered here.
bool SlicerClient::read_exactly(std::byte* to, std::size_t count) {
  for (std::size_t have = 0; have < count && !stopping_;) {
    const int got = socket_->Receive(to + have, static_cast<int>(count - have), 0);
    if (got > 0) {
      have += static_cast<std::size_t>(got);
    } else if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
      return false;
    }
  }
  return !stopping_;
}

void SlicerClient::receive() {
  std::vector<std::byte> message(link::kHeaderBytes);
  while (read_exactly(message.data(), link::kHeaderBytes)) {
    const std::size_t body = link::read_header(link::ByteReader(message)).body_bytes;
    if (body > link::kMostBodyBytes) break;
    message.resize(link::kHeaderBytes + body);
    if (!read_exactly(message.data() + link::kHeaderBytes, body)) break;
    try {
      take(message);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      fault_ = error.what();
    }
    message.resize(link::kHeaderBytes);
  }
  closed_ = true;
}

void SlicerClient::take(const std::vector<std::byte>& message) {
  using link::test::unpacked;
  const auto received = Clock::now();
  const link::Header header = link::read_header(link::ByteReader(message));
  const std::lock_guard lock(mutex_);
  ++counts_[header.type];
  if (header.type == "SENSOR") {
    const auto sensor = unpacked<igtl::SensorMessage>(message);
    Force& force = forces_[header.device].emplace_back(Force{time_of(*sensor), received, {}});
    if (sensor->GetLength() != 6) throw std::runtime_error("SENSOR: expected six values");
    for (unsigned i = 0; i < 6; ++i) force.values[i] = sensor->GetValue(i);
  } else if (header.type == "STRING") {
    texts_[header.device] = unpacked<igtl::StringMessage>(message)->GetString();
  } else if (header.type == "TRANSFORM") {
    unpacked<igtl::TransformMessage>(message);
  } else if (header.type == "POLYDATA") {
    unpacked<igtl::PolyDataMessage>(message);
  } else {
    throw std::runtime_error("unexpected " + header.type);
  }
}

std::vector<SlicerClient::Force> SlicerClient::forces(const std::string& device) const {
  const std::lock_guard lock(mutex_);
  const auto found = forces_.find(device);
  return found == forces_.end() ? std::vector<Force>{} : found->second;
}

std::size_t SlicerClient::count(const std::string& type) const {
  const std::lock_guard lock(mutex_);
  const auto found = counts_.find(type);
  return found == counts_.end() ? 0 : found->second;
}

nlohmann::json SlicerClient::health(const std::string& device) const {
  const std::lock_guard lock(mutex_);
  const auto found = texts_.find(device);
  return found == texts_.end() ? nlohmann::json::object() : nlohmann::json::parse(found->second);
}

std::string SlicerClient::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

bool SlicerClient::wait_for(std::size_t forces, double longest_s, const std::string& device) const {
  return eventually(
      [&] {
        const std::lock_guard lock(mutex_);
        const auto found = forces_.find(device);
        return found != forces_.end() && found->second.size() >= forces;
      },
      longest_s);
}

bool SlicerClient::wait_for_live(double longest_s) const {
  const std::size_t before = forces().size();
  return eventually(
      [&] {
        const std::lock_guard lock(mutex_);
        const auto found = forces_.find("cForce");
        return found != forces_.end() && found->second.size() > before && found->second.back().live();
      },
      longest_s);
}

}  // namespace palpate::serve_test
