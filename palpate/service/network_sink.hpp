// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/service/counters.hpp>
#include <palpate/service/record_sink.hpp>
#include <palpate/service/wakeup.hpp>
#include <palpate/session/ring.hpp>

namespace palpate::service {

/// From the observer's thread to the one that serves the network.
class NetworkSink final : public RecordSink {
 public:
  explicit NetworkSink(std::size_t records = 4096);

  void offer(const session::LiveRecord& record) noexcept override;

  /// On the taking thread.
  const session::LiveRecord* front() { return ring_.front(); }
  void pop() { ring_.pop(); }
  Wakeup& wakeup() { return wakeup_; }
  std::uint64_t dropped() const { return dropped_.get(); }

 private:
  session::Ring<session::LiveRecord> ring_;
  Wakeup wakeup_;
  Counter dropped_;
};

}  // namespace palpate::service
