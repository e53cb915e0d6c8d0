// SPDX-License-Identifier: Apache-2.0
#include "live_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <palpate/service/board.hpp>
#include <palpate/service/service.hpp>
#include <web/assets.hpp>

#include "file_paths.hpp"
#include "progress_line.hpp"

namespace palpate::app {

namespace {

using nlohmann::json;

/// "demo LIVE 12.3 g +- 0.4  (0.012, 0.034, -0.115) N"
std::string force_line(const json& catheter) {
  const std::string head =
      fmt::format("{} {}", catheter["catheter"].get<std::string>(), catheter["state"].get<std::string>());
  const json force = catheter.value("force_tip_N", json());
  if (!force.is_array())
    return head + (catheter["words"].empty() ? "" : ": " + catheter["words"][0].get<std::string>());
  Eigen::Vector3d F, sigma;
  for (int i = 0; i < 3; ++i) {
    F(i) = force[static_cast<std::size_t>(i)].get<double>();
    sigma(i) = catheter["sigma_N"][static_cast<std::size_t>(i)].get<double>();
  }
  const double along = F.norm() > 0.0 ? (F.normalized().cwiseProduct(sigma)).norm() : sigma.maxCoeff();
  return fmt::format("{} {:5.1f} g +- {:.1f}  ({:+.3f}, {:+.3f}, {:+.3f}) N", head, F.norm() * kGramsForcePerNewton,
                     1.96 * along * kGramsForcePerNewton, F.x(), F.y(), F.z());
}

void say_where(const service::Service& service, const service::Settings& settings, const LiveOptions& options) {
  if (options.json) {
    fmt::print("{}\n", json{{"openigtlink_port", service.link_port()},
                            {"dashboard_port", service.dashboard_port()},
                            {"dashboard_url", service.dashboard_address()},
                            {"token", service.token()},
                            {"recording", settings.recording.path.string()}}
                           .dump());
  } else {
    fmt::print("Research software: not a medical device, not for clinical decisions.\n");
    if (settings.link.on)
      fmt::print("OpenIGTLink  {}:{}   (3D Slicer: OpenIGTLinkIF, client)\n", settings.link.address,
                 service.link_port());
    if (!settings.recording.path.empty()) fmt::print("recording    {}\n", settings.recording.path.string());
    fmt::print("Ctrl-C ends it.\n");
    if (settings.dashboard.on) fmt::print("dashboard    {}\n", service.dashboard_address());
  }
  std::fflush(stdout);
}

void look(const service::Service& service, const LiveOptions& options, const ProgressLine& line) {
  const json health = service.health();
  if (options.print) {
    for (const json& catheter : health["catheters"]) fmt::print("{}\n", force_line(catheter));
    std::fflush(stdout);
    return;
  }
  std::string words;
  for (const json& catheter : health["catheters"]) words += (words.empty() ? "" : " | ") + force_line(catheter);
  if (health.contains("recording") && health["recording"]["failing"].get<bool>())
    words += fmt::format(" | RECORDING FAILS: {}", health["recording"]["error"].get<std::string>());
  line.show(words.substr(0, 150));
}

int summarise(const json& health, const LiveOptions& options) {
  print_warnings(health["refusals"].get<std::vector<std::string>>());
  const bool recorded = health.contains("recording");
  const std::uint64_t lost = recorded ? health["recording"]["dropped"].get<std::uint64_t>() +
                                            health["recording"]["offered"].get<std::uint64_t>() -
                                            health["recording"]["committed"].get<std::uint64_t>()
                                      : 0;
  if (options.json) {
    fmt::print("{}\n", service::text_of(health));
  } else {
    for (const json& catheter : health["catheters"])
      fmt::print("{}: {} frames, stale {} times, {} late\n", catheter["catheter"].get<std::string>(),
                 catheter["frames"].get<std::uint64_t>(), catheter["stale"].get<std::uint64_t>(),
                 catheter["misses"].get<std::uint64_t>());
    fmt::print("latency p50 {:.3f} ms, p99 {:.3f} ms, most {:.3f} ms\n", 1e3 * health["latency"]["p50_s"].get<double>(),
               1e3 * health["latency"]["p99_s"].get<double>(), 1e3 * health["latency"]["most_s"].get<double>());
    if (recorded)
      fmt::print("recorded: {} records in {}\n", health["recording"]["committed"].get<std::uint64_t>(),
                 health["recording"]["path"].get<std::string>());
  }
  if (lost > 0) fmt::print(stderr, "palpate: recording: {} records were lost\n", lost);
  return lost > 0 ? 1 : 0;
}

/// The page as it is asked for. The strings live as long as the program.
std::vector<http::File> page_files() {
  const web::DashboardAssets page = web::dashboard_page();
  if (page.html.empty()) return {};
  return {{"/", "text/html; charset=utf-8", page.html},
          {"/dashboard.js", "text/javascript; charset=utf-8", page.script},
          {"/dashboard.css", "text/css; charset=utf-8", page.style}};
}

}  // namespace

int run_live(service::Settings settings, const LiveOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);  // a peer that is gone is an error of its connection
  std::signal(SIGXFSZ, SIG_IGN);  // so is a file that may not grow of the recording
  settings.recording.options.program_version = PALPATE_VERSION;
  settings.dashboard.server.files = page_files();
  service::Service service(settings);
  print_warnings(service.warnings());
  say_where(service, settings, options);
  {
    const ProgressLine line("serve");
    const auto start = std::chrono::steady_clock::now();
    service.run([&] {
      look(service, options, line);
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      if (options.for_s > 0.0 && passed.count() >= options.for_s) std::raise(SIGTERM);  // as if it were told to end
    });
  }
  return summarise(service.finish(), options);
}

}  // namespace palpate::app
