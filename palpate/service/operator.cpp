// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <boost/asio/post.hpp>
#include <cmath>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/service/operator.hpp>
#include <palpate/session/catheter_change.hpp>

namespace palpate::service {

namespace {

using nlohmann::json;

Operator::Answer refusal(int http_status, const std::string& error) { return {http_status, {{"error", error}}}; }

/// Throws InputError naming the field, what it was and what was expected.
[[noreturn]] void refuse(const json& body, const char* field, const char* expectation) {
  throw InputError(
      fmt::format("{} = {}: expected {}", field, printable(body.value(field, json()).dump()), expectation));
}

double number(const json& body, const char* field, double fallback, double least, double most,
              const char* expectation) {
  if (!body.contains(field)) return fallback;
  const json& value = body.at(field);
  if (!value.is_number() || !(value.get<double>() >= least && value.get<double>() <= most))
    refuse(body, field, expectation);
  return value.get<double>();
}

template <int Size>
Eigen::Matrix<double, Size, 1> numbers(const json& body, const char* field, const char* expectation) {
  const json value = body.value(field, json());
  if (!value.is_array() || value.size() != Size) refuse(body, field, expectation);
  Eigen::Matrix<double, Size, 1> out;
  for (std::size_t i = 0; i < Size; ++i) {
    if (!value[i].is_number()) refuse(body, field, expectation);
    out(static_cast<Eigen::Index>(i)) = value[i].get<double>();
  }
  return out;
}

BaseRegistration read_base(const json& body, BaseRegistration base) {
  const Eigen::Vector4d q = numbers<4>(body, "quaternion_wxyz", "four numbers, a unit quaternion w, x, y, z");
  if (std::abs(q.norm() - 1.0) > 1e-3) refuse(body, "quaternion_wxyz", "four numbers, a unit quaternion w, x, y, z");
  base.T_tracker_base.R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
  base.T_tracker_base.p =
      kMetresPerMillimetre * numbers<3>(body, "position_mm", "three numbers, millimetres in the tracker's frame");
  base.position_sigma_m =
      kMetresPerMillimetre * number(body, "position_sigma_mm", base.position_sigma_m * kMillimetresPerMetre, 0.0, 1e3,
                                    "millimetres, 0 to 1000");
  base.rotation_sigma_rad =
      kRadiansPerDegree *
      number(body, "rotation_sigma_deg", base.rotation_sigma_rad / kRadiansPerDegree, 0.0, 180.0, "degrees, 0 to 180");
  base.covariance.reset();
  return base;
}

bool can_be_tared(const Catheter& catheter) {
  const bool base =
      !catheter.base.tracked && (catheter.base.position_sigma_m > 0.0 || catheter.base.rotation_sigma_rad > 0.0);
  return base || !catheter.precurvature_sigma_per_m.isZero(0.0);
}

json report(const Tare& tare) {
  const auto list = [](const Vector3d& v) { return json::array({v.x(), v.y(), v.z()}); };
  return {{"frames", tare.frames},
          {"outliers", tare.outliers},
          {"base_shift_m", list(tare.base_shift_m)},
          {"base_rotation_rad", list(tare.base_rotation_rad)},
          {"precurvature_change_per_m", list(tare.precurvature_change_per_m)},
          {"largest_change_sigmas", tare.largest_change_sigmas},
          {"residual_before_m", tare.residual_before_m},
          {"residual_after_m", tare.residual_after_m}};
}

}  // namespace

Operator::Operator(boost::asio::io_context& io, const HostClock& clock, ObserverLoop& loop,
                   std::vector<CatheterView>& views, std::function<void(std::size_t)> changed)
    : io_(io), clock_(clock), loop_(loop), views_(views), changed_(std::move(changed)) {}

void Operator::take(std::string_view path, const std::string& text, const Reply& reply) {
  const json body = json::parse(text.empty() ? "{}" : text, nullptr, false);
  if (!body.is_object()) return reply(refusal(400, "body: expected a JSON object"));
  try {
    if (path == "/notes") return note(body, reply);
    constexpr std::string_view kCatheters = "/catheters/";
    const std::size_t slash = path.rfind('/');
    if (!path.starts_with(kCatheters) || slash < kCatheters.size())
      return reply(refusal(
          404, fmt::format("{}: expected /api/catheters/NAME/tare, base or tendon, or /api/notes", printable(path))));
    const std::string_view name = path.substr(kCatheters.size(), slash - kCatheters.size()),
                           what = path.substr(slash + 1);
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (views_[i].settings->name != name) continue;
      if (what == "base") return base(i, body, reply);
      if (what == "tendon") return tendon(i, body, reply);
      if (what != "tare") return reply(refusal(404, fmt::format("{}: expected tare, base or tendon", printable(what))));
      const LiveState state = state_of(views_[i], clock_.now_ns());
      if (views_[i].recent.empty() || state == LiveState::kWaiting || state == LiveState::kStale)
        return reply(refusal(409, fmt::format("tare: expected frames that come now, not {}", describe(state))));
      if (body.contains("straight") && !body.at("straight").is_boolean()) refuse(body, "straight", "true or false");
      const double seconds = number(body, "seconds", 1.0, 0.05, CatheterView::kRecent_s, "seconds, 0.05 to 10");
      const double to_s = views_[i].recent.back().time_s;
      return tare(i, {.from_s = to_s - seconds, .to_s = to_s, .straight = body.value("straight", false)}, reply);
    }
    reply(refusal(404, fmt::format("catheter \"{}\": not known", printable(name))));
  } catch (const InputError& error) {
    reply(refusal(400, error.what()));
  } catch (const json::exception& error) {
    reply(refusal(400, error.what()));
  }
}

void Operator::tare(std::size_t index, const TareInterval& interval, const Reply& reply) {
  const CatheterView& view = views_[index];
  if (!can_be_tared(view.catheter))
    return reply(refusal(409,
                         "tare: the catheter file is sure of base and precurvature (every sigma is 0): nothing is "
                         "to be corrected"));
  std::vector<TrackerFrame> frames;
  for (const TrackerFrame& frame : view.recent)
    if (frame.time_s >= interval.from_s && frame.time_s <= interval.to_s) frames.push_back(frame);
  boost::asio::post(pool_, [this, index, interval, reply, frames = std::move(frames), catheter = view.catheter] {
    try {
      const Tare found = palpate::tare(catheter, frames, interval);
      boost::asio::post(io_,
                        [this, index, reply, found] { exchange(index, "tare", found.catheter, report(found), reply); });
    } catch (const InputError& error) {
      boost::asio::post(io_, [reply, what = std::string(error.what())] { reply(refusal(409, what)); });
    }
  });
}

void Operator::base(std::size_t index, const json& body, const Reply& reply) {
  Catheter catheter = views_[index].catheter;
  if (catheter.base.tracked) return reply(refusal(409, "base: it is tracked by a sensor of its own"));
  catheter.base = read_base(body, catheter.base);
  exchange(index, "base", catheter, json::object(), reply);
}

void Operator::tendon(std::size_t index, const json& body, const Reply& reply) {
  if (!views_[index].catheter.tendon.present)
    return reply(refusal(409, "tendon: the catheter file has no [tendon]: expected its model"));
  Command command{.catheter = static_cast<int>(index), .event = "tendon", .data = text_of(body)};
  command.sets_tendon = true;
  command.tendon = {.present = true,
                    .moment_Nm = numbers<2>(body, "moment_Nm", "two numbers, N m about d1 and d2"),
                    .sigma_Nm = number(body, "sigma_Nm", 0.0, 0.0, 1e3, "N m, 0 to 1000")};
  const bool taken = loop_.command(std::move(command));
  reply(taken ? Answer{200, {{"tendon", body}}} : refusal(503, "tendon: too many commands wait"));
}

void Operator::note(const json& body, const Reply& reply) {
  if (!body.contains("text") || !body["text"].is_string()) refuse(body, "text", "what is to be noted");
  int index = -1;
  for (std::size_t i = 0; i < views_.size(); ++i)
    if (body.contains("catheter") && body["catheter"] == views_[i].settings->name) index = static_cast<int>(i);
  if (body.contains("catheter") && index < 0) refuse(body, "catheter", "the name of a catheter");
  const bool taken = loop_.command({.catheter = index, .event = "note", .data = text_of({{"text", body["text"]}})});
  reply(taken ? Answer{200, {{"note", body["text"]}}} : refusal(503, "note: too many commands wait"));
}

/// The new observer is made here and handed over between two frames.
void Operator::exchange(std::size_t index, const std::string& event, const Catheter& catheter, json data,
                        const Reply& reply) {
  CatheterView& view = views_[index];
  std::unique_ptr<ForceObserver> observer;
  try {
    catheter.validate();
    observer = std::make_unique<ForceObserver>(catheter, view.settings->settings.observer);
  } catch (const InputError& error) {
    return reply(refusal(409, error.what()));
  }
  json recorded = data;
  recorded["catheter"] = session::catheter_change(catheter);
  if (!loop_.command({.catheter = static_cast<int>(index),
                      .event = event,
                      .data = text_of(recorded),
                      .observer = std::move(observer)}))
    return reply(refusal(503, fmt::format("{}: too many commands wait", event)));
  view.catheter = catheter;
  changed_(index);
  reply({200, {{event, std::move(data)}}});
}

void Operator::look_for_reference() {
  for (std::size_t i = 0; i < views_.size(); ++i) {
    CatheterView& view = views_[i];
    const ReferenceInterval& reference = view.settings->settings.reference;
    if (!reference.given || view.reference_done || view.recent.empty()) continue;
    if (view.recent.back().time_s < view.first_time_s + reference.to_s) continue;
    view.reference_done = true;
    tare(i, {view.first_time_s + reference.from_s, view.first_time_s + reference.to_s, reference.straight},
         [this, i](const Answer& answer) {
           if (answer.http_status == 200) return;
           const json data{{"text", answer.body["error"]}};
           [[maybe_unused]] const bool said =
               loop_.command({.catheter = static_cast<int>(i), .event = "not tared", .data = text_of(data)});
         });
  }
}

}  // namespace palpate::service
