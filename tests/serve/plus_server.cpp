// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>
#include <sys/socket.h>
#include <unistd.h>

#include <palpate/link/header.hpp>
#include <stdexcept>
#include <tests/link/library_peer.hpp>
#include <tests/serve/plus_server.hpp>

namespace palpate::serve_test {
namespace {

constexpr int kSendTimeout_ms = 2000;

void set_time(igtl::MessageBase& message, double time_s) {
  const std::uint64_t stamp = link::stamp_of(time_s).value();
  message.SetTimeStamp(static_cast<unsigned>(stamp >> 32), static_cast<unsigned>(stamp & 0xFFFFFFFFU));
}

void fill(igtl::Matrix4x4& matrix, const link::Matrix& from) {
  igtl::IdentityMatrix(matrix);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      matrix[i][j] = from.columns[static_cast<std::size_t>(j) * 3 + static_cast<std::size_t>(i)];
}

/// The library keeps it to itself.
struct Descriptor : igtl::Socket {
  static int of(igtl::Socket& socket) { return socket.*(&Descriptor::m_SocketDescriptor); }
};

bool send_packed(igtl::ClientSocket& socket, igtl::MessageBase& message) {
  message.Pack();
  return socket.Send(message.GetPackPointer(), message.GetPackSize()) != 0;
}

}  // namespace

PlusServer::PlusServer(int port) : port_(port) { listen(); }

PlusServer::~PlusServer() {
  hang_up();
  close();
}

void PlusServer::listen() {
  server_ = igtl::ServerSocket::New();
  if (server_->CreateServer(port_) < 0) throw std::runtime_error("PlusServer: cannot listen");
  port_ = server_->GetServerPort();
}

void PlusServer::close() {
  if (server_.IsNotNull()) server_->CloseSocket();
  server_ = nullptr;
}

void PlusServer::hang_up() {
  if (socket_.IsNotNull()) socket_->CloseSocket();
  socket_ = nullptr;
}

/// The library shuts a socket down before it closes it, which keeps the port for a minute: here the descriptor becomes
/// another file's first.
void PlusServer::crash() {
  const linger at_once{1, 0};
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (connected()) {
    ::setsockopt(Descriptor::of(*socket_), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::dup2(nothing, Descriptor::of(*socket_));
  }
  ::close(nothing);
  hang_up();
  close();
}

/// The request is read whole: a socket closed with bytes unread would reset the connection and lose what was sent.
bool PlusServer::accept(double longest_s) {
  const igtl::ClientSocket::Pointer next = server_->WaitForConnection(static_cast<unsigned long>(1e3 * longest_s));
  if (next.IsNull()) return false;
  hang_up();
  socket_ = next;
  socket_->SetTimeout(kSendTimeout_ms);
  std::array<std::byte, link::kHeaderBytes> bytes{};
  if (socket_->Receive(bytes.data(), static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) return false;
  const link::Header header = link::read_header(link::ByteReader(bytes));
  std::vector<std::byte> body(header.body_bytes);
  const int size = static_cast<int>(body.size());
  return header.version == 2 && header.type == "STT_TDATA" && socket_->Receive(body.data(), size) == size;
}

bool PlusServer::send(const WireFrame& frame) {
  bool sent = connected();
  for (const auto& [device, pose] : frame.poses) {
    if (!sent) return false;
    const auto message = igtl::TransformMessage::New();
    igtl::Matrix4x4 matrix;
    fill(matrix, pose);
    message->SetDeviceName(device.c_str());
    set_time(*message, frame.time_s);
    message->SetMatrix(matrix);
    sent = send_packed(*socket_, *message);
  }
  return sent;
}

bool PlusServer::send_tracking_data(const WireFrame& frame) {
  const auto message = igtl::TrackingDataMessage::New();
  for (const auto& [device, pose] : frame.poses) {
    auto element = igtl::TrackingDataElement::New();
    igtl::Matrix4x4 matrix;
    fill(matrix, pose);
    element->SetName(device.c_str());
    element->SetType(igtl::TrackingDataElement::TYPE_6D);
    element->SetMatrix(matrix);
    message->AddTrackingDataElement(element);
  }
  message->SetDeviceName("Tracker");
  set_time(*message, frame.time_s);
  return connected() && send_packed(*socket_, *message);
}

bool PlusServer::send_raw(std::span<const std::byte> bytes) {
  return connected() && socket_->Send(bytes.data(), static_cast<int>(bytes.size())) != 0;
}

std::vector<Clock::time_point> PlusServer::play(const WireFrames& frames, double rate_hz, std::size_t from,
                                                std::size_t to) {
  const Clock::time_point start = Clock::now();
  std::vector<Clock::time_point> sent;
  for (std::size_t i = from; i < std::min(to, frames.size()); ++i) {
    const std::chrono::duration<double> due(static_cast<double>(i - from) / rate_hz);
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(due));
    sent.push_back(Clock::now());
    if (!send(frames[i])) break;
  }
  return sent;
}

}  // namespace palpate::serve_test
