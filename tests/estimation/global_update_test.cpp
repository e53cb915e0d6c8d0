// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <palpate/estimation/global_update.hpp>
#include <sstream>
#include <tests/observer/allocation_counter.hpp>
#include <vector>

/// One-dimensional costs whose minima are known, with seeds that are written down.
namespace palpate {
namespace {

StateVector point(double x) { return StateVector::Constant(1, x); }

Gaussian prior_at(double mean, double sigma = 10.0) {
  return {point(mean), StateMatrix::Constant(1, 1, sigma * sigma)};
}

/// A list of seeds that notes what is asked of it.
struct Script {
  std::vector<double> seeds;
  int work_per_seed = 0;
  int seeds_asked = 0, evaluations = 0;
  double first_evaluated = NAN;

  bool seed(int k, StateVector& x, int& work) {
    EXPECT_EQ(k, seeds_asked) << "in rising order";
    ++seeds_asked;
    work += work_per_seed;
    if (k >= static_cast<int>(seeds.size())) return false;
    x(0) = seeds[static_cast<std::size_t>(k)];
    return true;
  }
  void note(double x) {
    if (evaluations++ == 0) first_evaluated = x;
  }
};

/// r = (steepness prod_i (x - root_i), tilt (x - best), misfit, 0, ...), unit noise: a minimum near every root, that at
/// `best` with the data's chi-square misfit^2, any other with about tilt^2 (root - best)^2 more.
struct Valleys : Script {
  std::vector<double> roots{-1.0, 1.0};
  double steepness = 100.0, best = 1.0, tilt = 0.0, misfit = 0.0;
  int count = 5;  ///< of rows

  int rows() const { return count; }
  void noise(ResidualMatrix& R) const { R.setIdentity(count, count); }
  bool linearize(const StateVector& x, Linearization& at) {
    note(x(0));
    double product = steepness, slope = 0.0;
    for (const double root : roots) {
      slope = slope * (x(0) - root) + product;
      product *= x(0) - root;
    }
    at.residual.setZero(count);
    at.jacobian.setZero(count, 1);
    at.residual.head<3>() << product, tilt * (x(0) - best), misfit;
    at.jacobian.col(0).head<2>() << -slope, -tilt;
    return true;
  }
};
static_assert(SeededModel<Valleys>);

/// 2 x 10 of tilt over the distance 2: a chi-square of 400 with 4 degrees of freedom, beyond 1 in 1e12 (62).
Valleys wrong_valley(std::vector<double> seeds) {
  Valleys model;
  model.tilt = 10.0;
  model.seeds = std::move(seeds);
  return model;
}

Update search(Valleys& model, const Gaussian& prior, const double* start, const SearchOptions& options = {}) {
  Update out;
  const StateVector x = point(start ? *start : 0.0);
  GlobalUpdate(options).run(model, prior, start ? &x : nullptr, out);
  return out;
}

TEST(GlobalUpdate, LeavesAWrongMinimumForASeed) {
  Valleys model = wrong_valley({-0.9, 1.2, 0.8});
  const double start = -1.1;
  const SearchOptions to_the_end{.local = {.step_tolerance = 1e-6}};
  const Update update = search(model, prior_at(-1.0), &start, to_the_end);
  EXPECT_EQ(update.status, UpdateStatus::kReseeded);
  EXPECT_NEAR(update.posterior.mean(0), 1.0, 1e-4);
  EXPECT_NEAR(update.posterior.covariance(0, 0), 1.0 / (200.0 * 200.0 + 100.0 + 0.01), 1e-9);
  EXPECT_EQ(model.seeds_asked, 2) << "the third is not needed";
  EXPECT_EQ(update.evaluations, model.evaluations);
}

TEST(GlobalUpdate, KeepsAPlausibleMinimumWithoutTouchingASeed) {
  Valleys model = wrong_valley({-1.0});
  const double start = 1.1;
  const Gaussian prior = prior_at(0.9);
  Update local;
  iterated_update(model, prior, point(start), {}, local);
  model.evaluations = 0;
  const Update update = search(model, prior, &start);
  EXPECT_EQ(update.status, UpdateStatus::kConverged);
  EXPECT_EQ(model.seeds_asked, 0);
  EXPECT_EQ(update.evaluations, local.evaluations);
  EXPECT_EQ(update.evaluations, model.evaluations);
  EXPECT_EQ(update.posterior.mean, local.posterior.mean);
  EXPECT_EQ(update.chi_square, local.chi_square);
}

/// 1 in 1e6 is 33.4, 1 in 1e12 is 62 with four degrees of freedom: 36 and 49 are unlikely, 81 is impossible.
TEST(GlobalUpdate, UnlikelyMinimumIsBelievedOnceASecondSearchEndsThere) {
  for (const double misfit : {6.0, 7.0, 9.0}) {
    Valleys model = wrong_valley({0.95, 1.05, 1.1});
    model.misfit = misfit;
    const double start = 1.1;
    const Update update = search(model, prior_at(1.0), &start);
    EXPECT_EQ(update.status, UpdateStatus::kConverged) << "where it began";
    EXPECT_EQ(model.seeds_asked, misfit < 8.0 ? 1 : 4) << misfit;
    EXPECT_NEAR(update.residual_chi_square, misfit * misfit, 1e-3);
  }
}

/// Two minima, that at +1 nearer to the prior's mean, and two degrees of freedom to spare.
struct Rivals {
  Valleys model;
  Gaussian prior = prior_at(0.1, 1.0);
  Rivals(double best, double tilt) {
    model.count = 3;
    model.best = best;
    model.tilt = tilt;
    model.seeds = {-1.1, 0.9, -0.8};
  }
};

TEST(GlobalUpdate, OfMinimaThatExplainTheDataEquallyTheOneNearerToThePriorIsKept) {
  for (const double tilt : {0.0, 0.5, 0.9})  // the far one better by up to 4 * 0.81, less than four
    for (const double start : {-1.2, 1.2}) {
      Rivals rivals(-1.0, tilt);
      const Update update = search(rivals.model, rivals.prior, &start);
      EXPECT_EQ(update.status, UpdateStatus::kAmbiguous) << tilt << " from " << start;
      EXPECT_NEAR(update.posterior.mean(0), 1.0, 1e-3);
      EXPECT_NEAR(update.residual_chi_square, 4.0 * tilt * tilt, 0.01);
      EXPECT_EQ(rivals.model.seeds_asked, 4) << "every seed is tried";
    }
}

TEST(GlobalUpdate, MinimumThatExplainsTheDataBetterIsKeptAndIsNotAmbiguous) {
  for (const double best : {-1.0, 1.0})
    for (const double start : {-1.2, 1.2}) {
      Rivals rivals(best, 1.2);  // 5.8 apart
      const Update update = search(rivals.model, rivals.prior, &start);
      EXPECT_EQ(update.status, start * best > 0.0 ? UpdateStatus::kConverged : UpdateStatus::kReseeded);
      EXPECT_NEAR(update.posterior.mean(0), best, 1e-3);
    }
}

/// With three to spare the first plausible minimum is the answer, though another one would do as well.
TEST(GlobalUpdate, EnoughSurplusIsNotSearchedForRivals) {
  Rivals rivals(1.0, 0.0);
  rivals.model.count = 4;
  const double start = -1.2;
  const Update update = search(rivals.model, rivals.prior, &start);
  EXPECT_EQ(update.status, UpdateStatus::kConverged);
  EXPECT_EQ(rivals.model.seeds_asked, 0);
}

/// r = 1e30 exp(-x): every step gains, none arrives.
struct Runaway : Script {
  int rows() const { return 5; }
  void noise(ResidualMatrix& R) const { R.setIdentity(5, 5); }
  bool linearize(const StateVector& x, Linearization& at) {
    note(x(0));
    at.residual.setConstant(5, 1e30 * std::exp(-x(0)));
    at.jacobian = at.residual;
    return true;
  }
  bool seed(int k, StateVector& x, int& work) {
    x(0) = 0.1 * k;
    return Script::seed(k, x, work) || true;
  }
};

/// The seed and the search from it that have begun end later: by what each may take.
TEST(GlobalUpdate, WorkIsBoundedWhereNothingEverFits) {
  for (const int most : {20, 60, 200, 1000})
    for (const int work_per_seed : {0, 3, 15, 35}) {
      Runaway model;
      model.work_per_seed = work_per_seed;
      Update update;
      const SearchOptions options{.max_evaluations = most};
      GlobalUpdate(options).run(model, prior_at(0.0, 100.0), nullptr, update);
      EXPECT_EQ(update.status, UpdateStatus::kNotConverged);
      EXPECT_EQ(update.evaluations, model.evaluations + work_per_seed * model.seeds_asked) << "all is counted";
      EXPECT_GE(update.evaluations, most);
      EXPECT_LT(update.evaluations, most + work_per_seed + 1 + options.local.max_iterations);
    }
}

TEST(GlobalUpdate, EndsWithTheListOfSeeds) {
  Valleys model = wrong_valley({-1.1, -1.0, -0.9});
  const double start = -1.1;
  const Update update = search(model, prior_at(-1.0), &start);
  EXPECT_EQ(model.seeds_asked, 4);
  EXPECT_EQ(update.status, UpdateStatus::kConverged);
  EXPECT_NEAR(update.residual_chi_square, 400.0, 2.0) << "implausible, and said so by its cost";
}

/// Newton's iteration on x^2 = 1 from 1.5: 1.083, 1.0032, where two steps end, 0.64 posterior sigmas (1/200) away.
TEST(GlobalUpdate, SearchThatRanOutIsReplacedByOneThatConvergesInTheSamePlace) {
  Valleys model;
  model.seeds = {1.0005};
  const SearchOptions options{.local = {.max_iterations = 2}};
  const double start = 1.5;
  Update ran_out;
  iterated_update(model, prior_at(1.0), point(start), options.local, ran_out);
  ASSERT_EQ(ran_out.status, UpdateStatus::kNotConverged);
  const Update update = search(model, prior_at(1.0), &start, options);
  EXPECT_TRUE(converged(update.status));
  EXPECT_EQ(model.seeds_asked, 1);
  EXPECT_NEAR(update.posterior.mean(0), 1.0, 1e-5);
}

/// The search from the seed ends lower than where the first one arrived, on its way to a better place.
TEST(GlobalUpdate, SearchThatRanOutDoesNotReplaceOneThatConverged) {
  Valleys model = wrong_valley({1.6});
  const SearchOptions options{.local = {.max_iterations = 2}};
  const double start = -0.9952;
  const Update update = search(model, prior_at(-1.0), &start, options);
  EXPECT_EQ(update.status, UpdateStatus::kConverged);
  EXPECT_LT(update.posterior.mean(0), 0.0);
}

/// Nothing of the update before stays behind either.
TEST(GlobalUpdate, BrokenPriorFailsAndIsHandedBack) {
  Valleys model = wrong_valley({1.0, -1.0});
  model.misfit = 2.0;
  GlobalUpdate global;
  Update update;
  global.run(model, prior_at(0.9), nullptr, update);
  ASSERT_TRUE(converged(update.status) && update.chi_square > 3.9);
  for (const double variance : {-1.0, 0.0, static_cast<double>(NAN)}) {
    const Gaussian broken{point(0.3), StateMatrix::Constant(1, 1, variance)};
    model.seeds_asked = 0;
    const StateVector start = point(0.5);
    global.run(model, broken, &start, update);
    EXPECT_EQ(update.status, UpdateStatus::kFailed);
    EXPECT_EQ(update.posterior.mean, broken.mean);
    EXPECT_EQ(update.rows, 5);
    EXPECT_EQ(update.chi_square, 0.0);
    EXPECT_EQ(update.residual_chi_square, 0.0);
    EXPECT_EQ(update.surprise, 0.0);
  }
}

TEST(GlobalUpdate, WithoutAStartTheSeedsAloneCount) {
  Valleys model = wrong_valley({1.25});
  const Update update = search(model, prior_at(-1.0), nullptr);
  EXPECT_EQ(update.status, UpdateStatus::kReseeded);
  EXPECT_NEAR(update.posterior.mean(0), 1.0, 1e-4);
  EXPECT_NEAR(model.first_evaluated, 1.25, 1e-12);
  EXPECT_NEAR(update.innovation(0), 100.0 * (1.25 * 1.25 - 1.0), 1e-9);
}

TEST(GlobalUpdate, WithoutAStartAndSeedsNothingIsKnown) {
  Valleys model = wrong_valley({});
  const Update update = search(model, prior_at(-1.0), nullptr);
  EXPECT_EQ(update.status, UpdateStatus::kFailed);
  EXPECT_EQ(update.posterior.mean(0), -1.0);
  EXPECT_EQ(update.evaluations, 0);
}

TEST(GlobalUpdate, NothingIsAllocated) {
  Valleys model = wrong_valley({-0.9, -1.1, 1.2});
  GlobalUpdate global;
  Update update;
  const Gaussian prior = prior_at(-1.0);
  const StateVector start = point(-1.1);
  const test::CountAllocations count;
  global.run(model, prior, &start, update);
  EXPECT_EQ(count.so_far(), 0U);
}

/// Three valleys at least 1 apart, one without misfit; the others cost at least 20^2 more. Seeds near all of them, in
/// any order, and a start anywhere.
void finds_the_one_valley_that_fits() {
  const auto gap = [] { return 1.0 + 0.01 * *rc::gen::inRange(0, 200); };
  const double a = -0.02 * *rc::gen::inRange(0, 100), b = a + gap(), c = b + gap();
  Valleys model = wrong_valley({});
  model.roots = {a, b, c};
  model.best = *rc::gen::element(a, b, c);
  model.tilt = 20.0;
  model.steepness = 1000.0;
  for (const double root : model.roots) model.seeds.push_back(root + 0.01 * *rc::gen::inRange(-5, 6));
  std::rotate(model.seeds.begin(), model.seeds.begin() + *rc::gen::inRange(0, 3), model.seeds.end());
  const double start = 0.05 * *rc::gen::inRange(-80, 80);
  const Update update = search(model, prior_at(0.0), &start);
  RC_ASSERT(converged(update.status));
  RC_ASSERT(update.status != UpdateStatus::kAmbiguous);
  RC_ASSERT(std::abs(update.posterior.mean(0) - model.best) < 1e-3);
}

TEST(GlobalUpdate, FindsTheOneValleyThatFits) {
  rc::detail::TestMetadata metadata;
  metadata.id = metadata.description = "the one valley";
  rc::detail::TestParams params;
  params.seed = 20260102;
  params.maxSuccess = 300;
  const auto result = rc::detail::checkTestable(finds_the_one_valley_that_fits, metadata, params);
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  EXPECT_TRUE(result.is<rc::detail::SuccessResult>()) << text.str();
}

}  // namespace
}  // namespace palpate
