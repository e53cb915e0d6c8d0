// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <palpate/http/exchange.hpp>
#include <palpate/http/hub.hpp>
#include <palpate/http/outbox.hpp>
#include <palpate/http/stream.hpp>

namespace palpate::http {

/// The WebSocket of one client. What it sends is read message by message; what it is sent is written one at a time, in
/// order. A client that does not take what it is sent, or says nothing when asked, is closed.
template <typename Stream>
class Socket final : public Member, public Client, public std::enable_shared_from_this<Socket<Stream>> {
 public:
  Socket(Hub& hub, Stream stream) : hub_(hub), socket_(std::move(stream)) { known = true; }

  void start(HttpRequest request) {
    request_ = std::move(request);
    const std::string host(view(request_[bhttp::field::host]));
    socket_.set_option(websocket::stream_base::timeout{duration(hub_.options.times.request_s),
                                                       duration(hub_.options.times.silent_s), true});
    socket_.set_option(websocket::stream_base::decorator(
        [host](websocket::response_type& response) { set_common(response, host, kIsSecure<Stream>); }));
    socket_.read_message_max(Server::kMostTextBytes);
    socket_.auto_fragment(false);
    deadline = in_seconds(hub_.options.times.request_s);
    socket_.async_accept(request_, [self = this->shared_from_this()](const Error& error) { self->accepted(error); });
  }

  void send(Message message) override {
    if (closing_) return;
    const Outbox::Taken taken = outbox_.push(std::move(message));
    if (taken == Outbox::Taken::kOneDropped) hub_.count([](ServerHealth& health) { ++health.dropped; });
    if (taken == Outbox::Taken::kOverflow) return overdue();
    write();
  }

  void overdue() override {
    hub_.count([&](ServerHealth& health) { ++(opened_ ? health.closed_stuck : health.timed_out); });
    close();
  }

  void close() override {
    if (closed_) return;
    closed_ = closing_ = true;
    Error ignored;
    beast::get_lowest_layer(socket_).close(ignored);
    if (opened_) hub_.remove_client(id_);
    hub_.forget(this);
    if (opened_ && hub_.events.closed) safely([&] { hub_.events.closed(id_); });
  }

 private:
  static Clock::duration duration(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }

  void accepted(const Error& error) {
    request_ = {};
    if (closed_) return;
    if (error) return fail(error);
    deadline = Clock::time_point::max();
    opened_ = true;
    id_ = hub_.add_client(this->shared_from_this());
    if (hub_.events.opened && !safely([&] { hub_.events.opened(id_); })) return close();
    read();
  }

  void read() {
    socket_.async_read(buffer_, [self = this->shared_from_this()](const Error& error, std::size_t) {
      if (self->closed_) return;
      if (error) return self->fail(error);
      self->heard();
    });
  }

  void heard() {
    if (socket_.got_binary()) return refuse("WebSocket: expected text, got a binary message");
    if (is_too_much()) return refuse("WebSocket: expected fewer messages");
    std::string text(static_cast<const char*>(buffer_.data().data()), buffer_.size());
    buffer_.consume(buffer_.size());
    if (hub_.events.text && !safely([&] { hub_.events.text(id_, std::move(text)); })) return close();
    if (!closing_) read();
  }

  /// What it says is work for others, on another thread.
  bool is_too_much() {
    const Clock::time_point now = Clock::now();
    if (now >= second_) {
      second_ = now + std::chrono::seconds(1);
      texts_ = 0;
    }
    return ++texts_ > Server::kMostTextsASecond;
  }

  void refuse(const char* why) {
    hub_.count([](ServerHealth& health) { ++health.malformed; });
    hub_.refusal(why);
    closing_ = true;
    deadline = in_seconds(hub_.options.times.request_s);
    socket_.async_close(websocket::close_code::unknown_data,
                        [self = this->shared_from_this()](const Error&) { self->close(); });
  }

  void fail(const Error& error) {
    if (error == beast::error::timeout) return overdue();
    if (error != websocket::error::closed && !is_gone(error)) {
      hub_.count([](ServerHealth& health) { ++health.malformed; });
      hub_.refusal("WebSocket: " + error.message());
    }
    close();
  }

  void write() {
    if (writing_ || closing_ || outbox_.empty()) return;
    writing_ = true;
    message_ = outbox_.pop();
    socket_.binary(message_.binary);
    deadline = in_seconds(hub_.options.times.stuck_s);
    socket_.async_write(asio::buffer(*message_.bytes),
                        [self = this->shared_from_this()](const Error& error, std::size_t) { self->written(error); });
  }

  void written(const Error& error) {
    writing_ = false;
    message_ = {};
    if (closing_) return;
    deadline = Clock::time_point::max();
    if (error == asio::error::operation_aborted) return wait_for_reader();
    if (error) return close();
    hub_.count([](ServerHealth& health) { ++health.sent; });
    write();
  }

  /// The reader has met something wrong and is saying so to the client.
  void wait_for_reader() {
    closing_ = true;
    deadline = in_seconds(hub_.options.times.request_s);
  }

  Hub& hub_;
  websocket::stream<Stream, false> socket_;  // false: no compression
  beast::flat_buffer buffer_;
  HttpRequest request_;
  Outbox outbox_;
  Message message_;  // being written
  ClientId id_ = 0;
  Clock::time_point second_ = {};  // end of the second in which texts_ came
  std::size_t texts_ = 0;
  bool opened_ = false, writing_ = false, closing_ = false, closed_ = false;
};

}  // namespace palpate::http
