// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <palpate/sensing/tracker_frame.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace palpate::test {

/// An Aurora on the master side of a pseudo-terminal, written from the description of the protocol and not from the
/// product's codec: other checksum, other encoder. Two sensors on one plug (port 1, channels 0 and 1; handles 0A and
/// 0B): the second handle appears once the first is initialised.
class AuroraSimulator {
 public:
  /// What goes wrong with the answer to one BX.
  enum class Fault : std::uint8_t { kDroppedByte, kFlippedBit, kError, kSilent, kRubbish, kReset, kSplit };

  struct Script {
    std::vector<TrackerFrame> frames;  ///< two readings each; the last stays
    int questions_a_frame = 1;         ///< BX tells every frame so often
    std::uint32_t first_number = 0x00000FF0;
    std::map<int, Fault> faults = {};  ///< by the number of the BX, from 0
    std::set<int> outside = {};        ///< frames in which sensor 1 is out of volume
    std::set<int> behind = {};         ///< frames in which sensor 1 tells the frame before
    std::set<int> unplugged = {};      ///< frames in which sensor 1 is disabled
    int port_occupied_from = -1;       ///< BX from which the system status says so
    bool refuses_fast_line = false;    ///< ERROR06 to COMM
    bool tracks_already = false;       ///< as whoever was here before left it
    bool needs_break = false;          ///< deaf to everything
    int handles = 2;
    bool wrong_init_checksum = false;  ///< of the first reply
  };

  /// `link`: a symbolic link to the terminal is made there.
  AuroraSimulator(std::filesystem::path link, Script script);
  ~AuroraSimulator();
  AuroraSimulator(const AuroraSimulator&) = delete;
  AuroraSimulator& operator=(const AuroraSimulator&) = delete;

  int questions() const { return questions_.load(); }
  std::vector<std::string> commands() const;  ///< all but BX, with their parameters

 private:
  void run();
  void take(const std::string& line);
  std::string reply_to(const std::string& name, const std::string& parameters);
  std::string port_list(const std::string& which) const;
  void answer_bx();
  void send(const std::string& bytes);
  void send_text(const std::string& text);
  std::string bx(int frame) const;

  std::filesystem::path link_;
  Script script_;
  int master_ = -1, slave_ = -1;
  bool initialised_ = false, tracking_ = false;
  std::array<bool, 2> ready_{}, enabled_{};
  std::atomic<int> questions_{0};
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  std::vector<std::string> commands_;
  std::thread thread_;
};

/// The CRC-16 of NDI by long division, bit by bit.
std::uint16_t long_division(const std::string& bytes);

}  // namespace palpate::test
