// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Who may ask: decided from what a request shows, before anything else is done with it. No sockets, no clocks.
namespace palpate::http {

/// What a request shows of itself: each header as often as it came.
struct Shown {
  std::string_view target;
  std::string_view reached = {};  ///< the address of ours at which it came: nobody can point a name's page there
  std::vector<std::string_view> host = {}, origin = {}, authorization = {}, cookie = {};
};

struct GuardRules {
  std::vector<std::string> hosts = {};  ///< names of this server as in Host, without a port; see own_hosts()
  bool secure = false;                  ///< origins are https
  std::string token = {};               ///< where it is empty nobody is let in
  std::string cookie = {};              ///< the name of the cookie that may carry it, where Host has no port
};

enum class Verdict { kPass, kMalformed, kForbidden, kUnauthorized };

struct Judgement {
  Verdict verdict = Verdict::kPass;
  std::string_view why = {};      ///< for the one who asked; says nothing of the request
  std::string_view culprit = {};  ///< what the request had there
};

/// One Host, which is ours (any port: a tunnel's differs); at most one Origin, which is exactly that Host with our
/// scheme; the token. In this order.
Judgement judge(const Shown& shown, const GuardRules& rules);

/// The address, what the user named, and on loopback all of this machine's names for it. IPv6 in brackets.
std::vector<std::string> own_hosts(const std::string& address, bool loopback, const std::vector<std::string>& named);

/// Case does not matter. A port is one to five digits.
bool is_own_host(std::string_view host, std::string_view name);
bool is_own_origin(std::string_view origin, std::string_view host, bool secure);

/// In a time that depends on the lengths alone; an empty token is nobody's.
bool same_token(std::string_view shown, std::string_view token);
/// `token` of the target's query, as it stands there.
std::optional<std::string_view> query_token(std::string_view target);
/// The target without its query.
std::string_view path_of(std::string_view target);

/// Value of Set-Cookie: not for scripts, not for other sites.
std::string cookie_of(const GuardRules& rules, std::string_view host);
/// Value of Content-Security-Policy; `host` is one that has passed, or empty.
std::string content_policy(std::string_view host, bool secure);

/// Hostile text, made fit for a log: printable ASCII, short, without the token.
std::string for_a_person(std::string_view text, std::string_view token);

bool same_letters(std::string_view a, std::string_view b);  ///< but for ASCII case

}  // namespace palpate::http
