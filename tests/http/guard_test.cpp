// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/http/guard.hpp>
#include <palpate/http/server.hpp>
#include <set>

namespace palpate::http {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

GuardRules rules(bool secure = false) {
  return {.hosts = own_hosts("127.0.0.1", true, {"table.local", "fe80::1"}),
          .secure = secure,
          .token = kToken,
          .cookie = "palpate_18946"};
}

Shown shown(std::string_view host, std::vector<std::string_view> origin = {}) {
  static const std::string target = "/?token=" + kToken;
  return {.target = target, .host = {host}, .origin = std::move(origin)};
}

TEST(HttpGuard, KnowsItsOwnNames) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:18946", "localhost", "LocalHost:1", "[::1]", "[::1]:65535",
                           "table.local", "TABLE.local:80", "[fe80::1]:9"})
    EXPECT_EQ(judge(shown(host), rules()).verdict, Verdict::kPass) << host;
}

TEST(HttpGuard, KnowsNoOtherName) {
  for (const char* host : {"",
                           ":",
                           ":80",
                           "example.org",
                           "localhost.",
                           "localhost:",
                           "localhost:80:80",
                           "localhost:http",
                           "localhost:123456",
                           "localhost.example.org",
                           "localhost@example.org",
                           "example.org@localhost",
                           "127.0.0.1.example.org",
                           "127.0.0.10",
                           "127.0.0.1 ",
                           " 127.0.0.1",
                           "127.0.0.1:18946/",
                           "127.0.0.1\t",
                           "127.1",
                           "2130706433",
                           "0.0.0.0",
                           "::1",
                           "[::1",
                           "[::1].example.org",
                           "fe80::1",
                           "localhos",
                           "xlocalhost",
                           "localhost:-1",
                           "localhost:+1",
                           "local\0host"})
    EXPECT_EQ(judge(shown(host), rules()).verdict, Verdict::kForbidden) << host;
}

TEST(HttpGuard, TheAddressAtWhichItWasReachedIsAName) {
  Shown at = shown("192.168.1.5:18946");
  EXPECT_EQ(judge(at, rules()).verdict, Verdict::kForbidden);
  at.reached = "192.168.1.5";
  EXPECT_EQ(judge(at, rules()).verdict, Verdict::kPass);
  at.host = {"[2001:db8::1]:9"};
  at.reached = "2001:db8::1";
  EXPECT_EQ(judge(at, rules()).verdict, Verdict::kPass);
}

TEST(HttpGuard, OneHostAndAtMostOneOrigin) {
  Shown none = shown("localhost");
  none.host.clear();
  EXPECT_EQ(judge(none, rules()).verdict, Verdict::kMalformed);
  Shown two = shown("localhost");
  two.host.push_back("localhost");
  EXPECT_EQ(judge(two, rules()).verdict, Verdict::kMalformed);
  const std::string_view own = "http://localhost";
  EXPECT_EQ(judge(shown("localhost", {own, own}), rules()).verdict, Verdict::kMalformed);
}

TEST(HttpGuard, TheOriginIsTheHostWithOurScheme) {
  EXPECT_EQ(judge(shown("localhost:80", {"http://localhost:80"}), rules()).verdict, Verdict::kPass);
  EXPECT_EQ(judge(shown("LOCALHOST:80", {"HTTP://localhost:80"}), rules()).verdict, Verdict::kPass);
  EXPECT_EQ(judge(shown("localhost:80", {"https://localhost:80"}), rules(true)).verdict, Verdict::kPass);
  for (const char* origin : {"", "null", "http://", "localhost:80", "//localhost:80", "https://localhost:80",
                             "http://localhost", "http://localhost:8", "http://localhost:800", "http://localhost:80/",
                             "http://127.0.0.1:80", "http://example.org", "http://localhost:80.example.org",
                             "http://localhost:80@example.org", " http://localhost:80", "http://localhost:80 ",
                             "file://localhost:80", "ws://localhost:80", "http://localhost:80,http://localhost:80"})
    EXPECT_EQ(judge(shown("localhost:80", {origin}), rules()).verdict, Verdict::kForbidden) << origin;
  EXPECT_EQ(judge(shown("localhost:80", {"http://localhost:80"}), rules(true)).verdict, Verdict::kForbidden);
}

TEST(HttpGuard, AForeignHostIsSaidBeforeAMissingToken) {
  Shown stranger{.target = "/", .host = {"example.org"}};
  EXPECT_EQ(judge(stranger, rules()).verdict, Verdict::kForbidden);
  EXPECT_EQ(judge(stranger, rules()).culprit, "example.org");
  stranger.host = {"localhost"};
  EXPECT_EQ(judge(stranger, rules()).verdict, Verdict::kUnauthorized);
}

Verdict with(std::string target, std::vector<std::string> authorization = {}, std::vector<std::string> cookie = {},
             const GuardRules& by = rules()) {
  Shown asked{.target = target, .host = {"localhost"}};
  asked.authorization.assign(authorization.begin(), authorization.end());
  asked.cookie.assign(cookie.begin(), cookie.end());
  return judge(asked, by).verdict;
}

TEST(HttpGuard, TheTokenComesInThreeWays) {
  for (const std::string& target :
       {"/?token=" + kToken, "/a?x=1&token=" + kToken, "/?token=" + kToken + "&token=x", "/?&&token=" + kToken + "&"})
    EXPECT_EQ(with(target), Verdict::kPass) << target;
  for (const std::string& text : {"Bearer " + kToken, "bearer  " + kToken, "BEARER " + kToken + " "})
    EXPECT_EQ(with("/", {text}), Verdict::kPass) << text;
  for (const std::string& text : {"palpate_18946=" + kToken, "a=b; palpate_18946=" + kToken + " ;c=d",
                                  "palpate_18946=x; palpate_18946=" + kToken, "\tpalpate_18946=" + kToken})
    EXPECT_EQ(with("/", {}, {text}), Verdict::kPass) << text;
  EXPECT_EQ(with("/?token=old", {}, {"palpate_18946=" + kToken}), Verdict::kPass) << "an old address, the new cookie";
}

TEST(HttpGuard, NothingElseIsTheToken) {
  std::string almost = kToken;
  almost.back() = 'e';
  for (const std::string& target :
       {std::string("/"), "/" + kToken, "/?" + kToken, std::string("/?token"), std::string("/?token="),
        "/?token=" + almost, "/?token=" + kToken + "0", "/?token=" + kToken.substr(1), "/?Token=" + kToken,
        "/?atoken=" + kToken, "/?token==" + kToken, "/?token=%30" + kToken.substr(1), "/token=" + kToken,
        "/#?token=" + kToken + "x", "/?token=x&token=" + kToken})
    EXPECT_EQ(with(target), Verdict::kUnauthorized) << target;
  for (const std::string& text :
       {kToken, "Basic " + kToken, "Bearer" + kToken, "Bearer " + almost, std::string("Bearer"), std::string("Bearer "),
        "Bearer " + kToken + ",x", "Bearer\t" + kToken})
    EXPECT_EQ(with("/", {text}), Verdict::kUnauthorized) << text;
  for (const std::string& text : {"palpate_18947=" + kToken, "Palpate_18946=" + kToken, "palpate_18946" + kToken,
                                  "palpate_18946=\"" + kToken + "\"", "palpate_18946==" + kToken, kToken, "=" + kToken,
                                  std::string(";;;=;"), std::string("palpate_18946=")})
    EXPECT_EQ(with("/", {}, {text}), Verdict::kUnauthorized) << text;
}

TEST(HttpGuard, WithoutATokenNobodyIsLetIn) {
  GuardRules open = rules();
  open.token.clear();
  EXPECT_EQ(with("/?token=", {"Bearer "}, {"palpate_18946="}, open), Verdict::kUnauthorized);
}

TEST(HttpGuard, PathsCookiesAndPolicies) {
  EXPECT_EQ(path_of("/a?b?c"), "/a");
  EXPECT_EQ(path_of(""), "");
  EXPECT_EQ(cookie_of(rules(), "localhost:8080"), "palpate_8080=" + kToken + "; HttpOnly; SameSite=Strict; Path=/");
  EXPECT_EQ(cookie_of(rules(), "[::1]"), "palpate_18946=" + kToken + "; HttpOnly; SameSite=Strict; Path=/");
  EXPECT_EQ(cookie_of(rules(), "localhost"), "palpate_18946=" + kToken + "; HttpOnly; SameSite=Strict; Path=/");
  EXPECT_TRUE(cookie_of(rules(true), "localhost").ends_with("; Secure"));
  EXPECT_NE(content_policy("a:1", false).find("connect-src 'self' ws://a:1;"), std::string::npos);
  EXPECT_NE(content_policy("a:1", true).find("connect-src 'self' wss://a:1;"), std::string::npos);
  EXPECT_NE(content_policy("", false).find("connect-src 'self';"), std::string::npos);
}

TEST(HttpGuard, WhatALogGetsIsTame) {
  EXPECT_EQ(for_a_person("a\r\nb\x1b[31m\xc3\xa9", kToken), "a??b?[31m??");
  EXPECT_EQ(for_a_person("x" + kToken + "y" + kToken, kToken), "x...y...");
  EXPECT_LE(for_a_person(std::string(9999, 'a'), kToken).size(), 90u);
  const std::string late = std::string(70, 'a') + kToken;  // the token must not be cut in two and survive
  EXPECT_EQ(for_a_person(late, kToken).find("0123"), std::string::npos);
}

TEST(HttpToken, IsLongAndNew) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string token = new_token();
    EXPECT_EQ(token.size(), 32u);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
    seen.insert(token);
  }
  EXPECT_EQ(seen.size(), 1000u);
}

}  // namespace
}  // namespace palpate::http
