// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdlib>
#include <palpate/math/errors.hpp>
#include <palpate/rod/instruction_set.hpp>
#include <string_view>

namespace palpate {

namespace {

InstructionSet named_in_environment() {
  const char* wanted = std::getenv("PALPATE_INSTRUCTION_SET");
  if (wanted == nullptr) return widest_instruction_set();
  for (const InstructionSet set : kInstructionSets) {
    if (std::string_view(wanted) != name(set)) continue;
    if (available(set)) return set;
    throw InputError(fmt::format("PALPATE_INSTRUCTION_SET: this processor has no {}; its widest is {}", wanted,
                                 name(widest_instruction_set())));
  }
  throw InputError(fmt::format("PALPATE_INSTRUCTION_SET: '{}': expected baseline, avx2 or avx512", wanted));
}

}  // namespace

const char* name(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
    default:
      return "baseline";
  }
}

bool available(InstructionSet set) {
  if (set == InstructionSet::kBaseline) return true;
#if defined(__x86_64__)
  // All of a level: the compiler may use any of it. The check includes the system's saving of the wide registers.
  if (set == InstructionSet::kAvx2) return __builtin_cpu_supports("x86-64-v3");
  if (set == InstructionSet::kAvx512) return __builtin_cpu_supports("x86-64-v4");
#endif
  return false;
}

InstructionSet widest_instruction_set() {
  InstructionSet widest = InstructionSet::kBaseline;
  for (const InstructionSet set : kInstructionSets)
    if (available(set)) widest = set;
  return widest;
}

InstructionSet preferred_instruction_set() {
  static const InstructionSet preferred = named_in_environment();
  return preferred;
}

}  // namespace palpate
