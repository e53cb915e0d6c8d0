// SPDX-License-Identifier: Apache-2.0
#include <palpate/reproduction/parts.hpp>

namespace palpate::reproduction {

const std::vector<PartMaker>& all_parts() {
  static const std::vector<PartMaker> parts{
      {"table2", "the catheter", make_table2},
      {"figure3", "the force of section 4.1", make_figure3},
      {"table3", "errors of EKF, IEKF and IAEKF", make_table3},
      {"figure4", "the errors over time", make_figure4},
      {"figure5", "axial force over the bend of the shaft", make_figure5},
      {"figure6", "convergence indices", make_figure6},
      {"table4", "other measurement noise covariances", make_table4},
      {"table5", "other initial forces", make_table5},
      {"figure7", "force and stiffness together", make_figure7},
      {"table6", "time an update, on this machine", make_table6},
      {"figure9", "applied forces of Experiment I", make_figure9},
      {"figure10", "errors in Experiment I", make_figure10},
      {"table7", "errors in Experiments I and II, as virtual twins", make_table7},
      {"figure12", "applied and estimated forces in Experiment II (a)", make_figure12},
      {"figure14", "force and stiffness in Experiment II (b)", make_figure14},
      {"iterations", "error and time over the number of iterations", make_iterations},
      {"window", "error and time over the window of the adaptation", make_window},
      {"eq8", "correction: Eq. (8) is not the tangent", make_eq8},
      {"euler", "correction: Euler angles are singular inside the paper's range", make_euler},
      {"curvature_channel", "correction: the stated R switches the curvature off", make_curvature_channel},
      {"scale", "correction: force and stiffness together have no scale", make_scale},
      {"divergence", "correction: the undamped iteration diverges", make_divergence},
  };
  return parts;
}

}  // namespace palpate::reproduction
