// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <palpate/estimation/global_update.hpp>
#include <palpate/sensing/shape_model.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/sensing/virtual_setups.hpp>

/// ShapeModel as the search sees it: blocks, seeds, and what they cost.
namespace palpate {
namespace {

using test::Draws;

static_assert(MeasurementModel<ShapeModel>);
static_assert(BlockModel<ShapeModel>);
static_assert(SeededModel<ShapeModel>);

Measurement exact_measurement(const Catheter& catheter, const Vector3d& force_tip_N) {
  Measurement measurement;
  register_frame(catheter, test::exact_frame(catheter, force_tip_N), measurement);
  return measurement;
}

/// Where each row's block ends, row by row.
std::vector<int> block_ends(const ShapeModel& model) {
  std::vector<int> ends;
  for (int row = 0; row < model.rows(); ++row) ends.push_back(model.block_end(row));
  return ends;
}

std::vector<int> blocks(std::initializer_list<int> sizes) {
  std::vector<int> ends;
  int end = 0;
  for (const int size : sizes) {
    end += size;
    ends.insert(ends.end(), static_cast<std::size_t>(size), end);
  }
  return ends;
}

TEST(SearchModel, ABlockIsASensor) {
  const Catheter catheter = test::mixed_sensors();
  const Measurement measurement = exact_measurement(catheter, {0.0, 0.0, 0.0});
  ShapeModel model(catheter, MeasurementKind::kPoses);
  const std::pair<unsigned, std::vector<int>> expected[] = {
      {0b000, {}},          {0b001, blocks({6})},    {0b010, blocks({5})},    {0b011, blocks({6, 5})},
      {0b100, blocks({3})}, {0b101, blocks({6, 3})}, {0b110, blocks({5, 3})}, {0b111, blocks({6, 5, 3})},
  };
  for (const auto& [mask, ends] : expected) {
    model.select(measurement, mask);
    EXPECT_EQ(block_ends(model), ends) << mask;
  }
}

TEST(SearchModel, CurvatureIsABlockOfItsOwn) {
  const Catheter catheter = test::two_sensors();
  const Measurement measurement = exact_measurement(catheter, {0.0, 0.0, 0.0});
  ShapeModel model(catheter, MeasurementKind::kTipAndCurvature);
  model.select(measurement, 0b11);
  EXPECT_EQ(block_ends(model), blocks({6, 3}));
  model.select(measurement, 0b01);
  EXPECT_EQ(block_ends(model), blocks({6}));
  model.select(measurement, 0b10);
  EXPECT_EQ(block_ends(model), blocks({}));
}

TEST(SearchModel, EvaluationsCountRodsAndCurves) {
  const Catheter catheter = test::two_sensors();
  const Measurement measurement = exact_measurement(catheter, {0.02, 0.03, -0.05});
  ShapeModel model(catheter, MeasurementKind::kPoses);
  model.select(measurement, 0b11);
  Linearization at;
  StateVector x = Vector3d::Zero();
  EXPECT_EQ(model.evaluations(), 0);
  ASSERT_TRUE(model.linearize(x, at));
  ASSERT_TRUE(model.linearize(x, at));
  EXPECT_EQ(model.evaluations(), 2);
  int work = 1000;  // added to, not set
  for (int k = 0; model.seed(k, x, work); ++k) EXPECT_EQ(model.evaluations(), 2 + work - 1000) << k;
  EXPECT_GT(work, 1000 + ForceSeeds::kDirections);
  EXPECT_LE(work, 1000 + ForceSeeds::kDirections + (1 + ForceSeeds::kDirections) * ForceSeeds::kMostEvaluations);
}

/// A search may end anywhere, with a shaft twice as stiff as the file says and bent the other way.
TEST(SearchModel, SeedsDoNotDependOnTheSearchBefore) {
  Catheter catheter = test::two_sensors();
  catheter.stiffness_sigma_fraction = 0.05;
  catheter.precurvature_sigma_per_m = {1.0, 1.0, 1.0};
  const UncertainParameters parameters = uncertain_parameters(catheter, {.consider = true});
  const Measurement measurement = exact_measurement(catheter, {0.02, 0.03, -0.05});
  ShapeModel fresh(catheter, MeasurementKind::kPoses, parameters), used = fresh;
  StateVector here = StateVector::Zero(fresh.states()), there = here, elsewhere = here;
  elsewhere.segment<2>(3).setConstant(std::log(2.0));
  elsewhere(5) = -60.0;
  Linearization at;
  for (ShapeModel* model : {&fresh, &used}) model->select(measurement, 0b11);
  for (int k = 0; k < 3; ++k) {
    int work = 0;
    used.linearize(elsewhere, at);
    ASSERT_TRUE(fresh.seed(k, here, work) && used.seed(k, there, work));
    EXPECT_EQ(here, there) << k;
  }
}

TEST(SearchModel, BeyondTheLastSeedTheStateIsLeftAlone) {
  const Catheter catheter = test::two_sensors();
  const Measurement measurement = exact_measurement(catheter, {0.02, 0.03, -0.05});
  ShapeModel model(catheter, MeasurementKind::kPoses);
  model.select(measurement, 0b11);
  StateVector x = Vector3d(1.0, 2.0, 3.0);
  int work = 0;
  EXPECT_FALSE(model.seed(1 + ForceSeeds::kDirections, x, work));
  EXPECT_EQ(x, StateVector(Vector3d(1.0, 2.0, 3.0)));
  EXPECT_EQ(work, 0);
}

/// Sensors that contradict each other: nothing fits, all seeds are tried until the work is up. Measured: 228 at most.
TEST(SearchModel, SearchThatFindsNothingIsBoundedAndDoesNotAllocate) {
  const Catheter catheter = test::two_sensors();
  ShapeModel model(catheter, MeasurementKind::kPoses);
  const SearchOptions options;
  GlobalUpdate search(options);
  Update update;
  const Gaussian prior{Vector3d::Zero(), 0.09 * StateMatrix::Identity(3, 3)};
  Draws draws(77);
  Measurement measurement = exact_measurement(catheter, Vector3d::Zero());
  int most = 0;
  const test::CountAllocations allocations;
  for (int trial = 0; trial < 200; ++trial) {
    for (int k = 0; k < measurement.count; ++k) measurement.poses[k].T_base_sensor = draws.pose(0.07);
    model.select(measurement, 0b11);
    search.run(model, prior, &prior.mean, update);
    most = std::max(most, update.evaluations);
  }
  EXPECT_EQ(allocations.so_far(), 0U);
  EXPECT_GE(most, options.max_evaluations);
  EXPECT_LT(most, options.max_evaluations + ForceSeeds::kMostEvaluations + 1 + options.local.max_iterations);
  RecordProperty("most_evaluations", most);
}

TEST(SearchModel, NaNInAMeasurementFailsAndThePriorIsHandedBack) {
  const Catheter catheter = test::two_sensors();
  ShapeModel model(catheter, MeasurementKind::kPoses);
  Measurement measurement = exact_measurement(catheter, Vector3d::Zero());
  measurement.poses[1].T_base_sensor.p.z() = std::nan("");
  model.select(measurement, 0b11);
  const Gaussian prior{Vector3d(0.1, 0.0, -0.1), 0.09 * StateMatrix::Identity(3, 3)};
  Update update;
  GlobalUpdate().run(model, prior, &prior.mean, update);
  EXPECT_EQ(update.status, UpdateStatus::kFailed);
  EXPECT_EQ(update.posterior.mean, prior.mean);
}

}  // namespace
}  // namespace palpate
