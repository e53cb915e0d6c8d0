// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <palpate/study/workers.hpp>
#include <string>

/// Workers that are processes of an MPI job, on as many machines as it has. Rank 0 hands out and keeps, the others
/// play. A rank that dies takes the job with it, as MPI has it; what was handed in is kept, and the same command goes
/// on.
namespace palpate::study {

/// MPI from its beginning to its end: one object, in main(). Where rank 0 lets it go without having made workers, the
/// other ranks end, too.
class MpiJob {
 public:
  MpiJob(int& argc, char**& argv);
  ~MpiJob();
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

  /// Rank 0: the other ranks; there must be some. Throws InputError where one cannot read the study or has another
  /// fingerprint (fingerprint.hpp).
  std::unique_ptr<Workers> workers(const Plan& plan, const std::string& fingerprint);
  /// The other ranks: plays shards of the study until rank 0 has no more.
  void serve(const std::filesystem::path& study);

  /// Ends all ranks at once.
  void abort(int exit_code);

 private:
  int rank_ = 0, size_ = 1;
  bool begun_ = false;  ///< rank 0 told the others to read the study, or they listen
};

}  // namespace palpate::study
