// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace palpate::ndi {

/// What came is no reply of the protocol: a wrong checksum, a length that lies. The line itself may be sound: ask
/// again.
class MalformedReply : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The connection is of no use any more, and why: port gone, device silent, a command refused. Connect anew.
class LinkLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace palpate::ndi
