// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/session/catheter_change.hpp>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/replay.hpp>
#include <palpate/session/session_run_reader.hpp>

namespace palpate::session {

namespace {

ReplayDifference differs(std::string_view field, std::string stored, std::string now) {
  ReplayDifference difference;
  difference.field = field;
  difference.stored = std::move(stored);
  difference.now = std::move(now);
  return difference;
}

template <typename Numbers, typename Names>
std::optional<ReplayDifference> first_number(const Numbers& stored, const Numbers& now, const Names& names) {
  for (std::size_t i = 0; i < stored.size(); ++i)
    if (!same_number(stored[i], now[i]))
      return differs(names[i], fmt::format("{}", stored[i]), fmt::format("{}", now[i]));
  return std::nullopt;
}

std::optional<ReplayDifference> first_code(const Estimate& stored, const Estimate& now) {
  if (stored.status != now.status)
    return differs("status", std::string(palpate::describe(stored.status)), std::string(palpate::describe(now.status)));
  if (stored.time != now.time)
    return differs("time_verdict", std::string(describe(stored.time)), std::string(describe(now.time)));
  struct Code {
    std::string_view name;
    std::int64_t stored, now;
  };
  const std::array<Code, 8> codes{
      {{"used", stored.used, now.used},
       {"sensors_used", stored.sensors_used, now.sensors_used},
       {"dof", stored.dof, now.dof},
       {"jumped", stored.jumped, now.jumped},
       {"evaluations", stored.evaluations, now.evaluations},
       {"rejections", packed_rejections(stored), packed_rejections(now)},
       {"hidden", observability_bits(stored.observability), observability_bits(now.observability)},
       {"lagged_age_frames", stored.lagged.age_frames, now.lagged.age_frames}}};
  for (const Code& code : codes)
    if (code.stored != code.now) return differs(code.name, fmt::format("{}", code.stored), fmt::format("{}", code.now));
  return std::nullopt;
}

/// One catheter while it is replayed.
class Player {
 public:
  explicit Player(const SessionCatheter& catheter) : settings_(settings_of(catheter)), name_(catheter.name) { make(); }

  void apply(const LiveRecord& event) {
    if (apply_event(event, settings_)) make();
  }
  Estimate play(const LiveRecord& record, EstimateState stored, ReplayReport& report) {
    Estimate now = observer_->update(record.frame);
    ++report.frames;
    if (stored == EstimateState::kLost) ++report.lost;
    if (stored == EstimateState::kLost) return now;
    auto difference = first_difference(record.estimate, now);
    if (!difference) return now;
    if (report.different++ > 0) return now;
    difference->catheter = name_;
    difference->frame = record.frame.number;
    difference->time_s = record.frame.time_s;
    report.first = std::move(difference);
    return now;
  }
  std::uint64_t observers() const { return observers_; }

 private:
  void make() {
    observer_ = std::make_unique<ForceObserver>(settings_.catheter, settings_.observer);
    ++observers_;
  }
  CatheterFile settings_;
  std::string name_;
  std::unique_ptr<ForceObserver> observer_;
  std::uint64_t observers_ = 0;
};

}  // namespace

std::optional<ReplayDifference> first_difference(const Estimate& stored, const Estimate& now) {
  EstimateNumbers stored_numbers{}, now_numbers{};
  numbers_of(stored, stored_numbers);
  numbers_of(now, now_numbers);
  if (auto difference = first_code(stored, now)) return difference;
  if (auto difference = first_number(stored_numbers, now_numbers, estimate_number_names())) return difference;
  ExtraNumbers stored_extra{}, now_extra{};
  extra_numbers_of(stored, stored_extra);
  extra_numbers_of(now, now_extra);
  return first_number(stored_extra, now_extra, extra_number_names());
}

ReplayReport replay(const std::filesystem::path& path, const ReplayOptions& options) {
  SessionReader reader(path, Wanted::kFrames);
  if (reader.catheters().empty())
    throw InputError(
        fmt::format("{}: expected the settings of at least one catheter, found none that can be read", path.string()));
  std::vector<std::unique_ptr<Player>> players(reader.catheters().size());
  const std::size_t chosen =
      options.catheter.empty() ? players.size() : find_catheter(reader, path.string(), options.catheter);
  for (std::size_t i = 0; i < players.size(); ++i)
    if (options.catheter.empty() || i == chosen) players[i] = std::make_unique<Player>(reader.catheters()[i]);
  ReplayReport report;
  LiveRecord record;
  while (reader.next(record)) {
    for (std::size_t i = 0; i < players.size(); ++i) {
      if (!players[i] || (record.catheter != -1 && record.catheter != static_cast<int>(i))) continue;
      if (record.kind == LiveRecord::Kind::kEvent) {
        players[i]->apply(record);
        continue;
      }
      const Estimate now = players[i]->play(record, reader.estimate_state(), report);
      if (options.each) options.each(record, now);
    }
  }
  for (const auto& player : players) report.observers += player ? player->observers() : 0;
  report.damage = reader.damage();
  return report;
}

}  // namespace palpate::session
