// SPDX-License-Identifier: Apache-2.0
#include <palpate/evaluation/contact_finder.hpp>

namespace palpate {

ContactFinder::ContactFinder(const ContactRule& rule) : rule_(rule) { rule.validate(); }

std::optional<Contact> ContactFinder::add(const ForceSize& frame) {
  const double step_s = frame.time_s - last_.time_s;
  if (!frame.measured) {
    neighbour_ = false;
    return step_s > rule_.bridge_s ? close() : std::nullopt;
  }
  std::optional<Contact> ended;
  if (!(step_s > 0.0 && step_s <= rule_.bridge_s) || let_go(frame)) ended = close();
  if (contact_.frames > 0)
    extend(frame);
  else if (touches(frame))
    contact_ = Contact{.from_s = frame.time_s,
                       .to_s = frame.time_s,
                       .frames = 1,
                       .largest_N = frame.size_N,
                       .largest_at_s = frame.time_s};
  last_ = frame;
  neighbour_ = true;
  return ended;
}

bool ContactFinder::touches(const ForceSize& frame) const {
  return frame.size_N >= rule_.on_N && frame.size_N >= 1.96 * frame.sigma_N;
}

bool ContactFinder::let_go(const ForceSize& frame) const {
  return frame.size_N < rule_.off_share * rule_.on_N || frame.size_N < frame.sigma_N;
}

void ContactFinder::extend(const ForceSize& frame) {
  const double step_s = frame.time_s - last_.time_s;
  contact_.to_s = frame.time_s;
  ++contact_.frames;
  contact_.integral_Ns += 0.5 * step_s * (last_.size_N + frame.size_N);
  contact_.integral_sigma_Ns += 0.5 * step_s * (last_.sigma_N + frame.sigma_N);
  if (!neighbour_) contact_.bridged_s += step_s;
  if (frame.size_N <= contact_.largest_N) return;
  contact_.largest_N = frame.size_N;
  contact_.largest_at_s = frame.time_s;
}

std::optional<Contact> ContactFinder::close() {
  const Contact ended = contact_;
  contact_ = {};
  return ended.frames > 1 ? std::optional(ended) : std::nullopt;
}

void ForceIntegral::add(const ForceSize& frame) {
  const double passed_s = frame.time_s - time_s_;  // NaN before the first frame
  time_s_ = frame.time_s;
  if (passed_s > 0.0) open_s_ += passed_s;
  if (frame.measured) {
    const bool bridged = last_ && passed_s > 0.0 && open_s_ <= bridge_s_;
    if (bridged) {
      integral_Ns += 0.5 * open_s_ * (last_->size_N + frame.size_N);
      sigma_Ns += 0.5 * open_s_ * (last_->sigma_N + frame.sigma_N);
    }
    (bridged ? measured_s : unmeasured_s) += open_s_;
    open_s_ = 0.0;
    last_ = frame;
  } else if (!last_ || open_s_ > bridge_s_) {
    unmeasured_s += open_s_;
    open_s_ = 0.0;
    last_.reset();
  }
}

}  // namespace palpate
