// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/evaluation/contact_finder.hpp>
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

std::vector<Contact> find_contacts(std::span<const ForceSize> frames, const ContactRule& rule) {
  ContactFinder finder(rule);
  std::vector<Contact> found;
  const auto keep = [&](const std::optional<Contact>& ended) {
    if (ended) found.push_back(*ended);
  };
  for (const ForceSize& frame : frames) keep(finder.add(frame));
  keep(finder.finish());
  return found;
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
