// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>  // before Beast, which forgets it
//
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <palpate/http/guard.hpp>
#include <string>
#include <type_traits>

/// Names for Beast's parts. Slow to compile: server.cpp alone includes what includes this.
namespace palpate::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
namespace websocket = boost::beast::websocket;

using Tcp = asio::ip::tcp;
using Error = boost::system::error_code;
using PlainStream = Tcp::socket;
using SecureStream = beast::ssl_stream<Tcp::socket>;

template <typename Stream>
inline constexpr bool kIsSecure = std::is_same_v<Stream, SecureStream>;

inline std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// What every answer says, that of the upgrade too. `host` has passed the guard, or is empty.
template <typename Fields>
void set_common(Fields& fields, std::string_view host, bool secure) {
  fields.set(bhttp::field::server, "palpate");
  fields.set(bhttp::field::cache_control, "no-store");
  fields.set("Content-Security-Policy", content_policy(host, secure));
  fields.set("X-Content-Type-Options", "nosniff");
  fields.set("X-Frame-Options", "DENY");
  fields.set("Referrer-Policy", "no-referrer");
  fields.set("Cross-Origin-Opener-Policy", "same-origin");
  fields.set("Cross-Origin-Resource-Policy", "same-origin");
}

/// It went away by itself.
inline bool is_gone(const Error& error) {
  return error == asio::error::eof || error == asio::error::connection_reset || error == asio::error::broken_pipe ||
         error == asio::error::operation_aborted || error == asio::ssl::error::stream_truncated ||
         error == bhttp::error::end_of_stream;
}

}  // namespace palpate::http
