// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <tests/estimation/motions.hpp>

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Draws;

MatrixXd random_covariance(Index n, Draws& draws) {
  const MatrixXd L = MatrixXd::NullaryExpr(n, n, [&] { return draws.normal(); });
  return L * L.transpose() + 0.1 * MatrixXd::Identity(n, n);
}

VectorXd random_vector(Index n, Draws& draws) {
  return VectorXd::NullaryExpr(n, [&] { return draws.normal(); });
}

/// Constants and slow ones, drawn anew, estimated and considered in turn.
ParameterPrior some_parameters(Index q, Draws& draws) {
  ParameterPrior prior{.covariance = random_covariance(q, draws),
                       .memory_s = VectorXd(q),
                       .drive = VectorXd::Zero(q),
                       .rate = Eigen::VectorXi::Constant(q, -1),
                       .estimated = Eigen::Array<bool, Eigen::Dynamic, 1>(q),
                       .force_exponents = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, q)};
  for (Index i = 0; i < q; ++i) {
    prior.memory_s(i) = i % 3 == 0 ? std::numeric_limits<double>::infinity() : 0.2 * static_cast<double>(i);
    prior.estimated(i) = i % 2 == 1;
  }
  if (q > 2) {
    prior.memory_s(2) = 0.0;
    const double variance = prior.covariance(2, 2);
    prior.covariance.row(2).setZero();
    prior.covariance.col(2).setZero();
    prior.covariance(2, 2) = variance;
  }
  return prior;
}

/// (s, p) as one vector.
struct Dense {
  VectorXd mean;
  MatrixXd P;
};

Dense dense(const Belief& b) {
  const Index n = b.motion.mean.size(), q = b.parameters.size();
  Dense out{VectorXd(n + q), MatrixXd(n + q, n + q)};
  out.mean << b.motion.mean, b.parameters;
  out.P << MatrixXd(b.motion.covariance), b.cross, b.cross.transpose(), b.parameter_covariance;
  return out;
}

Belief split(const Dense& d, Index n) {
  const Index q = d.mean.size() - n;
  return {
      {d.mean.head(n), d.P.topLeftCorner(n, n)}, d.mean.tail(q), d.P.topRightCorner(n, q), d.P.bottomRightCorner(q, q)};
}

FrameLine random_line(Index rows, Index q, Draws& draws) {
  FrameLine line;
  line.force_N = draws.normal3();
  line.parameters = random_vector(q, draws);
  line.residual = random_vector(rows, draws);
  line.by_force = MatrixXd::NullaryExpr(rows, 3, [&] { return draws.normal(); });
  line.by_parameters = MatrixXd::NullaryExpr(rows, q, [&] { return draws.normal(); });
  line.noise = random_covariance(rows, draws);
  return line;
}

/// Three rows of unit noise in place of twelve: the belief that follows is the same, also where a direction of the
/// force is hidden, a direction is not seen at all, or noise is correlated.
TEST(Belief, ACompressedLineSaysTheSame) {
  Draws draws(57);
  for (const MotionOptions& options : test::all_motions())
    for (const bool blind : {false, true}) {
      const MotionModel model(options);
      const BeliefModel parameters(some_parameters(0, draws));
      FrameLine line = random_line(12, 0, draws);
      if (blind) line.by_force.col(1) = 2.0 * line.by_force.col(0);
      FrameLine shorter = line;
      compress(shorter);
      ASSERT_EQ(shorter.residual.size(), 3);
      EXPECT_TRUE(shorter.noise.isIdentity(0.0));
      for (const double weak_N : {1e-3, 1e6}) {
        hide_axial_force(weak_N, false, MatrixXd(0, 0), line);
        hide_axial_force(weak_N, false, MatrixXd(0, 0), shorter);
        EXPECT_LT((line.hidden - shorter.hidden).norm(), 1e-9);
        const Index n = model.states();
        const Belief before = split({random_vector(n, draws), random_covariance(n, draws)}, n);
        Belief whole = before, compressed = before;
        Correction correction;
        ASSERT_TRUE(parameters.update(model.seen(), line, whole, correction));
        ASSERT_TRUE(parameters.update(model.seen(), shorter, compressed, correction));
        EXPECT_LT((whole.motion.mean - compressed.motion.mean).norm(), 1e-9 * (1.0 + whole.motion.mean.norm()));
        EXPECT_LT((whole.motion.covariance - compressed.motion.covariance).norm(),
                  1e-9 * whole.motion.covariance.norm());
      }
    }
}

TEST(Belief, WhatSpeaksOfParametersIsNotCompressed) {
  Draws draws(58);
  FrameLine line = random_line(12, 2, draws), few = random_line(3, 0, draws), bad = random_line(12, 0, draws);
  bad.noise(4, 4) = -1.0;
  for (FrameLine* l : {&line, &few, &bad}) {
    const FrameLine before = *l;
    compress(*l);
    EXPECT_EQ(l->residual, before.residual);
    EXPECT_EQ(l->noise, before.noise);
  }
}

/// The textbook's update of the whole vector: Joseph's form, right for any gain, with the gain of considered parameters
/// set to zero (Schmidt). Up to 39 + 8 states of size 1: rounding stays below 1e-9.
TEST(Belief, UpdateIsSchmidtsOnTheWholeVector) {
  Draws draws(51);
  for (const MotionOptions& options : test::all_motions())
    for (const Index q : {0, 1, 8})
      for (const Index rows : {3, 12}) {
        const MotionModel model(options);
        const Index n = model.states();
        const BeliefModel parameters(some_parameters(q, draws));
        const Dense before{random_vector(n + q, draws), random_covariance(n + q, draws)};
        FrameLine line = random_line(rows, q, draws);
        const bool hides = rows == 12 && q > 0;
        const Vector3d v = draws.normal3().normalized();
        if (hides) line.hidden = v * v.transpose();
        line.hiding_rows = 7;
        MatrixXd J(rows, n + q);
        J << MatrixXd(line.by_force) * test::dense_map(model.seen()), MatrixXd(line.by_parameters);
        const MatrixXd R = line.noise, S = J * before.P * J.transpose() + R;
        MatrixXd K = before.P * J.transpose() * S.inverse();
        for (Index i = 0; i < q; ++i)
          if (!parameters.prior().estimated(i)) K.row(n + i).setZero();
        for (Index k = 0; hides && k < n; k += 3)  // a direction of the force that is only considered
          K.block(k, 0, 3, 7) -= (v * v.transpose() * K.block(k, 0, 3, 7)).eval();
        VectorXd x0 = VectorXd::Zero(n + q);
        x0.head<3>() = line.force_N;  // any state whose seen force this is: the level
        x0.tail(q) = line.parameters;
        const VectorXd mean = before.mean + K * (line.residual + J * (x0 - before.mean));
        const MatrixXd keep = MatrixXd::Identity(n + q, n + q) - K * J;
        const MatrixXd P = keep * before.P * keep.transpose() + K * R * K.transpose();

        Belief belief = split(before, n);
        Correction correction;
        ASSERT_TRUE(parameters.update(model.seen(), line, belief, correction));
        const Dense found = dense(belief);
        EXPECT_LT((found.mean - mean).norm(), 1e-9);
        EXPECT_LT((found.P - P).norm(), 1e-9) << n << ' ' << q << ' ' << rows;
        EXPECT_EQ(found.P, MatrixXd(found.P.transpose()));
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(found.P).eigenvalues()(0), 0.0);
      }
}

TEST(Belief, PredictionIsTheTextbooksOfMotionAndGaussMarkovParameters) {
  Draws draws(56);
  for (const MotionOptions& options : test::all_motions()) {
    const MotionModel model(options);
    const Index n = model.states(), q = 8;
    ParameterPrior prior = some_parameters(q, draws);
    prior.covariance *= 100.0;  // nothing leaves what is believed of it
    prior.drive(3) = 0.7;
    prior.rate(3) = 6;  // a constant
    const BeliefModel parameters(prior);
    const Dense before{random_vector(n + q, draws), random_covariance(n + q, draws)};
    MotionStep step;
    step.dt_s = 0.1;
    step.drive = Vector3d(0.1, 0.3, 1.0);
    step.rhythm = test::some_rhythm();
    MatrixXd A = MatrixXd::Zero(n + q, n + q), Q = A;
    A.topLeftCorner(n, n) = test::dense_transition(model, step);
    Q.topLeftCorner(n, n) = test::dense_noise(model, step);
    for (Index i = 0; i < q; ++i) A(n + i, n + i) = prior.memory_s(i) == 0.0 ? 0.0 : std::exp(-0.1 / prior.memory_s(i));
    const MatrixXd Phi = A.bottomRightCorner(q, q);
    MatrixXd wander = MatrixXd::Identity(q, q);
    wander(3, 6) = step.dt_s;
    Q.bottomRightCorner(q, q) = wander * (prior.covariance - Phi * prior.covariance * Phi) * wander.transpose();
    Q(n + 3, n + 3) += 0.7 * 0.7 * step.dt_s;
    A.bottomRightCorner(q, q) = wander * Phi;
    Belief belief = split(before, n);
    parameters.predict(model, step, belief);
    const Dense found = dense(belief);
    EXPECT_LT((found.mean - A * before.mean).norm(), 1e-12);
    EXPECT_LT((found.P - (A * before.P * A.transpose() + Q)).norm(), 1e-9);
  }
}

/// From 0.3 N to 0.1 uN and again 10 000 times: no drift away from symmetric and positive definite.
TEST(Belief, StaysDefiniteOverManySharpUpdates) {
  Draws draws(52);
  const MotionModel model(MotionOptions{});
  const BeliefModel parameters(ParameterPrior{});
  Belief belief;
  parameters.initial(model, belief);
  MotionStep step;
  step.dt_s = 0.025;
  step.drive = Vector3d(5e-4, 1.0, 50.0);
  Correction correction;
  for (int k = 0; k < 10000; ++k) {
    step.jump = k % 100 == 99;
    parameters.predict(model, step, belief);
    const FrameLine line = line_of(test::measure(Vector3d::Zero(), 1e-14 * Matrix3d::Identity(), draws), 0);
    ASSERT_TRUE(parameters.update(model.seen(), line, belief, correction));
    ASSERT_GT(belief.motion.covariance.diagonal().minCoeff(), 0.0);
  }
  EXPECT_LT(force_of(model.seen(), belief.motion).mean_N.norm(), 1e-6);
}

TEST(Belief, RefusesWhatIsNotFiniteAndStaysAsItWas) {
  Draws draws(53);
  const MotionModel model(MotionOptions{});
  const Index n = model.states(), q = 4;
  const BeliefModel parameters(some_parameters(q, draws));
  const Dense before{random_vector(n + q, draws), random_covariance(n + q, draws)};
  const FrameLine good = random_line(6, q, draws);
  FrameLine bad = good, worse = good, negative = good;
  bad.residual(2) = std::numeric_limits<double>::quiet_NaN();
  worse.by_parameters(1, 1) = std::numeric_limits<double>::quiet_NaN();
  negative.noise = -1e6 * MatrixXd::Identity(6, 6);
  for (const FrameLine& line : {bad, worse, negative}) {
    Belief belief = split(before, n);
    Correction correction;
    EXPECT_FALSE(parameters.update(model.seen(), line, belief, correction));
    EXPECT_EQ(dense(belief).mean, before.mean);
    EXPECT_EQ(correction.rows, 0);
  }
}

/// The parameters follow a force that is held within belief as they would a measurement of zero.
TEST(Belief, LimitingTheForceIsWithinBelief) {
  Draws draws(57);
  SeenBelief seen{random_vector(7, draws), random_covariance(7, draws)};
  const SeenBelief before = seen;
  limit_force(0.5, seen);
  const ForceGaussian expected = within_belief({before.mean.head<3>(), before.covariance.topLeftCorner<3, 3>()}, 0.5);
  EXPECT_LT((seen.mean.head<3>() - expected.mean_N).norm(), 1e-12);
  EXPECT_LT((seen.covariance.topLeftCorner<3, 3>() - expected.covariance_N2).norm(), 1e-12);
  // p | F is not changed by what is learned of F
  const MatrixXd gain_before =
      before.covariance.topLeftCorner<3, 3>().ldlt().solve(before.covariance.topRightCorner(3, 4));
  const MatrixXd gain = seen.covariance.topLeftCorner<3, 3>().ldlt().solve(seen.covariance.topRightCorner(3, 4));
  EXPECT_LT((gain - gain_before).norm(), 1e-9);
  EXPECT_LT((seen.mean.tail(4) - before.mean.tail(4) - gain.transpose() * (seen.mean - before.mean).head<3>()).norm(),
            1e-9);
}

TEST(ForceLikelihood, OfALineWithoutParametersIsItsInformation) {
  Draws draws(58);
  const FrameLine line = random_line(12, 0, draws);
  const ForceLikelihood found = force_likelihood(line, {}, {});
  const MatrixXd J = line.by_force, W = MatrixXd(line.noise).inverse();
  EXPECT_LT((found.information_per_N2 - J.transpose() * W * J).norm(), 1e-9);
  EXPECT_LT((found.information_mean_per_N - J.transpose() * W * (line.residual + J * line.force_N)).norm(), 1e-9);
  const FrameLine again = line_of(found, 0);
  EXPECT_LT((force_likelihood(again, {}, {}).information_per_N2 - found.information_per_N2).norm(), 1e-9);
  EXPECT_LT((force_likelihood(again, {}, {}).information_mean_per_N - found.information_mean_per_N).norm(), 1e-9);
}

/// With uncertain parameters: the weighted least-squares force of the frame, and its covariance by white noise alone.
TEST(ForceLikelihood, OfALineWithParametersIsTheFrameWeighedByAllAndBlurredByTheWhiteNoise) {
  Draws draws(59);
  const Index q = 4;
  const MotionModel model(MotionOptions{});
  const ParameterPrior prior = some_parameters(q, draws);
  Belief belief =
      split({random_vector(model.states() + q, draws), random_covariance(model.states() + q, draws)}, model.states());
  const FrameLine line = random_line(12, q, draws);
  const MatrixXd J = line.by_force, J_p = line.by_parameters, R = line.noise;
  const MatrixXd W = (R + J_p * belief.parameter_covariance * J_p.transpose()).inverse();
  const MatrixXd K = (J.transpose() * W * J).inverse() * J.transpose() * W;
  const VectorXd force = K * (line.residual + J * line.force_N + J_p * (line.parameters - belief.parameters));
  const MatrixXd white = R + prior.covariance(2, 2) * J_p.col(2) * J_p.col(2).transpose();
  const MatrixXd V = K * white * K.transpose();
  const ForceLikelihood found = force_likelihood(line, prior, belief);
  EXPECT_LT((found.information_per_N2.inverse() - V).norm(), 1e-9 * V.norm());
  EXPECT_LT((found.information_per_N2.inverse() * found.information_mean_per_N - force).norm(), 1e-8);
}

}  // namespace
}  // namespace palpate
