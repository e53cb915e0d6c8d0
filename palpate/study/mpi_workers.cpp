// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <mpi.h>

#include <chrono>
#include <palpate/math/errors.hpp>
#include <palpate/study/fingerprint.hpp>
#include <palpate/study/mpi_workers.hpp>
#include <palpate/study/scratch_folder.hpp>
#include <palpate/study/study_file.hpp>
#include <thread>
#include <vector>

namespace palpate::study {

namespace {

constexpr int kShard = 1, kBytes = 2;                 // tags
constexpr std::uint64_t kNoMore = ~std::uint64_t{0};  // instead of a shard

void send(const std::string& bytes) {
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, kBytes, MPI_COMM_WORLD);
}

void give_shard(int rank, std::uint64_t shard) { MPI_Send(&shard, 1, MPI_UINT64_T, rank, kShard, MPI_COMM_WORLD); }

std::string receive(const MPI_Status& probed) {
  int size = 0;
  MPI_Get_count(&probed, MPI_BYTE, &size);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  MPI_Recv(bytes.data(), size, MPI_BYTE, probed.MPI_SOURCE, kBytes, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return bytes;
}

std::string receive(int rank) {
  MPI_Status probed;
  MPI_Probe(rank, kBytes, MPI_COMM_WORLD, &probed);
  return receive(probed);
}

class MpiWorkers final : public Workers {
 public:
  explicit MpiWorkers(int count) : busy_(static_cast<std::size_t>(count), false) {}

  ~MpiWorkers() override {
    for (std::size_t i = 0; i < busy_.size(); ++i) {
      const int rank = static_cast<int>(i) + 1;
      if (busy_[i]) receive(rank);  // it may wait for somebody to take its shard, which nobody wants now
      give_shard(rank, kNoMore);
    }
  }
  MpiWorkers(const MpiWorkers&) = delete;
  MpiWorkers& operator=(const MpiWorkers&) = delete;

  int count() const override { return static_cast<int>(busy_.size()); }

  void give(int worker, std::uint64_t shard) override {
    give_shard(worker + 1, shard);
    busy_[static_cast<std::size_t>(worker)] = true;
  }

  /// Asks now and then: the waiting of MPI itself burns a core.
  WorkerEvent wait() override {
    using namespace std::chrono_literals;
    const auto end = std::chrono::steady_clock::now() + 200ms;
    do {
      int there = 0;
      MPI_Status probed;
      MPI_Iprobe(MPI_ANY_SOURCE, kBytes, MPI_COMM_WORLD, &there, &probed);
      if (there != 0) return result(probed);
      std::this_thread::sleep_for(100us);
    } while (std::chrono::steady_clock::now() < end);
    return {};
  }

 private:
  WorkerEvent result(const MPI_Status& probed) {
    const int worker = probed.MPI_SOURCE - 1;
    busy_[static_cast<std::size_t>(worker)] = false;
    return {.kind = WorkerEvent::Kind::kResult, .worker = worker, .result = decode(receive(probed)), .reason = {}};
  }

  std::vector<bool> busy_;
};

/// What rank 0 said for all to hear: whether there is a study to play.
bool told(bool go) {
  int word = go ? 1 : 0;
  MPI_Bcast(&word, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return word != 0;
}

/// A plan and its model, in the order in which they must go.
struct Desk {
  explicit Desk(const std::filesystem::path& study)
      : plan(read_study_file(study)), model(make_model(plan, scratch.path())) {}
  ScratchFolder scratch;
  Plan plan;
  std::unique_ptr<RunModel> model;
};

/// The desk, and what rank 0 shall know of it: its fingerprint, or why there is none.
std::string set_up(const std::filesystem::path& study, std::unique_ptr<Desk>& desk) {
  try {
    desk = std::make_unique<Desk>(study);
    return fingerprint(desk->plan, *desk->model);
  } catch (const std::exception& error) {
    return fmt::format("it cannot: {}", error.what());  // with a space: no fingerprint
  }
}

}  // namespace

MpiJob::MpiJob(int& argc, char**& argv) {
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

MpiJob::~MpiJob() {
  if (!begun_ && told(false)) abort(2);  // rank 0 waits for this one, which has nothing to play
  MPI_Finalize();
}

void MpiJob::abort(int exit_code) { MPI_Abort(MPI_COMM_WORLD, exit_code); }

std::unique_ptr<Workers> MpiJob::workers(const Plan& plan, const std::string& fingerprint) {
  told(begun_ = true);
  auto workers = std::make_unique<MpiWorkers>(size_ - 1);
  std::string refused;
  for (int rank = 1; rank < size_; ++rank)
    if (const std::string word = receive(rank); word != fingerprint && refused.empty())
      refused = fmt::format("--mpi: rank {}: expected the runs of {} as rank 0 plays them, to the last bit: {}", rank,
                            plan.source, word.find(' ') == std::string::npos ? "it has other numbers" : word);
  if (!refused.empty()) throw InputError(refused);
  return workers;
}

void MpiJob::serve(const std::filesystem::path& study) {
  begun_ = true;
  if (!told(false)) return;
  std::unique_ptr<Desk> desk;
  send(set_up(study, desk));
  for (;;) {
    std::uint64_t shard = kNoMore;
    MPI_Recv(&shard, 1, MPI_UINT64_T, 0, kShard, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (shard == kNoMore || desk == nullptr) return;
    send(encode(compute_shard(desk->plan, *desk->model, shard)));
  }
}

}  // namespace palpate::study
