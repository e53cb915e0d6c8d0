// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/output_file.hpp>
#include <palpate/simulation/virtual_run.hpp>

/// What a virtual experiment leaves besides its tracker CSV. Times are those of the events, on a clock that is right.
/// Every function writes into a file that the caller commits.
namespace palpate {

/// The true force of the tissue on the tip: force CSV, row i is frame i.
void write_true_force_csv(OutputFile& file, const VirtualRun& run);

/// Tendon CSV: the measured moment where there is a tendon, knob_rad where there is a knob. sigma_Nm is blank where it
/// is 0, so that a reader takes what the catheter file says.
void write_tendon_csv(OutputFile& file, const VirtualRun& run);
bool has_tendon_trace(const VirtualRun& run);

/// `time_s,EI1_Nm2,EI2_Nm2,GJ_Nm2`: the true stiffness of the first flexible section.
void write_stiffness_csv(OutputFile& file, const VirtualRun& run);

/// `time_s,what`: contacts and instabilities.
void write_events_csv(OutputFile& file, const VirtualRun& run);

}  // namespace palpate
