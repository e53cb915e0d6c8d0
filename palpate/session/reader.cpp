// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/session/lost_rows.hpp>
#include <palpate/session/reader.hpp>
#include <palpate/session/row_codec.hpp>
#include <palpate/session/row_cursor.hpp>

namespace palpate::session {

namespace {

using At = RowCursor::At;

const std::string kChanged = "is not what was written";
const std::string kNotThere = "is not there";

std::vector<SessionCatheter> read_catheters(const store::Database& database) {
  std::vector<SessionCatheter> catheters;
  store::Statement row = database.prepare("SELECT name, file, toml FROM catheter ORDER BY id");
  while (row.step()) catheters.push_back({row.text(0), row.text(1), row.text(2), {}});
  store::Statement sensor = database.prepare("SELECT catheter, name FROM sensor ORDER BY catheter, position");
  while (sensor.step()) {
    const auto index = static_cast<std::size_t>(sensor.integer(0));
    if (index < catheters.size()) catheters[index].sensor_names.push_back(sensor.text(1));
  }
  return catheters;
}

/// One line for each catheter that is not the one that was written. Without its sum it is taken as it is.
std::vector<std::string> changed_catheters(const OpenSession& session, const std::vector<SessionCatheter>& catheters) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < catheters.size(); ++i) {
    const auto id = static_cast<std::int64_t>(i);
    store::Statement row = session.database->prepare("SELECT value FROM session WHERE key = ?");
    if (!row.bind(1, checksum_key(id)).step() || row.integer(0) == checksum(catheters[i], id)) continue;
    lines.push_back(fmt::format("{}: catheter \"{}\": its file or its sensors' names are not what was written",
                                session.path.string(), catheters[i].name));
  }
  return lines;
}

std::int64_t last_id(const store::Database& database, Table table) {
  try {
    return database.integer(fmt::format("SELECT max(id) FROM {}", table_name(table)));
  } catch (const InputError&) {
    return 0;
  }
}

}  // namespace

struct SessionReader::Implementation {
  Implementation(OpenSession opened, Wanted what)
      : session(std::move(opened)),
        wanted(what),
        lost(session),
        frames(*session.database, Table::kFrame),
        readings(*session.database, Table::kReading),
        estimates(*session.database, Table::kEstimate),
        extras(*session.database, Table::kExtra),
        events(*session.database, Table::kEvent) {
    session.database->execute("BEGIN");  // one moment of a session that is being written
    try {
      catheters = read_catheters(*session.database);
      for (std::string& line : changed_catheters(session, catheters)) session.damage.push_back(std::move(line));
    } catch (const InputError& error) {
      session.damage.push_back(fmt::format("{}: what the catheters are cannot be read", error.what()));
    }
  }

  bool hold_frame();
  bool hold_event();
  bool assemble(std::int64_t id);
  bool take_readings(std::int64_t id);
  EstimateState take_estimate_of(std::int64_t id);
  void finish();

  /// A row that may not be what it says: why it was refused.
  bool refuse(Table table, const std::string& why) {
    refused_table = table;
    refused_why = why;
    return false;
  }
  bool refuse(Table table, const RowCursor& cursor, At at) {
    return refuse(table, at == At::kDamage ? cursor.error() : kNotThere);
  }

  OpenSession session;
  Wanted wanted;
  LostRows lost;
  RowCursor frames, readings, estimates, extras, events;
  std::vector<SessionCatheter> catheters;
  std::vector<std::string> damage;

  LiveRecord frame, event;  ///< read ahead
  EstimateState held_state = EstimateState::kWhole, state = EstimateState::kWhole;
  bool frame_held = false, event_held = false, finished = false, started = false, events_started = false;
  std::int64_t next_frame = 1, next_event = 1, frame_id = 0, after_frame = 0;
  Table refused_table = Table::kFrame;
  std::string refused_why;
};

bool SessionReader::Implementation::take_readings(std::int64_t id) {
  const auto catheter = static_cast<std::size_t>(frame.catheter);
  const std::size_t sensors = catheter < catheters.size() ? catheters[catheter].sensor_names.size() : 0;
  auto& all = frame.frame.readings;
  SensorReading absent;
  absent.status = SensorReading::Status::kAbsent;
  all.assign(sensors, absent);
  const std::int64_t first = kReadingsPerFrame * id;
  for (At at = readings.seek(first);; at = readings.step()) {
    if (at == At::kDamage) return refuse(Table::kReading, readings, at);
    if (at == At::kEnd || readings.id() >= first + kReadingsPerFrame) return true;
    if (readings.id() < first) return refuse(Table::kReading, kChanged);  // a tree that leads astray
    const auto place = static_cast<std::size_t>(readings.id() - first);
    if (place >= all.size()) all.resize(place + 1, absent);
    if (!take_reading(readings.row(), all[place])) return refuse(Table::kReading, kChanged);
  }
}

EstimateState SessionReader::Implementation::take_estimate_of(std::int64_t id) {
  frame.estimate = Estimate();
  const At at = estimates.seek(id);
  if (at != At::kRow || estimates.id() != id) {
    refuse(Table::kEstimate, estimates, at);
    return EstimateState::kLost;
  }
  std::int64_t stated = 0;
  bool whole = take_estimate(estimates.row(), frame.estimate, stated);
  const At extra = extras.seek(id);
  if (extra == At::kRow && extras.id() == id) take_extra(extras.row(), frame.estimate);
  if (extra == At::kDamage) {
    refuse(Table::kExtra, extras, extra);
    return EstimateState::kChanged;
  }
  whole = whole && checksum(frame.estimate, id) == stated;
  if (!whole) refuse(Table::kEstimate, kChanged);
  return whole ? EstimateState::kWhole : EstimateState::kChanged;
}

/// The frame at which `frames` stands, with all that belongs to it; false: not all of it is as it was written.
bool SessionReader::Implementation::assemble(std::int64_t id) {
  std::int64_t stated = 0;
  if (!take_frame(frames.row(), frame, stated) || frame.catheter < 0) return refuse(Table::kFrame, kChanged);
  if (!catheters.empty() && static_cast<std::size_t>(frame.catheter) >= catheters.size())
    return refuse(Table::kFrame, kChanged);
  if (!take_readings(id)) return false;
  if (checksum(frame, id) != stated) return refuse(Table::kFrame, kChanged);
  const std::string why = refused_why;  // of the frames before, if any
  const Table table = refused_table;
  held_state = take_estimate_of(id);
  if (held_state == EstimateState::kWhole) return true;
  if (wanted == Wanted::kWhole) return false;
  if (id > next_frame) lost.add("frame", next_frame, id - 1, table, why.empty() ? kNotThere : why);
  next_frame = id;
  lost.add("estimate", id, id, refused_table, refused_why);
  refused_why.clear();
  return true;
}

bool SessionReader::Implementation::hold_frame() {
  if (frame_held) return true;
  std::int64_t seen = next_frame - 1;  ///< ids up to here have been looked at, whole or not
  At at = started ? frames.step() : frames.seek(1);
  started = true;
  for (;; at = frames.step()) {
    if (at == At::kDamage) {
      refuse(Table::kFrame, frames, at);
      at = frames.recover(seen + 1);
    }
    if (at == At::kEnd) return false;
    if (frames.id() < next_frame) continue;  // its id is not what was written
    if (frames.id() > next_frame && seen < next_frame && refused_why.empty()) refuse(Table::kFrame, kNotThere);
    if (assemble(frames.id())) break;
    seen = std::max(seen, frames.id());
  }
  frame_id = frames.id();
  if (frame_id > next_frame)
    lost.add("frame", next_frame, frame_id - 1, refused_table, refused_why.empty() ? kNotThere : refused_why);
  refused_why.clear();
  next_frame = frame_id + 1;
  return frame_held = true;
}

bool SessionReader::Implementation::hold_event() {
  if (event_held) return true;
  std::string why;
  std::int64_t seen = next_event - 1;
  At at = events_started ? events.step() : events.seek(1);
  events_started = true;
  for (;; at = events.step()) {
    if (at == At::kDamage) {
      why = events.error();
      at = events.recover(seen + 1);
    }
    if (at == At::kEnd) {
      if (!why.empty()) lost.add_tail("event", next_event, Table::kEvent, why);
      return false;
    }
    std::int64_t stated = 0;
    take_event(events.row(), event, after_frame, stated);
    if (events.id() >= next_event && checksum(event, events.id()) == stated) break;
    why = kChanged;
    seen = std::max(seen, events.id());
  }
  if (events.id() > next_event)
    lost.add("event", next_event, events.id() - 1, Table::kEvent, why.empty() ? kNotThere : why);
  next_event = events.id() + 1;
  return event_held = true;
}

/// What stands behind the last frame that was whole.
void SessionReader::Implementation::finish() {
  if (finished) return;
  finished = true;
  const std::int64_t last =
      std::max({last_id(*session.database, Table::kFrame), last_id(*session.database, Table::kEstimate),
                last_id(*session.database, Table::kReading) / kReadingsPerFrame});
  if (last >= next_frame)
    lost.add("frame", next_frame, last, refused_table, refused_why.empty() ? kNotThere : refused_why);
  else if (!refused_why.empty())
    lost.add_tail("frame", next_frame, refused_table, refused_why);
  damage = lost.lines();
}

SessionReader::SessionReader(const std::filesystem::path& path, Wanted wanted)
    : implementation_(std::make_unique<Implementation>(open_session(path), wanted)) {}
SessionReader::~SessionReader() = default;
SessionReader::SessionReader(SessionReader&&) noexcept = default;

const std::vector<SessionCatheter>& SessionReader::catheters() const { return implementation_->catheters; }
EstimateState SessionReader::estimate_state() const { return implementation_->state; }
const std::vector<std::string>& SessionReader::damage() const { return implementation_->damage; }
std::int64_t SessionReader::lost() const { return implementation_->lost.count(); }

std::string SessionReader::about(const std::string& key) const {
  try {
    store::Statement row = implementation_->session.database->prepare("SELECT value FROM session WHERE key = ?");
    return row.bind(1, key).step() ? row.text(0) : std::string();
  } catch (const InputError&) {
    return {};
  }
}

bool SessionReader::next(LiveRecord& record) {
  Implementation& all = *implementation_;
  if (all.finished) return false;
  const bool frame = all.hold_frame(), event = all.hold_event();
  if (event && (!frame || all.after_frame < all.frame_id)) {
    record = all.event;
    all.event_held = false;
    return true;
  }
  if (frame) {
    record = all.frame;
    all.state = all.held_state;
    all.frame_held = false;
    return true;
  }
  all.finish();
  return false;
}

}  // namespace palpate::session
