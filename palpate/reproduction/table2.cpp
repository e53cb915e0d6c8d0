// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/reproduction/paper_catheter.hpp>
#include <palpate/reproduction/parts.hpp>

namespace palpate::reproduction {

Part make_table2(const Settings&) {
  Part part{.title = "Table 2: the catheter"};
  part.markdown = fmt::format(
      "| distal shaft | value |\n|---|---|\n"
      "| length | {:g} mm |\n"
      "| diameter | 7 F ({:g} mm) |\n"
      "| bending stiffness EI1, EI2 | {:.4f}e-3, {:.5f}e-3 N m^2 |\n"
      "| torsional stiffness GJ | {:.4f}e-3 N m^2 |\n\n"
      "Shipped as `examples/paper_catheter.toml`. The file adds what the paper says elsewhere: two 6-DOF sensors, at "
      "the "
      "flexible end and {:g} mm behind it (section 5.1), and k1,0 = {:g} 1/m, that of Experiment I (b). The paper's "
      "simulations name no k1,0; this one is taken for all of them. GJ is within {:.2g} % of "
      "(EI1 + EI2) / (2 (1 + nu)) with nu = {:g} (section 5).\n",
      1e3 * kLength_m, 1e3 * kDiameter_m, 1e3 * kEI1_Nm2, 1e3 * kEI2_Nm2, 1e3 * kGJ_Nm2, 1e3 * kSensorDistance_m,
      kPrecurvature1_per_m,
      100.0 * std::abs(torsional_stiffness_Nm2(kEI1_Nm2, kEI2_Nm2, kPoissonRatio) / kGJ_Nm2 - 1.0), kPoissonRatio);
  return part;
}

}  // namespace palpate::reproduction
