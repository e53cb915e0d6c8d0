// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/session/session_run_reader.hpp>

namespace palpate::session {

TextFile text_file(const std::string& name, const std::string& text) {
  TextFile file;
  file.name = name;
  file.ends_with_newline = text.ends_with('\n');
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    file.lines.push_back(text.substr(at, end - at));
    if (file.lines.back().ends_with('\r')) file.lines.back().pop_back();
    at = end + 1;
  }
  return file;
}

CatheterFile settings_of(const SessionCatheter& catheter) {
  return parse_catheter(text_file(catheter.file.empty() ? catheter.name : catheter.file, catheter.toml));
}

std::size_t find_catheter(const SessionReader& reader, const std::string& path, const std::string& name) {
  const auto& catheters = reader.catheters();
  if (name.empty() && catheters.size() == 1) return 0;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < catheters.size(); ++i) {
    if (!name.empty() && catheters[i].name == name) return i;
    names.push_back(catheters[i].name);
  }
  throw InputError(
      fmt::format("{}: catheter \"{}\": expected one of its {}: {}", path, name, names.size(), fmt::join(names, ", ")));
}

std::string in_words(const LiveRecord& event) {
  if (event.data.empty() || event.data == "{}") return event.event;
  const nlohmann::json data = nlohmann::json::parse(event.data, nullptr, false);
  const bool says = data.is_object() && data.size() == 1 && data.contains("text") && data["text"].is_string();
  return fmt::format("{}: {}", event.event, says ? data["text"].get<std::string>() : event.data);
}

SessionRunReader::SessionRunReader(const std::filesystem::path& path, const std::string& catheter) : reader_(path) {
  catheter_ = static_cast<int>(find_catheter(reader_, path.string(), catheter));
  const SessionCatheter& chosen = reader_.catheters()[static_cast<std::size_t>(catheter_)];
  description_.source = path.string();
  description_.catheter_source = chosen.file;
  description_.catheter_text = chosen.toml;
  description_.settings = settings_of(chosen);
  description_.sensor_names = chosen.sensor_names;
  description_.has_estimates = true;
}

bool SessionRunReader::next(RunMoment& moment) {
  LiveRecord record;
  while (reader_.next(record)) {
    if (record.catheter != catheter_ && record.catheter != -1) continue;
    if (record.kind == LiveRecord::Kind::kFrame) {
      TrackerFrame time;
      time.time_s = record.frame.time_s;
      times_.push_back(time);
      for (std::string& text : early_) events_.push_back({time.time_s, std::move(text)});
      early_.clear();
      moment.frame = std::move(record.frame);
      moment.estimate = row_of(record.estimate);
      return true;
    }
    if (times_.empty())
      early_.push_back(in_words(record));
    else
      events_.push_back({times_.back().time_s, in_words(record)});
  }
  finish();
  return false;
}

void SessionRunReader::finish() {
  if (finished_) return;
  finished_ = true;
  gaps_ = find_gaps(times_);
  std::vector<RunEvent> whole;
  for (const std::string& line : reader_.damage()) whole.push_back({std::nullopt, line});
  for (std::string& text : early_) whole.push_back({std::nullopt, std::move(text)});
  events_.insert(events_.begin(), whole.begin(), whole.end());
}

}  // namespace palpate::session
