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

namespace {

// All of a level, not only what its name says: the compiler may use any of it. The checks include the system's saving
// of the wide registers. Clang knows no levels before version 17; what its list lacks comes with AVX2 on every
// processor.
#if defined(__x86_64__) && defined(__clang__)
bool has_v3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
bool has_v4() {
  return has_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}
#elif defined(__x86_64__)
bool has_v3() { return __builtin_cpu_supports("x86-64-v3"); }
bool has_v4() { return __builtin_cpu_supports("x86-64-v4"); }
#else
bool has_v3() { return false; }
bool has_v4() { return false; }
#endif

}  // namespace

bool available(InstructionSet set) {
  return set == InstructionSet::kBaseline || (set == InstructionSet::kAvx2 && has_v3()) ||
         (set == InstructionSet::kAvx512 && has_v4());
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
