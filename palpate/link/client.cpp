// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/link/client.hpp>
#include <palpate/link/connection.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::link {

namespace {

void check(const ClientOptions& options) {
  if (options.host.empty()) throw InputError("host = '': expected a name or an address");
  if (options.port == 0) throw InputError("port = 0: expected 1 to 65535");
  if (!(options.silence_s > 0.0 && options.silence_s <= 3600.0))
    throw InputError(fmt::format("silence_s = {}: expected (0, 3600]", options.silence_s));
  if (!(options.longest_wait_s > 0.0 && options.longest_wait_s <= 3600.0))
    throw InputError(fmt::format("longest_wait_s = {}: expected (0, 3600]", options.longest_wait_s));
}

}  // namespace

Client::Client(boost::asio::io_context& io, const ClientOptions& options, Handlers handlers) {
  check(options);
  connection_ = std::make_shared<Connection>(io, options, std::move(handlers));
}

Client::~Client() { connection_->stop(); }

void Client::start() { connection_->start(); }

void Client::stop() { connection_->stop(); }

const ClientHealth& Client::health() const { return connection_->health(); }

}  // namespace palpate::link
