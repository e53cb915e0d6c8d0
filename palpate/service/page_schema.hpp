// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <palpate/sensing/catheter.hpp>
#include <string_view>

/// What the dashboard's page hears of one catheter, described once: the page reads this table when it connects.
/// docs/reference/dashboard.md tells it to people.
namespace palpate::service {

struct PageField {
  std::string_view name;
  std::size_t count;  ///< numbers
  std::string_view unit, about;
};

inline constexpr std::size_t kPagePoints = 25;  ///< along the shaft

/// One estimate: float64, little-endian, in this order. What is not known or must not be shown is NaN.
inline constexpr std::array kPageRow{
    PageField{"time_s", 1, "s", "of the frame, since 1970"},
    PageField{"received_ms", 1, "ms",
              "host's clock when the frame came, less what it was late by as far as that shows, since 1970"},
    PageField{"sent_ms", 1, "ms", "host's clock when this row was made"},
    PageField{"state", 1, "", "0 WAITING, 1 LIVE, 2 DEGRADED, 3 STALE"},
    PageField{"status", 1, "", "of the estimate: index into the greeting's statuses"},
    PageField{"shown", 1, "",
              "1: the force is that of now and may be shown; 0: force and all that follows from it are NaN"},
    PageField{"stale_after_s", 1, "s", "a row that is older shows nothing"},
    PageField{"size_N", 1, "N", "|F|"},
    PageField{"sigma_size_N", 1, "N", ""},
    PageField{"axial_N", 1, "N", "along d3 of the tip; pressing is negative"},
    PageField{"sigma_axial_N", 1, "N", ""},
    PageField{"lateral_N", 1, "N", "across the tip"},
    PageField{"sigma_lateral_N", 1, "N", ""},
    PageField{"angle_rad", 1, "rad",
              "between the push of the tissue and the tip's axis: 0 head-on, pi/2 from the side"},
    PageField{"sigma_angle_rad", 1, "rad", ""},
    PageField{"force_tip_N", 3, "N", "axes d1, d2, d3"},
    PageField{"sigma_tip_N", 3, "N", ""},
    PageField{"force_base_N", 3, "N", "the same force in the clamp's frame"},
    PageField{"ellipsoid_base_N", 9, "N", "semi-axes of the 95 % region, one after the other, clamp's frame"},
    PageField{"axial_hidden", 1, "", "1: the shape says little about the axial force"},
    PageField{"lateral_hidden", 1, "", "1: nor about the lateral one"},
    PageField{"stiffness_on_prior", 1, "", "1: the stiffness's scale rests on its prior"},
    PageField{"contact", 1, "", "1: the tip touches, by the rule of the greeting"},
    PageField{"contact_s", 1, "s", "for how long; NaN without contact"},
    PageField{"contact_integral_Ns", 1, "N s", "of |F| since this contact began, or of the latest one"},
    PageField{"contact_integral_sigma_Ns", 1, "N s", "as if one error lasted throughout"},
    PageField{"contact_largest_N", 1, "N", "largest |F| of this contact, or of the latest one"},
    PageField{"integral_Ns", 1, "N s", "of |F| since the start, over what was measured"},
    PageField{"integral_sigma_Ns", 1, "N s", "likewise"},
    PageField{"measured_s", 1, "s", "time over which that was taken"},
    PageField{"unmeasured_s", 1, "s", "time since the start in which nothing was measured"},
    PageField{"beats_per_min", 1, "1/min", "rhythm of |F| in the latest ten seconds; NaN where there is none"},
    PageField{"beat_strength", 1, "", "its autocorrelation at one beat, 0 to 1"},
    PageField{"stiffness_Nm2", 3, "N m^2", "EI1, EI2, GJ"},
    PageField{"sigma_stiffness_Nm2", 3, "N m^2", ""},
    PageField{"nis", 1, "", "normalised innovation squared"},
    PageField{"dof", 1, "", "its degrees of freedom"},
    PageField{"R_base_tip", 9, "", "tip frame: d1, d2, d3, clamp's frame"},
    PageField{"contact_mm", 3, "mm", "where the force acts, clamp's frame"},
    PageField{"shaft_mm", 3 * kPagePoints, "mm", "points from the clamp to the end, clamp's frame"},
    PageField{"sensors_mm", 3 * kMaxSensors, "mm", "where the model has the sensors; those that there are"},
    PageField{"seen_mm", 3 * kMaxSensors, "mm", "where the tracker saw them; NaN: not, or not used"},
    PageField{"truth_tip_N", 3, "N", "the true force, where a simulation is played"},
    PageField{"truth_size_N", 1, "N", "its size"},
    PageField{"wall_mm", 3, "mm", "a point of the simulated wall; NaN where there is none"},
};

/// The fields of which a page that connects gets the past: the largest |F| of each kPageHistoryStep_s.
inline constexpr std::array<std::string_view, 12> kPageHistory{
    "time_s",        "state",     "status",          "size_N",  "sigma_size_N", "axial_N",
    "sigma_axial_N", "lateral_N", "sigma_lateral_N", "contact", "integral_Ns",  "truth_size_N"};
inline constexpr double kPageHistoryStep_s = 0.1, kPageHistory_s = 600.0;

/// First number of a message: what follows it. The second is the catheter's index.
enum class PageMessage : int {
  kRow = 1,      ///< one row
  kHistory = 2,  ///< the number of rows, then the rows: kPageHistory each
};

constexpr std::size_t page_row_size() {
  std::size_t size = 0;
  for (const PageField& field : kPageRow) size += field.count;
  return size;
}

/// Where a field begins; does not compile for a name that there is not.
consteval std::size_t page_place(std::string_view name) {
  std::size_t at = 0;
  for (const PageField& field : kPageRow) {
    if (field.name == name) return at;
    at += field.count;
  }
  throw "no such field";
}

using PageRow = std::array<double, page_row_size()>;

}  // namespace palpate::service
