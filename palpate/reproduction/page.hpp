// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <palpate/reproduction/part.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate::reproduction {

/// The parts that a name stands for: one, or a group ("all", "corrections"). Empty: an unknown name.
std::vector<const PartMaker*> parts_named(const std::string& name);

/// Makes all of them, `workers` at a time; `progress` is called from any thread, never twice at once, with the share
/// done. The first failure is thrown once the running parts have ended.
std::vector<Part> make_parts(std::span<const PartMaker* const> makers, int workers,
                             const std::function<void(double share)>& progress = {});

/// One page: title, contents with links, and every part under a heading of its own.
std::string page_markdown(std::span<const PartMaker* const> makers, std::span<const Part> parts);

}  // namespace palpate::reproduction
