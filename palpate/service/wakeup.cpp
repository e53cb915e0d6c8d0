// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <palpate/service/wakeup.hpp>
#include <system_error>

namespace palpate::service {

Wakeup::Wakeup() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Wakeup::~Wakeup() { close(descriptor_); }

void Wakeup::notify() noexcept {
  const std::uint64_t one = 1;
  // Full (2^64 - 2 notifications unread) is notified enough.
  [[maybe_unused]] const ssize_t written = write(descriptor_, &one, sizeof one);
}

void Wakeup::wait(std::int64_t longest_ns) noexcept {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t wait_ns = std::max<std::int64_t>(longest_ns, 0);
  const timespec longest{wait_ns / kSecond_ns, wait_ns % kSecond_ns};
  pollfd wanted{descriptor_, POLLIN, 0};
  if (ppoll(&wanted, 1, &longest, nullptr) > 0) clear();
}

void Wakeup::clear() noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t taken = read(descriptor_, &count, sizeof count);
}

}  // namespace palpate::service
