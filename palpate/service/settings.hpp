// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <palpate/http/server.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/session/writer.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::service {

/// Where the frames of one catheter come from.
struct SourceSettings {
  enum class Kind : std::uint8_t {
    kOpenIgtLink,    ///< a PLUS server, or whatever speaks as one
    kFile,           ///< a recording of any format, or a session
    kSimulation,     ///< a scenario file
    kStandardInput,  ///< tracker CSV, line by line
    kNdi,            ///< an NDI Aurora on a serial port
    kDemo,           ///< a beating heart that the program brings along
  };

  Kind kind = Kind::kOpenIgtLink;
  std::string host = "127.0.0.1";
  std::uint16_t port = 18944;
  std::map<std::string, std::string> devices = {};  ///< sensor -> device; else `NAME` or `NAMETo...`
  double hold_s = 0.01;             ///< how long a frame waits for a sensor that was in the one before; range [0, 10]
  std::filesystem::path path = {};  ///< of a file, scenario or serial port
  std::map<std::string, std::string> tools =
      {};              ///< of an Aurora: sensor -> port handle ("0A") or PORT-CHANNEL ("1-0")
  double speed = 1.0;  ///< of a file or scenario; 0: as fast as it goes; range [0, 1000]
  bool loop = false;   ///< begins again at the end, time goes on
};

struct CatheterSettings {
  std::string name;  ///< at most 11 characters: OpenIGTLink's device names have 20
  std::string file;  ///< its catheter file, for messages
  std::string toml;  ///< and the text of it
  CatheterFile settings;
  std::vector<std::string> sensor_names;  ///< order of the readings: as Catheter::sensors, a tracked base last
  SourceSettings source;
};

struct LinkSettings {
  bool on = true;
  std::string address = "127.0.0.1";
  std::uint16_t port = 18945;  ///< 0: any free one
  double shape_hz = 30.0;      ///< tip pose and shape, at most; range (0, 1000]
  double health_hz = 10.0;     ///< likewise
  std::size_t most_clients = 16;
};

/// The page in the browser, and the control interface beside it.
struct DashboardSettings {
  bool on = true;
  http::ServerOptions server{.port = 18946};              ///< address, port, names, certificate; port 0: any free one
  std::vector<double> bands_g = {5.0, 10.0, 30.0, 40.0};  ///< edges of the number's colours; positive, rising
  std::string unit = "g";                                 ///< that it begins with: g, mN, N
};

struct RecordingSettings {
  std::filesystem::path path;  ///< empty: nothing is recorded
  session::WriterOptions options;
};

/// What `palpate serve` is to do (docs/reference/serve.md).
struct Settings {
  std::string source;  ///< the file it was read from, for messages
  std::vector<CatheterSettings> catheters;
  LinkSettings link;
  DashboardSettings dashboard;
  RecordingSettings recording;
  double stale_s = 0.1;        ///< least silence that counts as one; range [0.02, 10]
  int real_time_priority = 0;  ///< of the observer's thread (SCHED_FIFO); 0: as any other; range [0, 99]
  bool lock_memory = false;
  std::vector<std::string> warnings;
};

/// Reads TOML, and the catheter files it names, which are found from its own folder. Throws InputError
/// `FILE:LINE: KEY = VALUE: expected ...`.
Settings read_settings(const std::filesystem::path& path);

/// One catheter that the program brings along, before a beating heart.
Settings demo_settings();

/// Catheter file read, text kept, sensors named. Throws InputError.
CatheterSettings read_catheter(const std::string& name, const std::filesystem::path& file);

/// A source as typed: `HOST:PORT`, `-` for standard input, `ndi:PORT` for an Aurora, a scenario (.toml), or a
/// recording. Throws InputError.
SourceSettings parse_source(const std::string& text);

/// Throws InputError on names that OpenIGTLink has no room for or that stand twice, where two catheters want standard
/// input, and where they share an Aurora but not its tools.
void check(const Settings& settings);

}  // namespace palpate::service
