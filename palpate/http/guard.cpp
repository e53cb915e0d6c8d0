// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openssl/crypto.h>

#include <algorithm>
#include <palpate/http/guard.hpp>

namespace palpate::http {

namespace {

constexpr std::size_t kLongestQuote = 80;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// What stands before `separator`; `rest` goes on after it.
std::string_view next_part(std::string_view& rest, char separator) {
  const std::size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// As Host has it.
std::string in_brackets(std::string_view name) {
  const bool bare_v6 = name.find(':') != std::string_view::npos && !name.starts_with('[');
  return bare_v6 ? fmt::format("[{}]", name) : std::string(name);
}

/// Cookies know no ports: its name holds the one that the browser knows, so that two tunnels to two servers differ.
std::string cookie_name(const GuardRules& rules, std::string_view host) {
  const std::string_view port = host.substr(std::min(host.rfind(':'), host.size() - 1) + 1);
  return is_port(port) ? fmt::format("palpate_{}", port) : rules.cookie;
}

bool cookie_has_token(std::string_view cookie, std::string_view expected, const GuardRules& rules) {
  bool found = false;
  while (!cookie.empty()) {
    std::string_view value = next_part(cookie, ';');
    const std::string_view name = trimmed(next_part(value, '='));
    if (name == expected) found |= same_token(trimmed(value), rules.token);
  }
  return found;
}

bool header_has_token(std::string_view authorization, std::string_view token) {
  const std::string_view scheme = next_part(authorization, ' ');
  return same_letters(scheme, "Bearer") && same_token(trimmed(authorization), token);
}

bool shows_token(const Shown& shown, const GuardRules& rules) {
  if (same_token(query_token(shown.target).value_or(""), rules.token)) return true;
  for (const std::string_view text : shown.authorization)
    if (header_has_token(text, rules.token)) return true;
  const std::string name = cookie_name(rules, shown.host.at(0));
  return std::ranges::any_of(shown.cookie, [&](std::string_view text) { return cookie_has_token(text, name, rules); });
}

}  // namespace

bool same_letters(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

std::vector<std::string> own_hosts(const std::string& address, bool loopback, const std::vector<std::string>& named) {
  std::vector<std::string> hosts;
  const auto add = [&](std::string_view name) { hosts.push_back(in_brackets(name)); };
  add(address);
  for (const std::string& name : named) add(name);
  if (loopback)
    for (const char* name : {"localhost", "127.0.0.1", "::1"}) add(name);
  return hosts;
}

bool is_own_host(std::string_view host, std::string_view name) {
  if (name.empty() || !same_letters(host.substr(0, name.size()), name)) return false;
  const std::string_view port = host.substr(name.size());
  return port.empty() || (port.starts_with(':') && is_port(port.substr(1)));
}

bool is_own_origin(std::string_view origin, std::string_view host, bool secure) {
  const std::string_view scheme = secure ? "https://" : "http://";
  return same_letters(origin.substr(0, scheme.size()), scheme) && same_letters(origin.substr(scheme.size()), host);
}

bool same_token(std::string_view shown, std::string_view token) {
  if (token.empty() || shown.size() != token.size()) return false;
  return CRYPTO_memcmp(shown.data(), token.data(), token.size()) == 0;
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

std::optional<std::string_view> query_token(std::string_view target) {
  std::string_view query = target.substr(std::min(path_of(target).size() + 1, target.size()));
  while (!query.empty()) {
    std::string_view value = next_part(query, '&');
    if (next_part(value, '=') == "token") return value;
  }
  return std::nullopt;
}

Judgement judge(const Shown& shown, const GuardRules& rules) {
  if (shown.host.size() != 1) return {Verdict::kMalformed, "Host: expected exactly one"};
  if (shown.origin.size() > 1) return {Verdict::kMalformed, "Origin: expected at most one"};
  const std::string_view host = shown.host[0];
  const bool own = is_own_host(host, in_brackets(shown.reached)) ||
                   std::ranges::any_of(rules.hosts, [&](const auto& name) { return is_own_host(host, name); });
  if (!own) return {Verdict::kForbidden, "Host: expected a name of this server", host};
  if (!shown.origin.empty() && !is_own_origin(shown.origin[0], host, rules.secure))
    return {Verdict::kForbidden, "Origin: expected this server's own page", shown.origin[0]};
  if (!shows_token(shown, rules)) return {Verdict::kUnauthorized, "open the address that palpate serve printed"};
  return {};
}

std::string cookie_of(const GuardRules& rules, std::string_view host) {
  return fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/{}", cookie_name(rules, host), rules.token,
                     rules.secure ? "; Secure" : "");
}

std::string content_policy(std::string_view host, bool secure) {
  const std::string socket = host.empty() ? "" : fmt::format(" {}://{}", secure ? "wss" : "ws", host);
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'{}; "
      "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      socket);
}

std::string for_a_person(std::string_view text, std::string_view token) {
  std::string quote(text);
  for (std::size_t at = 0; !token.empty() && (at = quote.find(token)) != std::string::npos;)
    quote.replace(at, token.size(), "...");
  for (char& c : quote)
    if (c < ' ' || c > '~') c = '?';
  if (quote.size() > kLongestQuote) quote.replace(kLongestQuote, std::string::npos, "...");
  return quote;
}

}  // namespace palpate::http
