// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <palpate/study/counter_random.hpp>
#include <palpate/study/identity.hpp>
#include <palpate/study/plan.hpp>
#include <palpate/study/run_model.hpp>
#include <palpate/study/settings.hpp>
#include <palpate/study/shard.hpp>
#include <palpate/study/statistics.hpp>
#include <set>

/// Which runs a plan has, and that they depend on nothing but the plan.
namespace palpate::study {
namespace {

Plan plan_of(std::uint64_t samples, std::uint64_t repeats) {
  Plan plan;
  plan.parameters.resize(3);
  plan.parameters[0].name = "a";
  plan.parameters[0].values = {1, 2, 3};
  plan.parameters[1].name = "x";
  plan.parameters[1].from = 10.0;
  plan.parameters[1].to = 20.0;
  plan.parameters[2].name = "b";
  plan.parameters[2].values = {"u", "v"};
  plan.measures = {Measure::kRmse};
  plan.samples = samples;
  plan.repeats = repeats;
  plan.shard_runs = 7;
  return plan;
}

TEST(CounterRandom, APermutationMeetsEveryNumberOnce) {
  for (const std::uint64_t n : {1U, 2U, 3U, 4U, 5U, 17U, 64U, 1000U}) {
    std::vector<bool> met(n);
    for (std::uint64_t i = 0; i < n; ++i) {
      const std::uint64_t j = permuted(i, n, 42);
      ASSERT_LT(j, n);
      EXPECT_FALSE(met[j]);
      met[j] = true;
    }
  }
}

/// Where one element lands, over 20 000 keys: chi-square with 9 degrees, which exceeds 33.7 once in 10 000.
TEST(CounterRandom, KeysMoveAnElementEverywhereAlike) {
  for (const std::uint64_t i : {0U, 5U, 9U}) {
    std::array<double, 10> count{};
    for (std::uint64_t key = 0; key < 20000; ++key) ++count[permuted(i, 10, key)];
    double chi_square = 0.0;
    for (const double n : count) chi_square += (n - 2000.0) * (n - 2000.0) / 2000.0;
    EXPECT_LT(chi_square, 33.7) << i;
  }
}

TEST(CounterRandom, MixIsSplitmix) {
  EXPECT_EQ(mix(0), 0xE220A8397B1DCDAFULL);  // the first output of splitmix64 from seed 0, as published
}

TEST(Plan, TheHypercubeHasOnePointInEveryPart) {
  const Plan plan = plan_of(50, 1);
  for (std::uint64_t grid = 0; grid < 6; ++grid) {
    std::set<int> parts;
    for (std::uint64_t i = 0; i < 50; ++i)
      parts.insert(static_cast<int>((point_values(plan, grid * 50 + i)[1].get<double>() - 10.0) / 10.0 * 50.0));
    EXPECT_EQ(parts.size(), 50U);
    EXPECT_EQ(*parts.rbegin(), 49);
  }
}

/// 1e300 over the least number that there is exceeds the largest one.
TEST(Plan, ALogarithmicRangeMayBeAsWideAsNumbersAre) {
  Parameter p;
  p.from = 5e-324;
  p.to = 1e300;
  p.logarithmic = true;
  EXPECT_EQ(between(p, 0.0), p.from);
  EXPECT_NEAR(between(p, 1.0) / p.to, 1.0, 1e-12);
  EXPECT_NEAR(std::log10(between(p, 0.5)), (std::log10(p.from) + 300.0) / 2.0, 1e-9);
}

TEST(Plan, TheGridMeetsEveryCombinationEquallyOften) {
  const Plan plan = plan_of(4, 1);
  std::map<std::string, int> count;
  for (std::uint64_t p = 0; p < plan.points(); ++p) {
    const auto values = point_values(plan, p);
    ++count[values[0].dump() + values[2].dump()];
  }
  ASSERT_EQ(count.size(), 6U);
  for (const auto& [values, n] : count) EXPECT_EQ(n, 4) << values;
}

TEST(Plan, ShardsHoldEveryRunOnce) {
  const Plan plan = plan_of(5, 3);
  ASSERT_EQ(plan.runs(), 90U);
  std::uint64_t next = 0;
  for (std::uint64_t s = 0; s < plan.shards(); ++s) {
    EXPECT_EQ(shard_range(plan, s).first, next);
    next = shard_range(plan, s).end;
  }
  EXPECT_EQ(next, 90U);
}

TEST(Plan, SeedsDifferUnlessTheyAreCommon) {
  Plan plan = plan_of(5, 3);
  std::set<std::uint64_t> seeds;
  for (std::uint64_t run = 0; run < 90; ++run) seeds.insert(run_key(plan, run).seed);
  EXPECT_EQ(seeds.size(), 90U);
  EXPECT_LT(*seeds.rbegin(), std::uint64_t{1} << 53U);
  plan.common_seeds = true;
  seeds.clear();
  for (std::uint64_t run = 0; run < 90; ++run) seeds.insert(run_key(plan, run).seed);
  EXPECT_EQ(seeds.size(), 3U);
}

/// What is written of a point, and read by its model, is the number that the results say.
TEST(Settings, ANumberGoesThroughTheFileToTheLastBit) {
  Plan plan = plan_of(1, 1);
  plan.base.scenario = toml::parse("[tracker]\nnoise_mm = 1");
  for (const double x : {std::nextafter(0.1, 1.0), 1.0 / 3.0, 1e-300, 123456789.0, 5e22, -2.5}) {
    Documents documents = plan.base;
    put_setting("scenario.tracker.noise_mm", x, documents);
    const toml::table read = toml::parse(toml_text(documents.scenario));
    EXPECT_EQ(read["tracker"]["noise_mm"].value<double>(), x);
  }
}

TEST(Identity, Sha256OfTheStandardsExamples) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Identity, WhatChangesResultsChangesTheId) {
  const Plan plan = plan_of(5, 3);
  std::set<std::string> ids{plan_id(plan)};
  const auto with = [&](const auto& change) {
    Plan other = plan;
    change(other);
    return plan_id(other);
  };
  EXPECT_TRUE(ids.insert(with([](Plan& p) { p.seed = 2; })).second);
  EXPECT_TRUE(ids.insert(with([](Plan& p) { p.repeats = 4; })).second);
  EXPECT_TRUE(ids.insert(with([](Plan& p) { p.common_seeds = true; })).second);
  EXPECT_TRUE(ids.insert(with([](Plan& p) { p.parameters[1].to = 21.0; })).second);
  EXPECT_TRUE(ids.insert(with([](Plan& p) { p.parameters[1].logarithmic = true; })).second);
  EXPECT_TRUE(ids.insert(with([](Plan& p) { p.base.catheter.insert("schema", 1); })).second);
  EXPECT_EQ(with([](Plan& p) { p.name = "another title"; }), plan_id(plan));
  EXPECT_NE(shard_id("a", {0, 10}), shard_id("a", {0, 11}));
}

TEST(Shard, BytesBringBackTheSame) {
  const ShardResult sent{
      .shard = 3,
      .rows = {{.run = 21, .values = {0.1, -2.0}, .failure = ""}, {.run = 22, .values = {}, .failure = "why"}}};
  const ShardResult got = decode(encode(sent));
  EXPECT_EQ(got.shard, 3U);
  ASSERT_EQ(got.rows.size(), 2U);
  EXPECT_EQ(got.rows[0].values, sent.rows[0].values);
  EXPECT_EQ(got.rows[1].failure, "why");
  EXPECT_EQ(got.rows[1].run, 22U);
}

/// 0 .. 100: the quantiles are the numbers themselves.
TEST(Statistics, QuantilesOfARow) {
  std::vector<double> values(101);
  std::iota(values.begin(), values.end(), 0.0);
  std::reverse(values.begin(), values.end());
  const Spread spread = spread_of(values);
  EXPECT_NEAR(spread.low, 5.0, 1e-12);
  EXPECT_NEAR(spread.median, 50.0, 1e-12);
  EXPECT_NEAR(spread.high, 95.0, 1e-12);
  EXPECT_NEAR(spread.mean, 50.0, 1e-12);
}

}  // namespace
}  // namespace palpate::study
