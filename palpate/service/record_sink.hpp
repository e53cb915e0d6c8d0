// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/session/live_record.hpp>

namespace palpate::service {

/// Where records go: recording, network. The observer's thread never waits for one.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  /// Takes a copy, or drops the record and counts it. Neither blocks nor allocates in the long run.
  virtual void offer(const session::LiveRecord& record) noexcept = 0;
};

}  // namespace palpate::service
