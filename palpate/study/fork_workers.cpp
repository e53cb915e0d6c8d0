// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/study/scratch_folder.hpp>
#include <palpate/study/workers.hpp>
#include <utility>

namespace palpate::study {

namespace {

constexpr int kWait_ms = 200;
constexpr std::uint64_t kLastWord = std::uint64_t{1} << 63U;  // in a size: what follows is why the worker ends

bool send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

std::string_view bytes_of(const std::uint64_t& number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

/// A shard's number comes, its result goes back behind its size; until the parent closes its end.
[[noreturn]] void serve(const Plan& plan, int socket, const std::filesystem::path& scratch) {
  std::filesystem::remove_all(scratch);  // what one before it left may be why that one ended
  std::filesystem::create_directories(scratch);
  const std::unique_ptr<RunModel> model = make_model(plan, scratch);
  std::uint64_t shard = 0;
  while (::recv(socket, &shard, sizeof shard, MSG_WAITALL) == sizeof shard) {
    const std::string result = encode(compute_shard(plan, *model, shard));
    const std::uint64_t size = result.size();
    if (!send_all(socket, bytes_of(size)) || !send_all(socket, result)) break;
  }
  ::_exit(0);
}

std::string describe_end(int status) {
  if (WIFSIGNALED(status)) return fmt::format("killed by signal {}", WTERMSIG(status));
  return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

/// A process and the parent's end of the line to it; it ends with this object.
class Worker {
 public:
  Worker() = default;
  Worker(pid_t process, int socket) : process_(process), socket_(socket) {}
  ~Worker() { end(SIGKILL); }  // what it may still be at is asked for by nobody
  Worker(Worker&& other) noexcept { *this = std::move(other); }
  Worker& operator=(Worker&& other) noexcept {
    std::swap(process_, other.process_);
    std::swap(socket_, other.socket_);
    received.swap(other.received);
    last_word.swap(other.last_word);
    shard.swap(other.shard);
    return *this;
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  int socket() const { return socket_; }
  /// Waits until it has ended; `signal` 0: it does so by itself. What waitpid() says of it.
  int end(int signal) noexcept {
    int status = 0;
    if (process_ > 0) {
      if (signal != 0) ::kill(process_, signal);
      while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
      }
    }
    if (socket_ >= 0) ::close(socket_);
    process_ = socket_ = -1;
    return status;
  }

  std::string received, last_word;
  std::optional<std::uint64_t> shard;  ///< that it was given

 private:
  pid_t process_ = -1;
  int socket_ = -1;
};

class ForkWorkers final : public Workers {
 public:
  ForkWorkers(const Plan& plan, int count, const std::function<void()>& in_child) : plan_(&plan), in_child_(in_child) {
    workers_.resize(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < workers_.size(); ++i) workers_[i] = start(i);
  }

  int count() const override { return static_cast<int>(workers_.size()); }

  void give(int worker, std::uint64_t shard) override {
    Worker& w = workers_[static_cast<std::size_t>(worker)];
    w.shard = shard;
    send_all(w.socket(), bytes_of(shard));  // where it has just ended, wait() finds that out
  }

  WorkerEvent wait() override {
    std::vector<pollfd> sockets;
    for (const Worker& worker : workers_) sockets.push_back({.fd = worker.socket(), .events = POLLIN, .revents = 0});
    if (::poll(sockets.data(), sockets.size(), kWait_ms) <= 0) return {};
    for (std::size_t k = 0; k < sockets.size(); ++k) {
      const std::size_t i = (first_ + k) % sockets.size();  // in turn, so that none waits for the others
      if (sockets[i].revents == 0) continue;
      WorkerEvent event = receive(static_cast<int>(i));
      if (event.kind == WorkerEvent::Kind::kNothing) continue;
      first_ = i + 1;
      return event;
    }
    return {};
  }

 private:
  Worker start(std::size_t number) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      throw InputError(fmt::format("no worker can be started: {}", std::strerror(errno)));
    const pid_t parent = ::getpid();
    const std::filesystem::path scratch = scratch_.path() / std::to_string(number);
    const pid_t process = ::fork();
    if (process == 0) {
      ::close(ends[0]);
      become_worker(parent, ends[1], scratch);
    }
    const int error = errno;
    ::close(ends[1]);
    Worker worker(process, ends[0]);
    if (process < 0) throw InputError(fmt::format("no worker can be started: {}", std::strerror(error)));
    return worker;
  }

  [[noreturn]] void become_worker(pid_t parent, int socket, const std::filesystem::path& scratch) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);  // it ended before the line above
    std::signal(SIGINT, SIG_IGN);           // of the terminal: the parent decides
    if (std::signal(SIGTERM, SIG_DFL) == SIG_IGN) std::signal(SIGTERM, SIG_IGN);
    for (const Worker& other : workers_)
      if (other.socket() >= 0) ::close(other.socket());
    try {
      in_child_();
      serve(*plan_, socket, scratch);
    } catch (const std::exception& error) {
      const std::string_view why = error.what();
      const std::uint64_t size = why.size() | kLastWord;
      send_all(socket, bytes_of(size)) && send_all(socket, why);
      ::_exit(1);
    }
  }

  WorkerEvent receive(int number) {
    Worker& worker = workers_[static_cast<std::size_t>(number)];
    char piece[1 << 16];
    const ssize_t size = ::recv(worker.socket(), piece, sizeof piece, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return {};
    if (size <= 0) return replace(number);
    worker.received.append(piece, static_cast<std::size_t>(size));
    std::uint64_t length = 0;
    if (worker.received.size() < sizeof length) return {};
    std::memcpy(&length, worker.received.data(), sizeof length);
    if (worker.received.size() < sizeof length + (length & ~kLastWord)) return {};
    if ((length & kLastWord) != 0) {
      worker.last_word = worker.received.substr(sizeof length);
      return {};  // its end comes next
    }
    WorkerEvent event{.kind = WorkerEvent::Kind::kResult, .worker = number, .result = {}, .reason = {}};
    event.result = decode(std::string_view(worker.received).substr(sizeof length));
    worker.received.clear();
    worker.shard.reset();
    return event;
  }

  WorkerEvent replace(int number) {
    Worker& worker = workers_[static_cast<std::size_t>(number)];
    const int status = worker.end(0);
    WorkerEvent event{.kind = WorkerEvent::Kind::kLost, .worker = number, .result = {}, .reason = worker.last_word};
    if (event.reason.empty()) event.reason = describe_end(status);
    event.shard = worker.shard.value_or(plan_->shards());  // none: it had nothing to do
    worker = Worker();
    worker = start(static_cast<std::size_t>(number));
    return event;
  }

  const Plan* plan_;
  std::function<void()> in_child_;
  ScratchFolder scratch_;
  std::vector<Worker> workers_;
  std::size_t first_ = 0;
};

}  // namespace

std::unique_ptr<Workers> fork_workers(const Plan& plan, int count, const std::function<void()>& in_child) {
  return std::make_unique<ForkWorkers>(plan, count, in_child);
}

}  // namespace palpate::study
