// SPDX-License-Identifier: Apache-2.0
#include <palpate/service/service_parts.hpp>

namespace palpate::service {

namespace {

nlohmann::json recording_json(const std::string& path, const session::WriterHealth& health) {
  return {{"path", path},
          {"offered", health.offered},
          {"dropped", health.dropped},
          {"committed", health.committed},
          {"committed_frames", health.committed_frames},
          {"failing", health.failing},
          {"error", health.error}};
}

nlohmann::json server_json(const link::ServerHealth& health) {
  return {{"clients", health.clients},
          {"accepted", health.accepted},
          {"refused", health.refused},
          {"sent", health.sent},
          {"dropped", health.dropped},
          {"closed_stuck", health.closed_stuck},
          {"closed_malformed", health.closed_malformed}};
}

nlohmann::json web_json(const http::ServerHealth& health) {
  return {
      {"clients", health.clients},     {"connections", health.connections},   {"accepted", health.accepted},
      {"refused", health.refused},     {"unauthorized", health.unauthorized}, {"forbidden", health.forbidden},
      {"malformed", health.malformed}, {"timed_out", health.timed_out},       {"sent", health.sent},
      {"dropped", health.dropped},     {"closed_stuck", health.closed_stuck}, {"last_refusal", health.last_refusal}};
}

nlohmann::json source_json(const LinkSource& source) {
  const link::ClientHealth& health = source.health();
  return {{"server", source.server()},
          {"connected", health.connected},
          {"connections", health.connections},
          {"messages", health.messages},
          {"malformed", health.malformed},
          {"error", health.error},
          {"unknown_device", source.unknown_device()}};
}

nlohmann::json source_json(const NdiSource& source) {
  const ndi::TrackerHealth health = source.health();
  return {{"server", source.port()},
          {"connected", health.connected},
          {"connections", health.connections},
          {"frames", health.frames},
          {"repeats", health.repeats},
          {"malformed", health.malformed},
          {"unanswered", health.unanswered},
          {"out_of_volume", health.out_of_volume},
          {"error", health.error}};
}

nlohmann::json latency_json(const LatencyHistogram& latency) {
  nlohmann::json bins = nlohmann::json::array();
  for (const auto& [upper_s, count] : latency.bins()) bins.push_back({upper_s, count});
  return {{"count", latency.count()},
          {"histogram", std::move(bins)},
          {"p50_s", latency.percentile_s(0.5)},
          {"p99_s", latency.percentile_s(0.99)},
          {"p99_9_s", latency.percentile_s(0.999)},
          {"most_s", latency.most_s()}};
}

}  // namespace

nlohmann::json Service::Parts::health() const {
  nlohmann::json out{{"catheters", nlohmann::json::array()}, {"latency", latency_json(loop->latency())}};
  for (const CatheterView& view : views) out["catheters"].push_back(catheter_json(view, clock.now_ns()));
  if (writer) out["recording"] = recording_json(settings.recording.path.string(), writer->health());
  if (server) out["openigtlink"] = server_json(server->health());
  if (web) out["dashboard"] = web_json(web->health());
  out["network_dropped"] = network.dropped();
  out["refusals"] = refusals;
  for (const LinkSource& link : links) out["sources"].push_back(source_json(link));
  for (const NdiSource& aurora : auroras) out["sources"].push_back(source_json(aurora));
  return out;
}

void Service::Parts::answer(const http::Request& request, const http::Server::Reply& reply) {
  constexpr std::string_view kApi = "/api";
  if (request.method == "GET" && request.target == "/api/health") return reply({200, text_of(health())});
  if (request.method != "POST" || !request.target.starts_with(kApi))
    return reply({404, nlohmann::json{{"error", "expected GET /api/health, or POST /api/..."}}.dump()});
  operators->take(std::string_view(request.target).substr(kApi.size()), request.body,
                  [reply](const Operator::Answer& answer) {
                    reply({answer.http_status, text_of(answer.body)});
                  });
}

}  // namespace palpate::service
