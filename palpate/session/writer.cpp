// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <palpate/math/errors.hpp>
#include <palpate/session/queued_record.hpp>
#include <palpate/session/ring.hpp>
#include <palpate/session/session_file.hpp>
#include <palpate/session/writer.hpp>
#include <thread>

namespace palpate::session {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kRetry{200}, kSlow{800}, kFlush{2000}, kGrace{500};
void check(const WriterOptions& options) {
  if (!(options.batch_s >= 0.01 && options.batch_s <= 10.0))
    throw InputError(fmt::format("batch_s = {}: expected seconds from 0.01 to 10", options.batch_s));
  if (options.queue < 64 || options.queue > 1048576)
    throw InputError(fmt::format("queue = {}: expected 64 to 1048576 records", options.queue));
}

}  // namespace

class SessionWriter::Work {
 public:
  Work(const std::filesystem::path& path, const std::vector<SessionCatheter>& catheters, const WriterOptions& options)
      : file_(path, catheters, options),
        ring_(options.queue, roomy_record(catheters)),
        batch_(milliseconds(static_cast<int>(1e3 * options.batch_s))),
        most_in_batch_(std::clamp<std::size_t>(ring_.capacity() / 4, 16, 4096)) {}

  static void start(const std::shared_ptr<Work>& work) {
    work->thread_ = std::thread([work] { work->run(); });
  }

  bool offer(const LiveRecord& record) {
    QueuedRecord* slot = ring_.free_slot();
    if (slot != nullptr && drops_.count > 0) {
      fill(slot->record, drops_);
      slot->counts = false;
      ring_.push();
      drops_ = {};
      slot = ring_.free_slot();
    }
    if (slot == nullptr) {
      drop(record);
      return false;
    }
    fill(slot->record, record);
    slot->counts = true;
    offered_.fetch_add(1, std::memory_order_relaxed);
    ring_.push();
    return true;
  }
  void drop(const LiveRecord& record) noexcept {
    drops_.add(record.received_ns);
    dropped_.fetch_add(1, std::memory_order_relaxed);
  }

  WriterHealth health() const;
  void stop() noexcept;

 private:
  void run() noexcept;
  bool wait();
  bool write_some();
  void write(std::size_t count);
  void count_as_committed(std::size_t count);
  void write_last_drops();
  void set_error(const std::string& error);

  SessionFile file_;
  Ring<QueuedRecord> ring_;
  Clock::duration batch_;
  std::size_t most_in_batch_;
  Drops drops_;               ///< of the offering thread; after stop() of the writing one
  std::size_t to_retry_ = 0;  ///< records of the batch that failed: it is tried again as it was
  QueuedRecord last_;

  std::atomic<std::uint64_t> offered_{0}, dropped_{0}, committed_{0}, committed_frames_{0};
  std::atomic<Clock::rep> writing_since_{0};  ///< 0: not at it
  mutable std::mutex mutex_;                  ///< of what follows
  std::condition_variable wake_;
  std::string error_;
  bool stopping_ = false, done_ = false;
  Clock::time_point deadline_{};
  std::thread thread_;
};

WriterHealth SessionWriter::Work::health() const {
  WriterHealth health;
  health.offered = offered_.load();
  health.dropped = dropped_.load();
  health.committed_frames = committed_frames_.load();
  health.committed = committed_.load();
  const Clock::rep since = writing_since_.load();
  {
    const std::scoped_lock lock(mutex_);
    health.error = error_;
  }
  const Clock::duration lasts =
      since == 0 ? Clock::duration{0} : Clock::now().time_since_epoch() - Clock::duration{since};
  if (health.error.empty() && lasts > kSlow)
    health.error = fmt::format("the disk has not answered for {:.1f} s", std::chrono::duration<double>(lasts).count());
  health.failing = !health.error.empty();
  return health;
}

void SessionWriter::Work::set_error(const std::string& error) {
  const std::scoped_lock lock(mutex_);
  error_ = error;
}

/// Until a batch is due; true: the writer is to end.
bool SessionWriter::Work::wait() {
  const auto slice = std::clamp<Clock::duration>(batch_ / 4, milliseconds(2), milliseconds(20));
  const Clock::time_point due = Clock::now() + (to_retry_ > 0 ? Clock::duration(kRetry) : batch_);
  std::unique_lock lock(mutex_);
  while (!stopping_ && Clock::now() < due) {
    wake_.wait_for(lock, slice);
    if (to_retry_ == 0 && ring_.size() >= most_in_batch_) break;
  }
  if (stopping_ && to_retry_ > 0) wake_.wait_for(lock, slice);
  return stopping_;
}

void SessionWriter::Work::run() noexcept {
  bool stopping = false;
  while (!stopping) {
    stopping = wait();
    while (write_some() && ring_.size() >= (stopping ? 1 : most_in_batch_ / 2)) {
    }
    if (stopping && to_retry_ > 0) stopping = Clock::now() >= deadline_;
  }
  if (to_retry_ == 0) write_last_drops();
  file_.close();
  const std::scoped_lock lock(mutex_);
  done_ = true;
  wake_.notify_all();
}

/// One batch; false: there was none, or it failed.
bool SessionWriter::Work::write_some() {
  const std::size_t waiting = ring_.size();
  const std::size_t count = to_retry_ > 0 ? to_retry_ : std::min(waiting, most_in_batch_);
  if (count == 0) return false;
  writing_since_.store(Clock::now().time_since_epoch().count());
  bool written = false;
  try {
    if (to_retry_ == 0 || !file_.committed_after_all()) write(count);
    written = true;
    set_error({});
  } catch (const std::exception& error) {
    file_.roll_back();
    set_error(error.what());
  }
  writing_since_.store(0);
  to_retry_ = written ? 0 : count;
  if (written) count_as_committed(count);
  return written;
}

void SessionWriter::Work::write(std::size_t count) {
  file_.begin();
  for (std::size_t i = 0; i < count; ++i) file_.put(ring_.front(i)->record);
  file_.commit();
}

void SessionWriter::Work::count_as_committed(std::size_t count) {
  std::uint64_t records = 0, frames = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const QueuedRecord& slot = *ring_.front(i);
    records += slot.counts ? 1 : 0;
    frames += slot.record.kind == LiveRecord::Kind::kFrame ? 1 : 0;
  }
  ring_.pop(count);
  committed_frames_.fetch_add(frames);
  committed_.fetch_add(records);
}

/// What was dropped after the last record that found room.
void SessionWriter::Work::write_last_drops() {
  if (drops_.count == 0) return;
  try {
    fill(last_.record, drops_);
    file_.begin();
    file_.put(last_.record);
    file_.commit();
  } catch (const std::exception& error) {
    file_.roll_back();
    set_error(error.what());
  }
}

void SessionWriter::Work::stop() noexcept {
  if (!thread_.joinable()) return;
  std::unique_lock lock(mutex_);
  deadline_ = Clock::now() + kFlush;
  stopping_ = true;
  wake_.notify_all();
  const bool done = wake_.wait_for(lock, kFlush + kGrace, [&] { return done_; });
  lock.unlock();
  if (done)
    thread_.join();
  else
    thread_.detach();  // the disk holds it: it ends when that answers, or with the process
}

SessionWriter::SessionWriter(const std::filesystem::path& path, const std::vector<SessionCatheter>& catheters,
                             const WriterOptions& options) {
  check(options);
  work_ = std::make_shared<Work>(path, catheters, options);
  Work::start(work_);
}

SessionWriter::~SessionWriter() { close(); }

bool SessionWriter::offer(const LiveRecord& record) noexcept {
  try {
    return work_->offer(record);
  } catch (const std::bad_alloc&) {
    work_->drop(record);
    return false;
  }
}

WriterHealth SessionWriter::health() const { return work_->health(); }

WriterHealth SessionWriter::close() noexcept {
  work_->stop();
  return work_->health();
}

}  // namespace palpate::session
