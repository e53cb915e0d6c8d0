// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <palpate/simulation/flow_force.hpp>

namespace palpate {

FlowForce::FlowForce(const Flow& flow, std::uint64_t seed)
    : flow_(flow), engine_(random_engine(seed, RandomStream::kFlow)) {}

Vector3d FlowForce::next(double step_s) {
  const double a = started_ ? std::exp(-step_s / flow_.memory_s) : 0.0;
  started_ = true;
  const double x = normal_(engine_), y = normal_(engine_), z = normal_(engine_);
  force_N_ = a * force_N_ + flow_.rms_N * std::sqrt(1.0 - a * a) * Vector3d(x, y, z);
  return force_N_;
}

}  // namespace palpate
