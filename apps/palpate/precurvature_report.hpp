// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <palpate/identification/precurvature.hpp>
#include <palpate/identification/tendon_map.hpp>
#include <string>

/// What `palpate identify precurvature` says of its fits, for a person, a program, and as pictures.
namespace palpate::app {

std::string in_words(const ArcFit& fit);
nlohmann::json to_json(const ArcFit& fit);
/// The points on the arc in its bending plane, and what is left.
void plot_arc(const Catheter& catheter, const ArcFit& fit, const std::string& path);

std::string in_words(const TendonMapFit& fit);
nlohmann::json to_json(const TendonMapFit& fit, std::span<const HandleSample> samples);
/// Both branches with their 95 % bands and the samples, and what is left.
void plot_map(const TendonMapFit& fit, std::span<const HandleSample> samples, const std::string& title,
              const std::string& path);

}  // namespace palpate::app
