// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <palpate/http/guard.hpp>
#include <palpate/http/stream.hpp>
//
#include <boost/beast/http/span_body.hpp>

/// A request seen by the guard, and the answer to it: what of the exchange needs no socket.
namespace palpate::http {

using HttpRequest = bhttp::request<bhttp::string_body>;
using HttpResponse = bhttp::response<bhttp::span_body<const char>>;

inline Judgement judge_request(const HttpRequest& request, std::string_view reached, const GuardRules& rules) {
  Shown shown{.target = view(request.target()), .reached = reached};
  for (const auto& field : request) {
    const std::string_view value = view(field.value());
    if (field.name() == bhttp::field::host) shown.host.push_back(value);
    if (field.name() == bhttp::field::origin) shown.origin.push_back(value);
    if (field.name() == bhttp::field::authorization) shown.authorization.push_back(value);
    if (field.name() == bhttp::field::cookie) shown.cookie.push_back(value);
  }
  return judge(shown, rules);
}

inline int status_of(Verdict verdict) {
  return verdict == Verdict::kMalformed ? 400 : verdict == Verdict::kForbidden ? 403 : 401;
}

/// For the log: to whom, why, and what was there instead.
inline std::string refusal_text(const Judgement& judgement, const std::string& peer, const std::string& token) {
  const int status = status_of(judgement.verdict);
  const std::string_view why = status == 401 ? "no token, or a wrong one" : judgement.why;
  const std::string got =
      judgement.culprit.empty() ? "" : fmt::format(", got '{}'", for_a_person(judgement.culprit, token));
  return fmt::format("{} to {}: {}{}", status, peer, why, got);
}

/// `host` has passed the guard, or is empty; `body` stays as long as the answer.
inline HttpResponse response_to(const HttpRequest& request, int status, std::string_view type, std::string_view body,
                                std::string_view host, const GuardRules& rules) {
  HttpResponse response;
  response.result(static_cast<unsigned>(status));
  set_common(response, host, rules.secure);
  response.set(bhttp::field::content_type, beast::string_view(type.data(), type.size()));
  const bool by_address = same_token(query_token(view(request.target())).value_or(""), rules.token);
  if (status == 200 && type.starts_with("text/html") && by_address)
    response.set(bhttp::field::set_cookie, cookie_of(rules, host));
  if (status == 401) response.set(bhttp::field::www_authenticate, "Bearer");
  if (status == 426) response.set(bhttp::field::upgrade, "websocket");
  response.content_length(body.size());
  if (request.method() != bhttp::verb::head) response.body() = {body.data(), body.size()};
  return response;
}

}  // namespace palpate::http
