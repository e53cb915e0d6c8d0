// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/evaluation/contacts.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {

void ContactRule::validate() const {
  const auto check = [](const char* name, double value, bool good, const char* range) {
    if (!good) throw InputError(fmt::format("{} = {}: expected {}", name, value, range));
  };
  check("on_N", on_N, on_N > 0.0 && on_N <= 100.0, "more than 0, at most 100 N");
  check("off_share", off_share, off_share > 0.0 && off_share <= 1.0, "more than 0, at most 1");
  check("bridge_s", bridge_s, bridge_s >= 0.0 && bridge_s <= 10.0, "0 to 10 s");
}

std::string in_words(const ContactRule& rule) {
  const double on_g = rule.on_N * kGramsForcePerNewton;
  return fmt::format(
      "A contact begins with a measured frame whose force is at least {0:.4g} g ({1:.4g} mN) and 1.96 of its own "
      "sigma. "
      "It ends before the first measured frame below {2:.4g} g ({3:.4g} mN) or below its own sigma, or where nothing "
      "was "
      "measured for longer than {4:.4g} s. A single frame is no contact.",
      on_g, rule.on_N * 1e3, on_g * rule.off_share, rule.on_N * rule.off_share * 1e3, rule.bridge_s);
}

namespace {

/// Follows the force frame by frame.
class ContactFinder {
 public:
  explicit ContactFinder(const ContactRule& rule) : rule_(rule) {}

  void add(const ForceSize& frame) {
    if (!frame.measured) {
      neighbour_ = false;
      return;
    }
    const double step_s = frame.time_s - last_.time_s;
    if (!(step_s > 0.0 && step_s <= rule_.bridge_s) || let_go(frame)) close();
    if (contact_.frames > 0)
      extend(frame);
    else if (touches(frame))
      contact_ = Contact{.from_s = frame.time_s,
                         .to_s = frame.time_s,
                         .frames = 1,
                         .largest_N = frame.size_N,
                         .largest_at_s = frame.time_s};
    last_ = frame;
    neighbour_ = true;
  }
  std::vector<Contact> finish() {
    close();
    return std::move(found_);
  }

 private:
  bool touches(const ForceSize& frame) const {
    return frame.size_N >= rule_.on_N && frame.size_N >= 1.96 * frame.sigma_N;
  }
  bool let_go(const ForceSize& frame) const {
    return frame.size_N < rule_.off_share * rule_.on_N || frame.size_N < frame.sigma_N;
  }
  void extend(const ForceSize& frame) {
    const double step_s = frame.time_s - last_.time_s;
    contact_.to_s = frame.time_s;
    ++contact_.frames;
    contact_.integral_Ns += 0.5 * step_s * (last_.size_N + frame.size_N);
    contact_.integral_sigma_Ns += 0.5 * step_s * (last_.sigma_N + frame.sigma_N);
    if (!neighbour_) contact_.bridged_s += step_s;
    if (frame.size_N <= contact_.largest_N) return;
    contact_.largest_N = frame.size_N;
    contact_.largest_at_s = frame.time_s;
  }
  void close() {
    if (contact_.frames > 1) found_.push_back(contact_);
    contact_ = {};
  }

  ContactRule rule_;
  ForceSize last_{.time_s = -std::numeric_limits<double>::infinity()};  ///< measured
  bool neighbour_ = false;                                              ///< it is the frame before
  Contact contact_;                                                     ///< without frames: none
  std::vector<Contact> found_;
};

}  // namespace

std::vector<Contact> find_contacts(std::span<const ForceSize> frames, const ContactRule& rule) {
  rule.validate();
  ContactFinder finder(rule);
  for (const ForceSize& frame : frames) finder.add(frame);
  return finder.finish();
}

TimeInBands time_in_bands(std::span<const ForceSize> frames, std::span<const double> edges_N, double most_s) {
  for (std::size_t i = 0; i < edges_N.size(); ++i)
    if (!(std::isfinite(edges_N[i]) && edges_N[i] > (i == 0 ? 0.0 : edges_N[i - 1])))
      throw InputError(fmt::format("bands: edge {} N: expected positive edges that rise", edges_N[i]));
  TimeInBands bands;
  bands.seconds.assign(edges_N.size() + 1, 0.0);
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    const double step_s = frames[i + 1].time_s - frames[i].time_s;
    if (!(step_s > 0.0)) continue;
    bands.total_s += step_s;
    const double known_s = frames[i].measured ? std::min(step_s, most_s) : 0.0;
    const auto band = std::upper_bound(edges_N.begin(), edges_N.end(), frames[i].size_N) - edges_N.begin();
    bands.seconds[static_cast<std::size_t>(band)] += known_s;
    bands.not_measured_s += step_s - known_s;
  }
  return bands;
}

}  // namespace palpate
