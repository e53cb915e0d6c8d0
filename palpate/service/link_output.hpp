// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <palpate/evaluation/shown_shape.hpp>
#include <palpate/service/board.hpp>
#include <string>
#include <vector>

namespace palpate::service {

/// What 3D Slicer hears of one catheter, as bytes of OpenIGTLink (docs/reference/openigtlink.md). A force that is not
/// live goes out as NaN.
class LinkOutput {
 public:
  LinkOutput(const CatheterSettings& settings, const LinkSettings& rates);

  /// The forces of the view's latest record, appended to `out`; and where it is time, the shape.
  void add(const CatheterView& view, std::int64_t now_ns, std::vector<std::byte>& out);
  /// The health, where it is time or the state has changed.
  void add_health(const CatheterView& view, std::int64_t now_ns, std::vector<std::byte>& out);
  /// The catheter was tared or registered anew.
  void set_catheter(const Catheter& catheter);

 private:
  void add_shape(const CatheterView& view, std::vector<std::byte>& out);

  std::string name_;
  std::int64_t shape_every_ns_, health_every_ns_;
  std::int64_t shape_due_ns_ = 0, health_due_ns_ = 0;
  LiveState said_ = LiveState::kWaiting;
  ShownShape shape_;
};

}  // namespace palpate::service
