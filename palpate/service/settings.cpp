// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/ndi/tools.hpp>
#include <palpate/recording/toml_table.hpp>
#include <palpate/service/settings.hpp>
#include <set>

namespace palpate::service {

namespace {

using Kind = SourceSettings::Kind;

constexpr NumberRange kPort{0, 65535, "a port, 0 to 65535"};
constexpr std::size_t kRecordsPerCatheter = 1024;  // of the recorder's queue: four seconds at 250 Hz
constexpr double kSecondsPerMillisecond = 1e-3;
constexpr std::size_t kLongestName = 11;  // with ForceBase behind it, OpenIGTLink's 20 bytes

std::uint16_t port(const TomlTable& table, std::uint16_t fallback) {
  return static_cast<std::uint16_t>(table.integer("port", kPort, fallback));
}

/// sensor = "device", for every sensor that the catheter has.
std::map<std::string, std::string> read_devices(const TomlTable& table, const CatheterSettings& catheter) {
  std::map<std::string, std::string> devices;
  if (!table.has("devices")) return devices;
  const toml::table* const entries = table.find("devices")->as_table();
  if (entries == nullptr) table.refuse("devices", "a table: sensor = \"device\"");
  for (const auto& [sensor, device] : *entries) {
    const auto& names = catheter.sensor_names;
    if (std::find(names.begin(), names.end(), sensor.str()) == names.end() || !device.is_string())
      table.refuse("devices", fmt::format("a sensor of {} and the name of a device, not \"{}\"", catheter.file,
                                          printable(sensor.str())));
    devices[std::string(sensor.str())] = device.as_string()->get();
  }
  return devices;
}

/// sensor = "tool", for every sensor that the catheter has, or for none.
std::map<std::string, std::string> read_tools(const TomlTable& table, const CatheterSettings& catheter) {
  std::map<std::string, std::string> tools;
  if (!table.has("tools")) return tools;
  const toml::table* const entries = table.find("tools")->as_table();
  if (entries == nullptr) table.refuse("tools", "a table: sensor = \"tool\"");
  for (const std::string& sensor : catheter.sensor_names) {
    const auto tool = (*entries)[sensor].value<std::string>();
    if (!tool || !ndi::parse_tool_name(*tool))
      table.refuse("tools", fmt::format("for sensor \"{}\" a port handle (\"0A\") or a port and channel (\"1-0\")",
                                        printable(sensor)));
    tools[sensor] = *tool;
  }
  for (const auto& [sensor, tool] : *entries)
    if (!tools.contains(std::string(sensor.str())))
      table.refuse("tools", fmt::format("sensors of {}, not \"{}\"", catheter.file, printable(sensor.str())));
  return tools;
}

SourceSettings read_source(const TomlTable& table, const CatheterSettings& catheter,
                           const std::filesystem::path& folder) {
  SourceSettings out;
  out.kind = table.choice<Kind>("kind",
                                {{"openigtlink", Kind::kOpenIgtLink},
                                 {"file", Kind::kFile},
                                 {"simulation", Kind::kSimulation},
                                 {"ndi", Kind::kNdi},
                                 {"stdin", Kind::kStandardInput}},
                                Kind::kOpenIgtLink);
  out.host = table.text("host", out.host);
  out.port = port(table, out.port);
  out.devices = read_devices(table, catheter);
  out.hold_s = kSecondsPerMillisecond * table.number("hold_ms", {0.0, 1e4, "milliseconds, 0 to 10000"}, 10.0);
  out.tools = read_tools(table, catheter);
  if (out.kind == Kind::kFile || out.kind == Kind::kSimulation || out.kind == Kind::kNdi)
    out.path = folder / table.text("path");
  out.speed = table.number("speed", {0.0, 1e3, "a factor, 0 (as fast as it goes) to 1000"}, out.speed);
  out.loop = table.flag("loop", out.loop);
  return out;
}

CatheterSettings read_entry(const TomlTable& table, const std::filesystem::path& folder) {
  CatheterSettings out = read_catheter(table.text("name"), folder / table.text("file"));
  const auto source =
      table.table("source", {"kind", "host", "port", "devices", "hold_ms", "path", "tools", "speed", "loop"});
  if (!source) table.refuse("source", "where its frames come from: kind = \"openigtlink\", \"file\", ...");
  out.source = read_source(*source, out, folder);
  return out;
}

void read_service(const TomlTable& root, Settings& out) {
  const auto table = root.table("service", {"stale_ms", "real_time_priority", "lock_memory"});
  if (!table) return;
  out.stale_s = kSecondsPerMillisecond * table->number("stale_ms", {20.0, 1e4, "milliseconds, 20 to 10000"}, 100.0);
  out.real_time_priority = table->integer("real_time_priority", {0, 99, "a priority, 0 (none) to 99"}, 0);
  out.lock_memory = table->flag("lock_memory", false);
}

void read_link(const TomlTable& root, LinkSettings& out) {
  const auto table = root.table("openigtlink", {"on", "address", "port", "shape_hz", "health_hz", "most_clients"});
  if (!table) return;
  constexpr NumberRange kRate{1e-3, 1e3, "times a second, up to 1000"};
  out.on = table->flag("on", out.on);
  out.address = table->text("address", out.address);
  out.port = port(*table, out.port);
  out.shape_hz = table->number("shape_hz", kRate, out.shape_hz);
  out.health_hz = table->number("health_hz", kRate, out.health_hz);
  out.most_clients = static_cast<std::size_t>(table->integer("most_clients", {1, 1000, "clients, 1 to 1000"}, 16));
}

void read_recording(const TomlTable& root, const std::filesystem::path& folder, RecordingSettings& out) {
  const auto table = root.table("recording", {"path", "durability", "batch_ms", "queue"});
  if (!table) return;
  out.path = folder / table->text("path");
  out.options.durability = table->choice<session::Durability>(
      "durability", {{"normal", session::Durability::kNormal}, {"full", session::Durability::kFull}},
      session::Durability::kNormal);
  out.options.batch_s =
      kSecondsPerMillisecond * table->number("batch_ms", {10.0, 1e4, "milliseconds, 10 to 10000"}, 100.0);
  out.options.queue = static_cast<std::size_t>(table->integer("queue", {64, 1 << 20, "records, 64 to 1048576"}, 8192));
}

std::vector<double> read_bands(const TomlTable& table, const std::vector<double>& fallback) {
  constexpr const char* kExpected = "one to eight edges, positive and rising, in grams-force";
  const toml::node* const node = table.find("bands_g");
  if (node == nullptr) return fallback;
  const toml::array* const entries = node->as_array();
  if (entries == nullptr || entries->empty() || entries->size() > 8) table.refuse("bands_g", kExpected);
  std::vector<double> edges;
  for (const toml::node& entry : *entries) {
    const std::optional<double> edge = entry.value<double>();
    if (!edge || !(*edge > (edges.empty() ? 0.0 : edges.back()) && *edge <= 1e5)) table.refuse("bands_g", kExpected);
    edges.push_back(*edge);
  }
  return edges;
}

std::vector<std::string> read_hosts(const TomlTable& table) {
  std::vector<std::string> hosts;
  if (!table.has("hosts")) return hosts;
  const toml::array* const entries = table.find("hosts")->as_array();
  if (entries == nullptr) table.refuse("hosts", "names by which a browser calls this computer");
  for (const toml::node& entry : *entries) {
    if (!entry.is_string()) table.refuse("hosts", "names by which a browser calls this computer");
    hosts.push_back(entry.as_string()->get());
  }
  return hosts;
}

void read_dashboard(const TomlTable& root, const std::filesystem::path& folder, DashboardSettings& out) {
  const auto table = root.table(
      "dashboard", {"on", "address", "port", "hosts", "certificate", "key", "most_connections", "bands_g", "unit"});
  if (!table) return;
  out.on = table->flag("on", out.on);
  out.server.address = table->text("address", out.server.address);
  out.server.port = port(*table, out.server.port);
  out.server.hosts = read_hosts(*table);
  if (table->has("certificate")) out.server.certificate = folder / table->text("certificate");
  if (table->has("key")) out.server.key = folder / table->text("key");
  out.server.most_connections =
      static_cast<std::size_t>(table->integer("most_connections", {16, 1000, "connections, 16 to 1000"}, 64));
  out.bands_g = read_bands(*table, out.bands_g);
  out.unit = table->choice<std::string>("unit", {{"g", "g"}, {"mN", "mN"}, {"N", "N"}}, out.unit);
}

}  // namespace

CatheterSettings read_catheter(const std::string& name, const std::filesystem::path& file) {
  CatheterSettings out;
  out.name = name;
  out.file = file.string();
  const TextFile text = read_text_file(file);
  for (const std::string& line : text.lines) out.toml += line + "\n";
  out.settings = parse_catheter(text);
  for (const Sensor& sensor : out.settings.catheter.sensors) out.sensor_names.push_back(sensor.name);
  if (out.settings.catheter.base.tracked) out.sensor_names.push_back(out.settings.catheter.base.sensor.name);
  return out;
}

Settings read_settings(const std::filesystem::path& path) {
  const TextFile file = read_text_file(path);
  const toml::table document = parse_toml(file);
  const TomlTable root(document, "", file.name,
                       {"schema", "service", "recording", "openigtlink", "dashboard", "catheter"});
  if (root.integer("schema", {1, 1, "1"}, 0) != 1) root.refuse("schema", "1");
  const std::filesystem::path folder = path.parent_path();
  Settings out;
  out.source = file.name;
  read_service(root, out);
  read_link(root, out.link);
  read_dashboard(root, folder, out.dashboard);
  read_recording(root, folder, out.recording);
  for (const TomlTable& entry : root.tables("catheter", {"name", "file", "source"}))
    out.catheters.push_back(read_entry(entry, folder));
  if (out.catheters.empty()) root.refuse("catheter", "[[catheter]]: at least one");
  if (const auto* const recording = root.find("recording"); recording && !recording->as_table()->contains("queue"))
    out.recording.options.queue = std::max(out.recording.options.queue, kRecordsPerCatheter * out.catheters.size());
  check(out);
  return out;
}

SourceSettings parse_source(const std::string& text) {
  SourceSettings out;
  if (text == "-") {
    out.kind = Kind::kStandardInput;
    return out;
  }
  constexpr std::string_view kNdi = "ndi:";
  if (text.starts_with(kNdi)) {
    out.kind = Kind::kNdi;
    out.path = text.substr(kNdi.size());
    if (out.path.empty()) throw InputError("source ndi:: expected a serial port: ndi:/dev/ttyUSB0");
    return out;
  }
  std::error_code ignored;
  if (const std::size_t colon = text.rfind(':');
      colon != std::string::npos && colon > 0 && !std::filesystem::exists(text, ignored)) {
    const auto number = parse_integer(text.substr(colon + 1));
    if (!number || *number < 1 || *number > 65535)
      throw InputError(fmt::format("source {}: expected HOST:PORT with a port of 1 to 65535", printable(text)));
    out.host = text.substr(0, colon);
    out.port = static_cast<std::uint16_t>(*number);
    return out;
  }
  out.path = text;
  out.kind = out.path.extension() == ".toml" ? Kind::kSimulation : Kind::kFile;
  return out;
}

namespace {

/// Catheters on one Aurora name their tools, and no tool twice.
void check_tools(const Settings& settings) {
  std::map<std::filesystem::path, const CatheterSettings*> ports;
  std::set<std::pair<std::filesystem::path, std::string>> tools;
  for (const CatheterSettings& catheter : settings.catheters) {
    const SourceSettings& source = catheter.source;
    if (source.kind != Kind::kNdi) continue;
    const auto refuse = [&](const std::string& expectation) {
      throw InputError(fmt::format("{}: catheter \"{}\": source.tools: expected {}", settings.source,
                                   printable(catheter.name), expectation));
    };
    const auto [other, first] = ports.emplace(source.path, &catheter);
    if (!first && (source.tools.empty() || other->second->source.tools.empty()))
      refuse(fmt::format("a tool for every sensor, for \"{}\" is on {} too", printable(other->second->name),
                         source.path.string()));
    for (const auto& [sensor, tool] : source.tools)
      if (!tools.emplace(source.path, tool).second) refuse(fmt::format("tool \"{}\" once", tool));
  }
}

}  // namespace

void check(const Settings& settings) {
  std::set<std::string> names;
  int readers = 0;
  for (const CatheterSettings& catheter : settings.catheters) {
    const auto refuse = [&](std::string_view expectation) {
      throw InputError(fmt::format("{}: catheter.name = \"{}\": expected {}", settings.source, printable(catheter.name),
                                   expectation));
    };
    const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
    if (catheter.name.empty() || catheter.name.size() > kLongestName ||
        !std::all_of(catheter.name.begin(), catheter.name.end(), plain))
      refuse(fmt::format("1 to {} letters, digits, - or _: it begins the names of OpenIGTLink devices", kLongestName));
    if (!names.insert(catheter.name).second) refuse("a name that no other catheter has");
    readers += catheter.source.kind == Kind::kStandardInput ? 1 : 0;
    if (readers > 1) refuse("no second source \"stdin\": there is one standard input");
  }
  check_tools(settings);
}

}  // namespace palpate::service
