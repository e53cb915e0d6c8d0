// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <palpate/reproduction/page.hpp>
#include <thread>

namespace palpate::reproduction {

namespace {

bool is_correction(const PartMaker& maker) { return maker.about.starts_with("correction"); }

/// Share done over all parts.
class Progress {
 public:
  Progress(std::size_t parts, const std::function<void(double)>& report) : share_(parts, 0.0), report_(report) {}
  void set(std::size_t part, double share) {
    if (!report_) return;
    const std::scoped_lock lock(mutex_);
    share_[part] = share;
    report_(std::accumulate(share_.begin(), share_.end(), 0.0) / static_cast<double>(share_.size()));
  }

 private:
  std::mutex mutex_;
  std::vector<double> share_;
  std::function<void(double)> report_;
};

}  // namespace

std::vector<const PartMaker*> parts_named(const std::string& name) {
  std::vector<const PartMaker*> found;
  for (const PartMaker& maker : all_parts())
    if (name == maker.name || name == "all" || (name == "corrections" && is_correction(maker))) found.push_back(&maker);
  return found;
}

std::vector<Part> make_parts(std::span<const PartMaker* const> makers, int workers,
                             const std::function<void(double)>& progress) {
  std::vector<Part> parts(makers.size());
  Progress done(makers.size(), progress);
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const int threads = std::min(workers, static_cast<int>(makers.size()));
  const auto work = [&] {
    for (std::size_t i = next++; i < makers.size(); i = next++) try {
        parts[i] = makers[i]->make({.workers = workers / threads, .progress = [&, i](double s) { done.set(i, s); }});
        done.set(i, 1.0);
      } catch (...) {
        const std::scoped_lock lock(failing);
        if (!failure) failure = std::current_exception();
        next = makers.size();
      }
  };
  {
    std::vector<std::jthread> pool;
    pool.reserve(static_cast<std::size_t>(threads));
    for (int t = 0; t < threads; ++t) pool.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
  return parts;
}

std::string page_markdown(std::span<const PartMaker* const> makers, std::span<const Part> parts) {
  std::string page =
      "# The paper, made again\n\n"
      "Every table and figure of Kouh Soltani, Khanmohammadi, Ghalichi, \"A Three-Dimensional Shape-Based Force and "
      "Stiffness-Sensing Platform for Tendon-Driven Catheters\", Sensors 2016, 16, 990: theirs beside ours, with every "
      "assumption that the paper leaves open. Made by `palpate reproduce`; all but the times is the same in every "
      "run on processors with AVX2.\n\n";
  for (std::size_t i = 0; i < parts.size(); ++i) page += fmt::format("- [{}](#{})\n", parts[i].title, makers[i]->name);
  for (std::size_t i = 0; i < parts.size(); ++i)
    page += fmt::format("\n<a id=\"{}\"></a>\n\n## {}\n\n{}\n`palpate reproduce {}`\n", makers[i]->name, parts[i].title,
                        parts[i].markdown, makers[i]->name);
  return page;
}

}  // namespace palpate::reproduction
