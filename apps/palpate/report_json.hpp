// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "report_run.hpp"

/// The parts of the page's data. Arrays of one length stand for one entry a row; numbers that are none are null.
namespace palpate::app {

/// `value` with so many significant digits, so that JSON says it shortly; null where it is not finite.
nlohmann::json rounded(double value, int digits);

/// Rows of the curves, thinned by least and greatest so that no peak of size, axial, lateral force, components and
/// truth is lost; stretches that were not measured, whole.
nlohmann::json curves_json(const ReportRun& run);

/// The shape at some hundreds of moments, the peaks among them: shaft, sensors, tip frame, force and ellipsoid, in the
/// base frame.
nlohmann::json shapes_json(const ReportRun& run);

/// Contacts, time in bands, peak: what the table and bars show.
nlohmann::json figures_json(const ReportRun& run, const ContactRule& rule, const std::vector<double>& edges_g);

/// Status shares, innovation, sensors, words; catheter and settings.
nlohmann::json health_json(const ReportRun& run);
nlohmann::json settings_json(const ReportRun& run);

/// Indices of some rows, rising: all where there are at most `most_whole`, else what `channels` show in `bins`
/// stretches: of each channel at most four rows a stretch. Where one is not finite for a stretch, the ends are kept.
std::vector<std::size_t> telling_rows(std::size_t rows, const std::vector<std::vector<double>>& channels,
                                      std::size_t most_whole, int bins);

}  // namespace palpate::app
