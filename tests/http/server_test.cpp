// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <tests/http/served.hpp>

namespace palpate::http {
namespace {

using test::kToken;
using test::Raw;
using test::Response;
using ::testing::HasSubstr;

class HttpServer : public test::Served {};

TEST_F(HttpServer, GivesItsFilesToWhoShowsTheToken) {
  start();
  EXPECT_EQ(ask("GET", "/?token=" + kToken).body, "<p>page</p>");
  const Response script = asked("GET", "/dashboard.js");
  EXPECT_EQ(script.status, 200);
  EXPECT_EQ(script.body, kScript);
  EXPECT_EQ(script.headers.at("Content-Type"), "text/javascript");
  const Response head = asked("HEAD", "/dashboard.js");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.headers.at("Content-Length"), std::to_string(kScript.size()));
}

TEST_F(HttpServer, ThePageGetsACookieThatOpensTheRest) {
  start();
  const std::string name = "palpate_" + std::to_string(port());
  const Response page = ask("GET", "/?token=" + kToken);
  ASSERT_TRUE(page.headers.contains("Set-Cookie"));
  EXPECT_EQ(page.headers.at("Set-Cookie"), name + "=" + kToken + "; HttpOnly; SameSite=Strict; Path=/");
  const std::string cookie = "Cookie: " + name + "=" + kToken + "\r\n";
  EXPECT_EQ(ask("GET", "/dashboard.css", cookie).status, 200);
  EXPECT_EQ(ask("GET", "/api/health", cookie).status, 200);
  EXPECT_FALSE(ask("GET", "/", cookie).headers.contains("Set-Cookie"));
  EXPECT_FALSE(asked("GET", "/").headers.contains("Set-Cookie"));
  EXPECT_FALSE(ask("GET", "/dashboard.js?token=" + kToken).headers.contains("Set-Cookie"));
  EXPECT_FALSE(ask("GET", "/?token=x", cookie).headers.contains("Set-Cookie"));
}

struct Case {
  int status;
  std::string method, target, headers, body = "";
};

TEST_F(HttpServer, EachCauseHasItsStatus) {
  start();
  const std::string json = "Content-Type: application/json\r\n", token = bearer(), evil = "Host: example.org\r\n";
  const std::vector<Case> cases{
      {403, "GET", "/", evil + token},
      {403, "GET", "/", evil},
      {403, "GET", "/nothing", evil},
      {403, "POST", "/api/notes", evil + token + json, "{}"},
      {403, "GET", "/", "Origin: null\r\n" + token},
      {403, "GET", "/", "Origin: http://example.org\r\n" + token},
      {403, "GET", "/", "Origin: http://127.0.0.1\r\n" + token},
      {400, "GET", "/", "Host: localhost\r\nHost: example.org\r\n" + token},
      {400, "GET", "/", "Host: localhost\r\nHost: localhost\r\n" + token},
      {401, "GET", "/", ""},
      {401, "GET", "/nothing", ""},
      {401, "DELETE", "/", ""},
      {401, "POST", "/api/notes", json, "{}"},
      {401, "POST", "/api/notes", json + "Content-Length: 99999999\r\n"},
      {404, "GET", "/nothing", token},
      {404, "GET", "/dashboard.js/", token},
      {404, "GET", "/../dashboard.js", token},
      {404, "GET", "//dashboard.js", token},
      {404, "GET", "/dashboard%2ejs", token},
      {404, "GET", "http://localhost/", token},
      {404, "POST", "/nothing", token},
      {405, "POST", "/", token + json, "{}"},
      {405, "PUT", "/api/notes", token + json, "{}"},
      {405, "DELETE", "/api/notes", token},
      {405, "OPTIONS", "/api/notes", token},
      {405, "BREW", "/dashboard.js", token},
      {405, "POST", "/live", token + json, "{}"},
      {426, "GET", "/live", token},
      {413, "POST", "/api/notes", token + json + "Content-Length: 65537\r\n"},
      {415, "POST", "/api/notes", token, "{}"},
      {415, "POST", "/api/notes", token + "Content-Type: text/plain\r\n", "{}"},
      {415, "POST", "/api/notes", token + "Content-Type: application/jsonx\r\n", "{}"},
      {200, "POST", "/api/notes", token + "Content-Type: Application/JSON; charset=utf-8\r\n", "{}"},
      {200, "POST", "/api/notes", token + json + "Origin: http://localhost\r\n", "{}"},
      {200, "GET", "/?x=1", token + "Host: LOCALHOST:80\r\nOrigin: http://localhost:80\r\n"}};
  for (const Case& each : cases)
    EXPECT_EQ(ask(each.method, each.target, each.headers, each.body).status, each.status)
        << each.method << " " << each.target << "\n"
        << each.headers;
  const ServerHealth health = server().health();
  EXPECT_EQ(health.forbidden, 7u);
  EXPECT_EQ(health.unauthorized, 5u);
  EXPECT_EQ(health.malformed, 3u);
}

TEST_F(HttpServer, WhatIsNoHttpIsAnsweredOnceAndClosed) {
  start();
  for (const char* text : {"GARBAGE\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n",
                           "POST /api/x HTTP/1.1\r\nContent-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n{}",
                           "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03 a TLS greeting\r\n\r\n"}) {
    Raw raw(port());
    EXPECT_EQ(raw.say(text).hear().status, 400) << text;
    EXPECT_TRUE(raw.is_closed()) << text;
  }
  Raw wide(port());
  EXPECT_EQ(wide.say("GET / HTTP/1.1\r\nA: " + std::string(9000, 'a') + "\r\n\r\n").hear().status, 431);
  EXPECT_TRUE(wide.is_closed());
  Raw chunked(port());
  const std::string chunk = "9000\r\n" + std::string(0x9000, 'x') + "\r\n";
  chunked.say(text("POST", "/api/x", bearer() + "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n"));
  EXPECT_EQ(chunked.say(chunk + chunk).hear().status, 413);
  EXPECT_TRUE(chunked.is_closed());
  EXPECT_EQ(server().health().malformed, 8u);
}

TEST_F(HttpServer, EveryAnswerForbidsWhatThePageDoesNotNeed) {
  start();
  const std::string json = "Content-Type: application/json\r\n";
  for (const Response& each :
       {asked("GET", "/"), asked("GET", "/nothing"), asked("GET", "/api/health"), ask("GET", "/"), ask("GET", "/api/x"),
        ask("GET", "/", "Host: example.org\r\n"), asked("PUT", "/"), Raw(port()).say("x\r\n\r\n").hear()}) {
    EXPECT_EQ(each.headers.at("Cache-Control"), "no-store");
    EXPECT_EQ(each.headers.at("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(each.headers.at("X-Frame-Options"), "DENY");
    EXPECT_EQ(each.headers.at("Referrer-Policy"), "no-referrer");
    EXPECT_EQ(each.headers.at("Cross-Origin-Opener-Policy"), "same-origin");
    EXPECT_EQ(each.headers.at("Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_EQ(each.headers.at("Server"), "palpate");
    EXPECT_THAT(each.headers.at("Content-Security-Policy"), HasSubstr("default-src 'none'; script-src 'self'"));
    EXPECT_FALSE(each.headers.contains("Access-Control-Allow-Origin"));
  }
  const Response page = asked("GET", "/", "Host: localhost:77\r\n");
  EXPECT_THAT(page.headers.at("Content-Security-Policy"), HasSubstr("connect-src 'self' ws://localhost:77;"));
  const Response foreign = ask("GET", "/", "Host: example.org\r\n");
  EXPECT_EQ(foreign.headers.at("Content-Security-Policy").find("example"), std::string::npos);
}

TEST_F(HttpServer, AStrangerIsToldWhatToDoAndNothingElse) {
  start();
  const Response page = ask("GET", "/?token=wrong");
  EXPECT_EQ(page.status, 401);
  EXPECT_EQ(page.headers.at("Content-Type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("open the address that palpate serve printed"));
  const Response api = ask("GET", "/api/health");
  EXPECT_EQ(api.headers.at("Content-Type"), "application/json");
  EXPECT_EQ(api.body, "{\"error\":\"open the address that palpate serve printed\"}\n");
  ask("GET", "/", "Host: " + kToken + ".example.org\r\n");
  const ServerHealth health = server().health();
  EXPECT_EQ(health.last_refusal, "403 to 127.0.0.1: Host: expected a name of this server, got '....example.org'");
}

TEST_F(HttpServer, TheHandlerSeesTargetWithoutQueryMethodAndBody) {
  start();
  EXPECT_EQ(ask("GET", "/api/health?token=" + kToken + "&x=1").body, "GET /api/health \n");
  EXPECT_EQ(asked("POST", "/api/notes", "Content-Type: application/json\r\n", R"({"text":"x"})").body,
            "POST /api/notes {\"text\":\"x\"}\n");
  EXPECT_EQ(asked("GET", "/api/missing").status, 404);
  const Response head = asked("HEAD", "/api/health");
  EXPECT_EQ(head.headers.at("Content-Length"), "17");
  EXPECT_EQ(asked("GET", "/api/throws").status, 500);
  EXPECT_EQ(asked("GET", "/api/health").status, 200);
}

TEST_F(HttpServer, AnAnswerMayComeLaterAndFromElsewhere) {
  start();
  Raw raw(port());
  EXPECT_EQ(raw.say(text("GET", "/api/late", bearer())).hear().body, "GET /api/late \n");
  EXPECT_EQ(raw.say(text("GET", "/api/health", bearer())).hear().body, "GET /api/health \n") << "not the second reply";
  { Raw(port()).say(text("GET", "/api/late", bearer())); }  // gone before the answer
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(asked("GET", "/api/health").status, 200);
}

TEST_F(HttpServer, AnAnswerMayComeAfterTheServerIsGone) {
  std::mutex mutex;
  std::optional<Server::Reply> kept;
  other_answer_ = [&](const Request&, const Server::Reply& reply) {
    const std::lock_guard lock(mutex);
    kept = reply;
  };
  start();
  Raw raw(port());
  raw.say(text("GET", "/api/health", bearer()));
  EXPECT_TRUE(test::eventually([&] {
    const std::lock_guard lock(mutex);
    return kept.has_value();
  }));
  finish();
  EXPECT_TRUE(raw.is_closed());
  (*kept)({200, "{}"});
}

TEST_F(HttpServer, AConnectionServesManyRequests) {
  start();
  Raw raw(port());
  for (int i = 0; i < 5; ++i) EXPECT_EQ(raw.say(text("GET", "/dashboard.js", bearer())).hear().body, kScript);
  raw.say(text("GET", "/api/1", bearer()) + text("GET", "/", bearer()) + text("GET", "/api/3", bearer()));
  EXPECT_EQ(raw.hear().body, "GET /api/1 \n");
  EXPECT_EQ(raw.hear().body, "<p>page</p>");
  EXPECT_EQ(raw.hear().body, "GET /api/3 \n");
  EXPECT_EQ(server().health().accepted, 1u);
  EXPECT_EQ(raw.say(text("GET", "/", bearer() + "Connection: close\r\n")).hear().status, 200);
  EXPECT_TRUE(raw.is_closed());
  Raw wrong(port());
  EXPECT_EQ(wrong.say(text("GET", "/", bearer())).hear().status, 200);
  EXPECT_EQ(wrong.say(text("GET", "/", "")).hear().status, 401) << "the token is asked for each time";
  EXPECT_TRUE(wrong.is_closed());
}

std::string refusal(ServerOptions options) {
  try {
    Server server(std::move(options), [](const Request&, const Server::Reply&) {});
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST_F(HttpServer, SaysWhyItCannotStart) {
  start();
  ServerOptions taken = defaults();
  taken.port = port();
  EXPECT_EQ(refusal(taken),
            "dashboard 127.0.0.1:" + std::to_string(port()) + ": cannot be opened: Address already in use");
  for (const char* address : {"0.0.0.0", "::", "192.168.1.5", "::ffff:127.0.0.1"})
    EXPECT_THAT(refusal({.address = address, .token = kToken}),
                HasSubstr(std::string("dashboard.address = ") + address + ": expected TLS (certificate and key)"));
  EXPECT_EQ(refusal({.address = "localhost", .token = kToken}),
            "dashboard.address = 'localhost': expected an IP address");
  EXPECT_EQ(refusal({.address = "127.1.2.3", .token = kToken}), "");
}

TEST_F(HttpServer, StopsBeforeItRunsAndWithoutRunning) {
  Server never(defaults(), [](const Request&, const Server::Reply&) {});
  Server before(defaults(), [](const Request&, const Server::Reply&) {});
  before.stop();
  before.run();
  before.send(1, {std::make_shared<const std::string>("x")});
  before.stop();
  before.run();
  EXPECT_FALSE(Raw(before.port()).good());
}

}  // namespace
}  // namespace palpate::http
