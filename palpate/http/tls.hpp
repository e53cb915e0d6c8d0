// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <filesystem>

namespace palpate::http {

/// TLS 1.2 and newer, OpenSSL's own choice of ciphers. Throws InputError that names the file which cannot be read, is
/// no PEM, is locked by a password, or does not belong to the other.
boost::asio::ssl::context tls_context(const std::filesystem::path& certificate, const std::filesystem::path& key);

}  // namespace palpate::http
