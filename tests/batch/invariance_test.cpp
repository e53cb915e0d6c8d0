// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <palpate/math/errors.hpp>

#include "tests/batch/batch_cases.hpp"

/// What must not change a result: order, neighbours, tails, workers. Bit for bit, within one instruction set.
namespace palpate {
namespace {

class BatchInvariance : public testing::TestWithParam<InstructionSet> {
 protected:
  BatchOptions options(int workers = 1) const {
    return {.force_sensitivities = true, .workers = workers, .instructions = GetParam()};
  }
  RodSolver solver{test::rod_of_sections(), test::kPlaces_m};
};

INSTANTIATE_TEST_SUITE_P(Sets, BatchInvariance, testing::ValuesIn(test::sets_here()),
                         [](const auto& set) { return std::string(name(set.param)); });

TEST_P(BatchInvariance, EveryTailGivesTheSameBits) {
  const test::ManyLoads loads = test::random_loads(1030, 11);
  const Eigen::MatrixXd all = test::solved(solver, loads.arrays(), options());
  for (const int rods : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 511, 512, 513, 1024, 1025}) {
    const Eigen::MatrixXd some = test::solved(solver, loads.arrays(0, rods), options());
    ASSERT_TRUE(some == all.leftCols(rods)) << rods << " rods";
    const Eigen::MatrixXd last = test::solved(solver, loads.arrays(1030 - rods, rods), options());
    ASSERT_TRUE(last == all.rightCols(rods)) << "last " << rods << " rods";
  }
}

TEST_P(BatchInvariance, OrderOnlyPermutesTheResult) {
  const test::ManyLoads loads = test::random_loads(700, 12);
  const Eigen::MatrixXd all = test::solved(solver, loads.arrays(), options());
  std::vector<int> order(700);
  std::iota(order.begin(), order.end(), 0);
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
    test::ManyLoads mixed = loads;
    const auto permute = [&](const std::vector<Vector3d>& from, std::vector<Vector3d>& to) {
      for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i]];
    };
    permute(loads.force, mixed.force), permute(loads.moment, mixed.moment), permute(loads.couple, mixed.couple);
    permute(loads.log_stiffness, mixed.log_stiffness), permute(loads.precurvature, mixed.precurvature);
    ASSERT_TRUE(test::solved(solver, mixed.arrays(), options()) == all(Eigen::all, order));
  }
}

TEST_P(BatchInvariance, WorkersChangeNothing) {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  const test::ManyLoads loads = test::random_loads(5000, 13);
  const Eigen::MatrixXd alone = test::solved(solver, loads.arrays(), options());
  for (const int workers : {0, 2, 3, 4})
    ASSERT_TRUE(test::solved(solver, loads.arrays(), options(workers)) == alone) << workers << " workers";
}

TEST_P(BatchInvariance, DistributedLoadOfOthersChangesNothing) {
  test::ManyLoads loads = test::random_loads(9, 14, 0.5);
  const Eigen::MatrixXd all = test::solved(solver, loads.arrays(), options());
  std::fill(loads.distributed.begin() + 1, loads.distributed.end(), Vector3d::Zero());
  ASSERT_TRUE(test::solved(solver, loads.arrays(), options()).col(0) == all.col(0));
}

TEST_P(BatchInvariance, ALoadThatIsNotFiniteSpoilsItsOwnRodOnly) {
  test::ManyLoads loads = test::random_loads(20, 15);
  const Eigen::MatrixXd whole = test::solved(solver, loads.arrays(), options());
  loads.force[3].x() = std::numeric_limits<double>::quiet_NaN();
  loads.force[11].y() = std::numeric_limits<double>::infinity();
  BatchSolution solution;
  solve_batch(solver, loads.arrays(), options(), solution);
  const Eigen::MatrixXd spoilt = test::numbers(solution);
  for (int i = 0; i < 20; ++i) {
    const bool own = i == 3 || i == 11;
    EXPECT_EQ(solution.tip.p_base_local_m.col(i).allFinite(), !own) << i;
    EXPECT_EQ(spoilt.col(i) == whole.col(i), !own) << i;
  }
}

/// The sets round differently: fused or not.
TEST_P(BatchInvariance, SetsAgreeToRounding) {
  const test::ManyLoads loads = test::random_loads(500, 16);
  const RodSolver tip_only(test::rod_of_sections(), {});
  const auto solve = [&](InstructionSet set) {
    BatchSolution solution;
    solve_batch(tip_only, loads.arrays(), {.instructions = set}, solution);
    return solution;
  };
  const BatchSolution ours = solve(GetParam()), baseline = solve(InstructionSet::kBaseline);
  const double length_m = tip_only.rod().length_m();
  EXPECT_LT((ours.tip.p_base_local_m - baseline.tip.p_base_local_m).cwiseAbs().maxCoeff(), 1e-12 * length_m);
  EXPECT_LT((ours.tip.R_base_local - baseline.tip.R_base_local).cwiseAbs().maxCoeff(), 1e-12);
}

std::string message(const BatchLoads& loads, const BatchOptions& options) {
  BatchSolution solution;
  try {
    solve_batch(RodSolver(test::paper_catheter(0.0), {}), loads, options, solution);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Batch, WhatDoesNotFitIsRefused) {
  const test::ManyLoads loads = test::random_loads(5, 17);
  BatchLoads uneven = loads.arrays();
  EXPECT_EQ(message(uneven, {}), "");
  uneven.tendon_couple_Nm = uneven.tendon_couple_Nm.first(4);
  EXPECT_EQ(message(uneven, {}), "tendon_couple_Nm: 4 loads, expected 5 as of force_tip_N, or none");
  uneven.force_tip_N = {};
  EXPECT_EQ(message(uneven, {}), "tendon_couple_Nm: 4 loads, expected 5 as of moment_tip_Nm, or none");
  EXPECT_EQ(message(loads.arrays(), {.workers = -1}), "workers -1: expected a positive number, or 0 for one a core");
  if (!available(InstructionSet::kAvx512)) {
    EXPECT_THAT(message(loads.arrays(), {.instructions = InstructionSet::kAvx512}),
                testing::StartsWith("instruction set avx512: this processor lacks it, expected at most "));
  }
}

}  // namespace
}  // namespace palpate
