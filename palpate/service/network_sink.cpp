// SPDX-License-Identifier: Apache-2.0
#include <palpate/service/network_sink.hpp>

namespace palpate::service {

namespace {

session::LiveRecord prototype() {
  session::LiveRecord record;
  record.frame.readings.resize(kMaxSensors + 1);
  return record;
}

}  // namespace

NetworkSink::NetworkSink(std::size_t records) : ring_(records, prototype()) {}

void NetworkSink::offer(const session::LiveRecord& record) noexcept {
  session::LiveRecord* const slot = ring_.free_slot();
  if (slot == nullptr) return dropped_.add();
  *slot = record;
  ring_.push();
  wakeup_.notify();
}

}  // namespace palpate::service
