// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openssl/rand.h>

#include <array>
#include <palpate/http/server.hpp>
#include <stdexcept>

namespace palpate::http {

std::string new_token() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw std::runtime_error("no random numbers for a token");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

}  // namespace palpate::http
