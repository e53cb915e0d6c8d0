// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// What the rod's kernels are compiled for; all else is built for the oldest processor. Results agree between sets to
/// rounding (1e-12 of the length), and are the same bits within one.
enum class InstructionSet {
  kBaseline,  ///< that of the whole program; on x86-64 SSE2 or SSE4.2, two numbers at a time
  kAvx2,      ///< x86-64-v3: AVX2 and FMA, four numbers at a time
  kAvx512,    ///< x86-64-v4, up to eight numbers at a time
};

inline constexpr InstructionSet kInstructionSets[] = {InstructionSet::kBaseline, InstructionSet::kAvx2,
                                                      InstructionSet::kAvx512};

const char* name(InstructionSet set);

/// Whether this program holds the kernel and this processor and its system run it.
bool available(InstructionSet set);

/// The last of kInstructionSets that is available.
InstructionSet widest_instruction_set();

/// The one that the environment's PALPATE_INSTRUCTION_SET names, read once; else the widest. For the same bits on
/// different machines. Throws InputError on a name that is none, and on a set that is not available.
InstructionSet preferred_instruction_set();

}  // namespace palpate
