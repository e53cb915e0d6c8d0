// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <palpate/simulation/loaded_shaft.hpp>

namespace palpate {

namespace {

double least_force_scale_N(const Rod& rod) {
  double EI_Nm2 = 0.0;
  for (const Section& section : rod.sections) {
    const double least = section.stiffness_Nm2.minCoeff();
    if (!section.rigid) EI_Nm2 = EI_Nm2 == 0.0 ? least : std::min(EI_Nm2, least);
  }
  constexpr double kRigid_N = 1.0;  // nothing bends: any scale will do
  return EI_Nm2 == 0.0 ? kRigid_N : EI_Nm2 / (rod.length_m() * rod.length_m());
}

}  // namespace

LoadedShaft::LoadedShaft(const Catheter& catheter, const Load& load)
    : catheter_(catheter), load_(load), force_scale_N_(least_force_scale_N(catheter.rod)) {
  for (const Sensor& sensor : catheter.sensors) arc_lengths_m_.push_back(sensor.arc_length_m);
  arc_lengths_m_.push_back(catheter.rod.length_m());
  solver_.emplace(catheter.rod, arc_lengths_m_, Accuracy::kReference);
  workspace_ = make_weight_workspace<6>(*solver_);
  shape_ = solver_->make_solution<6>();
  directions_.force_tip_N.leftCols<3>().setIdentity();
  directions_.moment_tip_Nm.rightCols<3>().setIdentity();
}

bool LoadedShaft::load_in_tip() const {
  const auto* force = std::get_if<ForceLoad>(&load_);
  return force != nullptr && !force->in_base;
}

/// Gravity stays where it is when the clamp is twisted; the solver knows it in the base frame.
void LoadedShaft::turn_weight(double twist_rad) {
  if (!catheter_.rod.has_distributed_load() || twist_rad == solver_twist_rad_) return;
  Rod rod = catheter_.rod;
  rod.distributed_load_base_N_per_m = exp_so3({0.0, 0.0, -twist_rad}) * rod.distributed_load_base_N_per_m;
  solver_.emplace(std::move(rod), arc_lengths_m_, Accuracy::kReference);
  solver_twist_rad_ = twist_rad;
}

bool LoadedShaft::balance(const Situation& situation, const Anchor& anchor, const Vector3d& force_tip_N, Balance& out) {
  turn_weight(situation.twist_rad);
  TipLoad load = situation.shaft;
  load.force_tip_N = force_tip_N;
  if (!solve_under_weight(*solver_, load, directions_, workspace_, shape_).converged) return false;

  const Pose T_room_base = situation.T_room_base();
  const Vector3d& c = catheter_.rod.contact_offset_m;
  const Matrix3d hat_c = hat(c);
  out.force_tip_N = force_tip_N;
  out.T_room_tip = T_room_base * shape_.T_base_tip;
  out.place_room_m = out.T_room_tip * c;
  const Matrix3d& R = out.T_room_tip.R;
  out.turn_by_force_per_N = shape_.tip_rotation.leftCols<3>();
  out.place_by_force_m_per_N =
      T_room_base.R * shape_.tangents.back().position_m.leftCols<3>() - R * hat_c * out.turn_by_force_per_N;

  const Place place{.place_room_m = out.place_room_m,
                    .borne_room_N = R * (force_tip_N - situation.load_share * situation.flow_tip_N),
                    .compliance_m_per_N = compliance_m_per_N()};
  out.contact = contact_force(load_, situation, anchor, place);
  out.contact.force_room_N *= situation.load_share;
  out.contact.by_place_N_per_m *= situation.load_share;
  if (load_in_tip()) {
    out.contact_tip_N = out.contact.force_room_N;
    out.contact.force_room_N = R * out.contact_tip_N;
    out.excess_N = force_tip_N - situation.load_share * situation.flow_tip_N - out.contact_tip_N;
    out.excess_by_force.setIdentity();
    out.stable = true;
    return out.place_room_m.allFinite();
  }
  out.contact_tip_N = R.transpose() * out.contact.force_room_N;
  out.excess_N = force_tip_N - situation.load_share * situation.flow_tip_N - out.contact_tip_N;
  const Matrix3d load_by_turn = hat(out.contact_tip_N), load_by_place = R.transpose() * out.contact.by_place_N_per_m;
  out.excess_by_force =
      Matrix3d::Identity() - load_by_turn * out.turn_by_force_per_N - load_by_place * out.place_by_force_m_per_N;
  const Matrix3d place_by_moment =
      T_room_base.R * shape_.tangents.back().position_m.rightCols<3>() - R * hat_c * shape_.tip_rotation.rightCols<3>();
  out.stable = is_stable(out, load_by_turn, load_by_place * place_by_moment);
  return out.excess_N.allFinite();
}

/// C = d(tip rotation)/d(tip moment) while the load answers: Phi_M + Phi dF/dM with dg = 0. It is a block of the
/// inverse of the energy's Hessian and so positive definite where that is; where the Hessian loses this, an eigenvalue
/// of C goes through infinity to the negative side. One that is as good as infinite is neutral: a shaft without a
/// preferred plane turns freely about its axis once it has buckled.
bool LoadedShaft::is_stable(const Balance& at, const Matrix3d& load_by_turn, const Matrix3d& load_by_moment) const {
  constexpr double kNeutral = 1e-6;  // of EI / L
  const Matrix3d turn_by_moment = shape_.tip_rotation.rightCols<3>();
  const Matrix3d C = turn_by_moment + at.turn_by_force_per_N * at.excess_by_force.partialPivLu().solve(
                                                                   load_by_turn * turn_by_moment + load_by_moment);
  if (!C.allFinite()) return true;
  const Vector3d compliance = Eigen::EigenSolver<Matrix3d>(C, false).eigenvalues().real();
  const double neutral_per_Nm = 1.0 / (kNeutral * force_scale_N_ * length_m());
  return !((compliance.array() < 0.0) && (compliance.array() > -neutral_per_Nm)).any();
}

}  // namespace palpate
