// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <ostream>
#include <tests/estimation/linear_models.hpp>

/// On a linear model every update must be the textbook's.
namespace palpate {
namespace {

using test::Draws;
using test::LinearModel;

/// Random well-conditioned matrices of at most 16 x 48: rounding grows to about 1e-12 of the numbers' size.
constexpr double kRounding = 1e-9;

using UpdateFunction = void (*)(LinearModel&, const Gaussian&, Update&);
struct Named {
  const char* name;
  UpdateFunction update;

  friend void PrintTo(const Named& n, std::ostream* out) { *out << n.name; }
};
const Named kUpdates[] = {
    {"extended", [](LinearModel& m, const Gaussian& p, Update& out) { extended_update(m, p, out); }},
    {"iterated", [](LinearModel& m, const Gaussian& p, Update& out) { iterated_update(m, p, p.mean, {}, out); }},
};

class LinearUpdate : public ::testing::TestWithParam<Named> {};

TEST_P(LinearUpdate, EqualsTheTextbook) {
  Draws draws(31);
  for (int trial = 0; trial < 100; ++trial) {
    const int states = 1 + trial % 6, rows = 1 + trial % 12;
    LinearModel model = test::random_linear_model(states, rows, draws);
    const Gaussian prior = test::random_prior(states, draws);
    const test::Textbook expected = test::textbook_update(model, prior);
    Update update;
    GetParam().update(model, prior, update);
    EXPECT_EQ(update.status, UpdateStatus::kConverged);
    EXPECT_EQ(update.rows, rows);
    EXPECT_LT((update.posterior.mean - expected.mean).norm(), kRounding);
    EXPECT_LT((update.posterior.covariance - expected.covariance).norm(), kRounding);
    EXPECT_NEAR(update.chi_square, expected.nis, kRounding * (1.0 + expected.nis));
    const Eigen::VectorXd r = model.y - model.H * expected.mean;
    const double misfit = r.dot(model.R.inverse() * r);
    EXPECT_NEAR(update.residual_chi_square, misfit, kRounding * (1.0 + misfit));
    EXPECT_LT((update.at.residual - r).norm(), kRounding);
  }
}

TEST_P(LinearUpdate, CovarianceIsSymmetricDefiniteAndTheInverseOfTheSummedInformation) {
  Draws draws(32);
  for (int trial = 0; trial < 50; ++trial) {
    const int states = 1 + trial % 6;
    LinearModel model = test::random_linear_model(states, 9, draws);
    const Gaussian prior = test::random_prior(states, draws);
    Update update;
    GetParam().update(model, prior, update);
    const Eigen::MatrixXd P = update.posterior.covariance;
    const Eigen::MatrixXd information =
        Eigen::MatrixXd(prior.covariance).inverse() + model.H.transpose() * model.R.inverse() * model.H;
    EXPECT_EQ(P, P.transpose());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P).eigenvalues()(0), 0.0);
    EXPECT_LT((P - information.inverse()).norm(), kRounding);
  }
}

/// Sigmas 1e6 and 1e-6 side by side: P - K S K^T would cancel to noise; Joseph's form may not.
TEST_P(LinearUpdate, CovarianceStaysDefiniteOverTwelveOrdersOfMagnitude) {
  LinearModel model{Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(1e-12, 1.0).asDiagonal(), Eigen::Vector2d(1, 1)};
  const Gaussian prior{Eigen::Vector2d::Zero(), Eigen::Vector2d(1e12, 1e-12).asDiagonal()};
  Update update;
  GetParam().update(model, prior, update);
  EXPECT_NEAR(update.posterior.covariance(0, 0) / 1e-12, 1.0, 1e-3);
  EXPECT_NEAR(update.posterior.covariance(1, 1) / 1e-12, 1.0, 1e-3);
}

TEST_P(LinearUpdate, WorksAtFullCapacity) {
  Draws draws(33);
  LinearModel model = test::random_linear_model(kMaxStates, kMaxResiduals, draws);
  const Gaussian prior = test::random_prior(kMaxStates, draws);
  Update update;
  GetParam().update(model, prior, update);
  EXPECT_LT((update.posterior.mean - test::textbook_update(model, prior).mean).norm(), 1e-8);
}

TEST_P(LinearUpdate, IndefiniteNoiseOrPriorFailsAndThePosteriorIsThePrior) {
  Draws draws(34);
  const LinearModel good = test::random_linear_model(2, 3, draws);
  const Gaussian prior = test::random_prior(2, draws);
  LinearModel no_noise = good;
  no_noise.R = -no_noise.R;
  Gaussian lost = prior;
  lost.covariance(0, 0) = -1.0;
  for (auto [model, from] : {std::pair(no_noise, prior), std::pair(good, lost)}) {
    Update update;
    GetParam().update(model, from, update);
    EXPECT_EQ(update.status, UpdateStatus::kFailed);
    EXPECT_EQ(update.posterior.mean, from.mean);
    EXPECT_EQ(update.posterior.covariance, from.covariance);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, LinearUpdate, ::testing::ValuesIn(kUpdates),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(IteratedUpdate, StartDoesNotMatterOnALinearModel) {
  Draws draws(35);
  LinearModel model = test::random_linear_model(3, 6, draws);
  const Gaussian prior = test::random_prior(3, draws);
  const test::Textbook expected = test::textbook_update(model, prior);
  for (int i = 0; i < 20; ++i) {
    const StateVector start = prior.mean + 10.0 * draws.normal3();
    Update update;
    iterated_update(model, prior, start, {}, update);
    EXPECT_EQ(update.status, UpdateStatus::kConverged);
    EXPECT_LT((update.posterior.mean - expected.mean).norm(), kRounding);
    EXPECT_NEAR(update.chi_square, expected.nis, 1e-6 * (1.0 + expected.nis));
  }
}

TEST(IteratedUpdate, OneEvaluationWhereThePredictionIsRight) {
  Draws draws(36);
  LinearModel model = test::random_linear_model(3, 6, draws);
  const Gaussian prior = test::random_prior(3, draws);
  model.y = model.H * prior.mean;
  Update update;
  iterated_update(model, prior, prior.mean, {}, update);
  EXPECT_EQ(update.evaluations, 1);
  EXPECT_EQ(update.status, UpdateStatus::kConverged);
}

}  // namespace
}  // namespace palpate
