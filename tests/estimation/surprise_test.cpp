// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <palpate/estimation/unscented.hpp>
#include <tests/estimation/linear_models.hpp>

/// Update::surprise against its definition, by plain inverses on linear models.
namespace palpate {
namespace {

using test::Draws;
using test::LinearModel;

struct Filter {
  const char* name;
  std::function<void(LinearModel&, const Gaussian&, Update&)> update;

  friend void PrintTo(const Filter& f, std::ostream* out) { *out << f.name; }
};

/// `from`: any start, for a linear model's optimum is one step away.
void iterated_from(double offset, LinearModel& model, const Gaussian& prior, Update& out) {
  const StateVector start = prior.mean.array() + offset;
  iterated_update(model, prior, start, {}, out);
}

const Filter kFilters[] = {
    {"iterated", [](auto& model, const auto& prior, auto& out) { iterated_from(0.0, model, prior, out); }},
    {"iterated_from_elsewhere",
     [](auto& model, const auto& prior, auto& out) { iterated_from(3.0, model, prior, out); }},
    {"extended", [](auto& model, const auto& prior, auto& out) { extended_update(model, prior, out); }},
    {"unscented", [](auto& model, const auto& prior, auto& out) { unscented_update(model, prior, out); }},
};

class Surprise : public ::testing::TestWithParam<Filter> {
 protected:
  double of(LinearModel& model, const Gaussian& prior) const {
    Update update;
    GetParam().update(model, prior, update);
    EXPECT_EQ(update.status, UpdateStatus::kConverged);
    return update.surprise;
  }
};

/// (x_data - x_prior)^T (P_data + P_prior)^-1 (x_data - x_prior), of the combinations V^T x alone that the data see.
double by_definition(const LinearModel& model, const Gaussian& prior, const Eigen::MatrixXd& V) {
  const Eigen::MatrixXd HV = model.H * V, weight = model.R.inverse();
  const Eigen::MatrixXd P_data = (HV.transpose() * weight * HV).inverse();
  const Eigen::VectorXd x_data = P_data * HV.transpose() * weight * model.y;
  const Eigen::VectorXd d = x_data - V.transpose() * prior.mean;
  return d.dot((P_data + V.transpose() * prior.covariance * V).inverse() * d);
}

/// The floor of 1e-9 under the data's information takes off a share of 1e-9 / least eigenvalue; random matrices of
/// twice as many rows as states keep that above 1e-4.
TEST_P(Surprise, IsItsDefinition) {
  Draws draws(91);
  for (int trial = 0; trial < 100; ++trial) {
    const int states = 1 + trial % 6;
    LinearModel model = test::random_linear_model(states, 2 * states + trial % 5, draws);
    const Gaussian prior = test::random_prior(states, draws);
    const double expected = by_definition(model, prior, Eigen::MatrixXd::Identity(states, states));
    EXPECT_NEAR(of(model, prior), expected, 1e-5 * (1.0 + expected)) << trial;
  }
}

/// The data see `seen` of the states' combinations; the others have no say.
TEST_P(Surprise, LeavesOutWhatTheDataDoNotSee) {
  Draws draws(92);
  for (int trial = 0; trial < 100; ++trial) {
    const int states = 2 + trial % 5, seen = 1 + trial % (states - 1), rows = 2 * seen + 1;
    LinearModel model = test::random_linear_model(states, rows, draws);
    const Eigen::MatrixXd A = test::random_matrix(states, states, draws);
    const Eigen::MatrixXd V = Eigen::MatrixXd(A.householderQr().householderQ()).leftCols(seen);
    model.H = test::random_matrix(rows, seen, draws) * V.transpose();
    const Gaussian prior = test::random_prior(states, draws);
    const double expected = by_definition(model, prior, V);
    EXPECT_NEAR(of(model, prior), expected, 1e-5 * (1.0 + expected)) << trial;
  }
}

/// Data up to a million times as sure of one combination as the prior, as sure of another, and blind for a third. The
/// information then spans 1e12, and rounding 1e-16 of its largest entry is all that is known of the smallest.
TEST_P(Surprise, HoldsForSharpDataBesideUnseenStates) {
  Draws draws(93);
  for (const double sigma : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const Eigen::MatrixXd V =
        Eigen::MatrixXd(test::random_matrix(3, 3, draws).householderQr().householderQ()).leftCols(2);
    Eigen::MatrixXd scale = Eigen::Vector2d(1.0 / sigma, 1.0).asDiagonal();
    LinearModel model{scale * V.transpose(), Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(2.0 / sigma, 1.0)};
    const Gaussian prior{Eigen::Vector3d(0.3, -0.4, 0.5), Eigen::Matrix3d::Identity()};
    const double expected = by_definition(model, prior, V);
    EXPECT_NEAR(of(model, prior), expected, (1e-5 + 2e-15 / (sigma * sigma)) * (1.0 + expected)) << sigma;
  }
}

/// One degree a state: its mean over draws of truth and data, within five standard errors (sqrt(2 n / trials)).
TEST_P(Surprise, IsChiSquareWithADegreeAState) {
  constexpr int kStates = 3, kTrials = 4000;
  Draws draws(94);
  LinearModel model = test::random_linear_model(kStates, 7, draws);
  const Gaussian prior = test::random_prior(kStates, draws);
  const Eigen::MatrixXd L = Eigen::MatrixXd(prior.covariance).llt().matrixL(), W = model.R.llt().matrixL();
  double sum = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::VectorXd truth = prior.mean + L * test::random_matrix(kStates, 1, draws);
    model.y = model.H * truth + W * test::random_matrix(7, 1, draws);
    sum += of(model, prior);
  }
  EXPECT_NEAR(sum / kTrials, kStates, 5.0 * std::sqrt(2.0 * kStates / kTrials));
}

/// NIS = surprise + misfit of the data on their own: the split that the observer judges jumps and outliers by.
TEST_P(Surprise, AndTheMisfitOfTheDataAloneAddUpToTheNis) {
  Draws draws(95);
  for (int trial = 0; trial < 50; ++trial) {
    LinearModel model = test::random_linear_model(3, 8, draws);
    const Gaussian prior = test::random_prior(3, draws);
    const Eigen::MatrixXd weight = model.R.inverse();
    const Eigen::VectorXd x =
        (model.H.transpose() * weight * model.H).inverse() * model.H.transpose() * weight * model.y;
    const Eigen::VectorXd r = model.y - model.H * x;
    const double nis = test::textbook_update(model, prior).nis;
    EXPECT_NEAR(of(model, prior), nis - r.dot(weight * r), 1e-5 * (1.0 + nis));
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Surprise, ::testing::ValuesIn(kFilters),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

}  // namespace
}  // namespace palpate
