// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::rod_lanes {

struct MarchPiece;
struct MarchField;
struct MarchState;
struct MarchRecord;

/// Takes `state` over one piece; `columns` = N + 1. Records: nullptr, or written for the piece's beginning and end.
using MarchKernel = void(const MarchPiece& piece, bool full, int columns, const MarchField& field, MarchState& state,
                         MarchRecord* before, MarchRecord* after);

}  // namespace palpate::rod_lanes
