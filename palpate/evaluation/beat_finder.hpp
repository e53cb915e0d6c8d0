// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace palpate {

/// The heart's rhythm in a force: autocorrelation of |F| over the latest kWindow_s, slow motion (breathing) taken out
/// by a running mean of kSlow_s. Needs some twenty forces a second. Constant memory, nothing is allocated.
class BeatFinder {
 public:
  static constexpr double kStep_s = 0.04, kWindow_s = 10.0, kSlow_s = 1.5;
  static constexpr double kLeast_per_min = 40.0, kMost_per_min = 200.0;
  static constexpr double kLeastStrength = 0.5;  ///< below, what repeats is not told from what happens to

  struct Beat {
    double per_min = 0.0;
    double strength = 0.0;  ///< autocorrelation one beat apart; 1: each beat as the one before
  };

  /// A measured force; times [s] rise. A gap stays one.
  void add(double time_s, double size_N);
  /// Forgets all.
  void clear() { *this = {}; }

  /// None where nothing repeats, or too little of the window was measured. Cost: some ten thousand multiplications.
  std::optional<Beat> find() const;

 private:
  static constexpr int kBins = 250;  // kWindow_s
  struct Bin {
    double sum = 0.0;
    int count = 0;
  };
  std::array<Bin, kBins> bins_{};
  std::int64_t newest_ = -1;  ///< number of the newest bin since time 0; it is not full yet
};

}  // namespace palpate
