// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <boost/asio/post.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <palpate/http/exchange.hpp>
#include <palpate/http/hub.hpp>
#include <palpate/http/socket.hpp>
#include <palpate/http/stream.hpp>

namespace palpate::http {

/// One connection that speaks HTTP: a request, its answer, the next. It becomes a Socket where that is asked for.
template <typename Stream>
class Connection final : public Member, public std::enable_shared_from_this<Connection<Stream>> {
 public:
  /// `hub` outlives it.
  Connection(const std::shared_ptr<Hub>& hub, Stream stream)
      : shared_hub_(hub), hub_(*hub), stream_(std::move(stream)) {}

  void start() {
    if constexpr (kIsSecure<Stream>) {
      deadline = in_seconds(times().request_s);
      stream_.async_handshake(asio::ssl::stream_base::server,
                              [self = this->shared_from_this()](const Error& error) { self->shook_hands(error); });
    } else {
      read();
    }
  }

  void overdue() override {
    if (waits_for_ == Waits::kHandler) {
      ++asked_;  // a reply that comes now is late
      return fail(503, "no answer in time");
    }
    const bool late = waits_for_ == Waits::kBody || (waits_for_ == Waits::kRequest && !known);
    if (late) hub_.count([](ServerHealth& health) { ++health.timed_out; });
    close();
  }

  void close() override {
    if (closed_) return;
    closed_ = true;
    Error ignored;
    beast::get_lowest_layer(stream_).close(ignored);
    hub_.forget(this);
  }

 private:
  enum class Waits { kRequest, kBody, kHandler, kWritten };
  using Parser = bhttp::request_parser<bhttp::string_body>;

  const ServerTimes& times() const { return hub_.options.times; }
  const HttpRequest& request() const { return parser_->get(); }
  Tcp::socket& socket() { return beast::get_lowest_layer(stream_); }
  std::string_view target() const { return view(request().target()); }

  void shook_hands(const Error& error) {
    if (closed_) return;
    if (!error) return read();
    if (!is_gone(error)) malformed("TLS: " + error.message());
    close();
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(Server::kMostHeaderBytes);
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // judged when it is known who asks
    waits_for_ = Waits::kRequest;
    deadline = in_seconds(known ? times().idle_s : times().request_s);
    bhttp::async_read_header(
        stream_, buffer_, *parser_,
        [self = this->shared_from_this()](const Error& error, std::size_t) { self->got_header(error); });
  }

  void got_header(const Error& error) {
    if (closed_) return;
    if (error) return unreadable(error);
    host_.clear();
    Error ignored;
    asio::ip::address own = socket().local_endpoint(ignored).address();
    if (own.is_v6() && own.to_v6().is_v4_mapped()) own = asio::ip::make_address_v4(asio::ip::v4_mapped, own.to_v6());
    const std::string reached = own.to_string();
    const Judgement judgement = judge_request(request(), reached, hub_.rules);
    if (judgement.verdict != Verdict::kPass) return refuse(judgement);
    host_ = view(request()[bhttp::field::host]);
    known = true;
    if (parser_->content_length() && *parser_->content_length() > Server::kMostBodyBytes) return too_large();
    parser_->body_limit(Server::kMostBodyBytes);
    if (parser_->is_done()) return take();
    waits_for_ = Waits::kBody;
    deadline = in_seconds(times().request_s);
    bhttp::async_read(stream_, buffer_, *parser_,
                      [self = this->shared_from_this()](const Error& failed, std::size_t) { self->got_body(failed); });
  }

  void got_body(const Error& error) {
    if (closed_) return;
    if (error) return unreadable(error);
    take();
  }

  void malformed(const std::string& what) {
    hub_.count([](ServerHealth& health) { ++health.malformed; });
    hub_.refusal(what);
  }

  void too_large() {
    malformed("413: body");
    fail(413, "body: expected at most 65536 bytes", true);
  }

  void unreadable(const Error& error) {
    if (is_gone(error)) return close();
    if (error == bhttp::error::body_limit) return too_large();
    malformed("HTTP: " + error.message());
    if (error == bhttp::error::header_limit || error == bhttp::error::buffer_overflow)
      return fail(431, "header: expected at most 8192 bytes", true);
    if (error == bhttp::error::partial_message || error.category() != bhttp::make_error_code({}).category())
      return close();
    fail(400, "expected a request of HTTP/1.1", true);
  }

  void refuse(const Judgement& judgement) {
    const int status = status_of(judgement.verdict);
    Error ignored;
    const std::string peer = socket().remote_endpoint(ignored).address().to_string();
    hub_.count([&](ServerHealth& health) {
      ++(status == 400 ? health.malformed : status == 403 ? health.forbidden : health.unauthorized);
      health.last_refusal = refusal_text(judgement, peer, hub_.rules.token);
    });
    const bool page = status == 401 && !path_of(target()).starts_with("/api");
    if (!page) return fail(status, judgement.why, true);
    body_ = fmt::format("<!doctype html><title>Palpate</title><p>401: {}.</p>\n", judgement.why);
    answer(401, "text/html; charset=utf-8", body_, true);
  }

  void take() {
    const std::string_view path = path_of(target());
    const bool reads = request().method() == bhttp::verb::get || request().method() == bhttp::verb::head;
    if (path == Server::kSocketPath) {
      if (websocket::is_upgrade(request())) return upgrade();
      return reads ? fail(426, "expected a WebSocket") : not_allowed();
    }
    for (const File& file : hub_.options.files)
      if (file.path == path) return reads ? answer(200, file.type, file.body) : not_allowed();
    if (path.starts_with("/api")) return ask(path, reads);
    fail(404, "no such page");
  }

  void not_allowed() { fail(405, "method: not one of this target"); }

  void upgrade() {
    const auto socket = std::make_shared<Socket<Stream>>(hub_, std::move(stream_));
    closed_ = true;
    hub_.replace(this, socket);
    socket->start(parser_->release());
  }

  /// The handler may reply at once or later, from any thread, or never.
  void ask(std::string_view path, bool reads) {
    const bool posts = request().method() == bhttp::verb::post;
    if (!reads && !posts) return not_allowed();
    const std::string_view type = view(request()[bhttp::field::content_type]);
    const std::string_view media = type.substr(0, type.find_first_of("; \t"));
    // A form of another page can send text, but not JSON.
    if (posts && !same_letters(media, "application/json")) return fail(415, "Content-Type: expected application/json");
    waits_for_ = Waits::kHandler;
    deadline = in_seconds(times().handler_s);
    const Server::Reply reply = [weak_hub = std::weak_ptr(shared_hub_.lock()), weak = this->weak_from_this(),
                                 asked = ++asked_](const Answer& given) {
      if (const auto hub = weak_hub.lock())
        asio::post(hub->io, [weak, asked, given] {
          if (const auto self = weak.lock()) self->replied(asked, given);
        });
    };
    const Request what{posts ? "POST" : "GET", std::string(path), request().body()};
    if (!safely([&] { hub_.handler(what, reply); })) replied(asked_, {500, R"({"error":"the handler failed"})"});
  }

  void replied(std::uint64_t asked, const Answer& given) {
    if (closed_ || waits_for_ != Waits::kHandler || asked != asked_) return;
    body_ = given.body + "\n";
    answer(given.status, "application/json", body_);
  }

  void fail(int status, std::string_view why, bool last = false) {
    body_ = fmt::format("{{\"error\":\"{}\"}}\n", why);
    answer(status, "application/json", body_, last);
  }

  /// `body` stays until it is written. After the `last` answer the connection is closed.
  void answer(int status, std::string_view type, std::string_view body, bool last = false) {
    response_ = response_to(request(), status, type, body, host_, hub_.rules);
    response_.keep_alive(!last && request().keep_alive());
    waits_for_ = Waits::kWritten;
    deadline = in_seconds(times().request_s + static_cast<double>(body.size()) / kSlowest_bytes_per_s);
    bhttp::async_write(stream_, response_,
                       [self = this->shared_from_this()](const Error& error, std::size_t) { self->written(error); });
  }

  void written(const Error& error) {
    if (closed_) return;
    if (error) return close();
    if (response_.keep_alive()) return read();
    deadline = in_seconds(std::min(kFarewell_s, times().request_s));
    if constexpr (kIsSecure<Stream>) {
      stream_.async_shutdown([self = this->shared_from_this()](const Error&) { self->close(); });
    } else {
      Error ignored;
      stream_.shutdown(Tcp::socket::shutdown_send, ignored);
      drain();
    }
  }

  /// What still comes is read and thrown away: a socket that is closed with unread data takes its answer back.
  void drain() {
    stream_.async_read_some(asio::buffer(waste_),
                            [self = this->shared_from_this()](const Error& error, std::size_t got) {
                              self->wasted_ += got;
                              if (error || self->wasted_ > 4 * Server::kMostBodyBytes) return self->close();
                              self->drain();
                            });
  }

  static constexpr double kFarewell_s = 1.0, kSlowest_bytes_per_s = 64.0 * 1024.0;

  std::weak_ptr<Hub> shared_hub_;
  Hub& hub_;
  Stream stream_;
  beast::flat_buffer buffer_{32 * 1024};
  std::optional<Parser> parser_;
  HttpResponse response_;
  std::string host_, body_;
  std::array<char, 4096> waste_{};
  std::size_t wasted_ = 0;
  std::uint64_t asked_ = 0;
  Waits waits_for_ = Waits::kRequest;
  bool closed_ = false;
};

}  // namespace palpate::http
