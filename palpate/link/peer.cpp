// SPDX-License-Identifier: Apache-2.0
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include <palpate/link/decode.hpp>
#include <palpate/link/peer.hpp>
#include <utility>

namespace palpate::link {

namespace asio = boost::asio;
using Error = boost::system::error_code;

namespace {

constexpr std::size_t kMostGathered = 32;
constexpr int kKernelBytes = 64 * 1024;  // left to itself it grows to megabytes: seconds of old forces

/// Bytes that the peer's kernel has not confirmed yet.
std::uint64_t unconfirmed(asio::ip::tcp::socket& socket) {
  int bytes = 0;
  return ioctl(socket.native_handle(), SIOCOUTQ, &bytes) == 0 ? static_cast<std::uint64_t>(bytes) : 0;
}

}  // namespace

Peer::Peer(asio::ip::tcp::socket socket, const ServerOptions& options, std::shared_ptr<ServerHealth> health,
           std::function<void(const std::shared_ptr<Peer>&)> ended)
    : socket_(std::move(socket)), options_(options), health_(std::move(health)), ended_(std::move(ended)) {
  Error ignored;  // none of them is needed
  socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(asio::socket_base::keep_alive(true), ignored);
  socket_.set_option(asio::socket_base::send_buffer_size(kKernelBytes), ignored);
  taken_at_ = Clock::now();
}

void Peer::start() { read(); }

void Peer::close() {
  Error ignored;
  socket_.close(ignored);
  ended_ = nullptr;
}

void Peer::end() {
  const auto ended = std::exchange(ended_, nullptr);
  close();
  if (ended) ended(shared_from_this());
}

void Peer::read() {
  socket_.async_read_some(asio::buffer(buffer_), [self = shared_from_this()](const Error& error, std::size_t count) {
    if (!self->ended_) return;
    if (error) return self->end();
    self->receive(std::span(self->buffer_).first(count));
  });
}

void Peer::receive(std::span<const std::byte> bytes) {
  Message message;  // not kept: a large one would stay beside the next
  Decoder::Result result = Decoder::Result::kNeedsMore;
  while ((result = decoder_.take(bytes, message)) == Decoder::Result::kMessage)
    if (std::holds_alternative<GetCapability>(message.body)) answer(message);
  if (result == Decoder::Result::kNeedsMore) return read();
  ++health_->closed_malformed;
  end();
}

void Peer::answer(const Message& question) {
  const Message capability{.version = question.version,
                           .device = question.device,
                           .time_s = 0.0,
                           .body = Capability{type_names()},
                           .metadata = {}};
  auto bytes = std::make_shared<std::vector<std::byte>>();
  encode(capability, *bytes);
  send(std::move(bytes));
}

void Peer::send(SharedBytes message) {
  if (message->size() + queued_bytes_ > options_.queue_bytes) {
    ++health_->dropped;
    return;
  }
  queued_bytes_ += message->size();
  queue_.push_back(std::move(message));
  if (!writing_) write();
}

/// One write at a time, of all that waits.
void Peer::write() {
  gathered_.clear();
  for (std::size_t i = 0; i < std::min(queue_.size(), kMostGathered); ++i)
    gathered_.emplace_back(asio::buffer(*queue_[i]));
  gathered_.front() += first_written_;
  writing_ = true;
  socket_.async_write_some(gathered_, [self = shared_from_this()](const Error& error, std::size_t count) {
    self->writing_ = false;
    if (!self->ended_) return;
    if (error) return self->end();
    self->written(count);
  });
}

void Peer::written(std::size_t bytes) {
  written_bytes_ += bytes;
  first_written_ += bytes;
  while (!queue_.empty() && first_written_ >= queue_.front()->size()) {
    first_written_ -= queue_.front()->size();
    queued_bytes_ -= queue_.front()->size();
    queue_.pop_front();
    ++health_->sent;
  }
  if (!queue_.empty()) write();
}

void Peer::check(Clock::time_point now) {
  const std::uint64_t waiting = unconfirmed(socket_);
  const std::uint64_t taken = written_bytes_ - waiting;
  if ((waiting == 0 && queue_.empty()) || taken != taken_bytes_) {
    taken_bytes_ = taken;
    taken_at_ = now;
  } else if (std::chrono::duration<double>(now - taken_at_).count() >= options_.stuck_s) {
    ++health_->closed_stuck;
    end();
  }
}

}  // namespace palpate::link
