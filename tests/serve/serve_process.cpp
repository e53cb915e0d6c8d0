// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>  // before Asio, which forgets it
//
#include <boost/asio/ip/tcp.hpp>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <tests/serve/eventually.hpp>
#include <tests/serve/serve_process.hpp>

namespace palpate::serve_test {
namespace {

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return (std::ostringstream() << stream.rdbuf()).str();
}

/// Never returns: between fork and exec only calls that are safe there.
[[noreturn]] void become(char* const* arguments, const char* folder, const char* out, const char* err) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::close_range(3, ~0U, 0);  // the library's sockets would live on in the program
  const int out_descriptor = ::open(out, kFlags, 0600), err_descriptor = ::open(err, kFlags, 0600);
  if (::dup2(out_descriptor, 1) >= 0 && ::dup2(err_descriptor, 2) >= 0 && ::chdir(folder) == 0)
    ::execv(arguments[0], arguments);
  ::_exit(127);
}

std::string request(const std::string& method, const std::string& target, const std::string& token,
                    const std::string& body) {
  return method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\nAuthorization: Bearer " + token +
         "\r\n" + "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
         body;
}

nlohmann::json answer(int port, const std::string& text) {
  boost::asio::ip::tcp::iostream stream;
  stream.expires_after(std::chrono::seconds(5));
  stream.connect(
      boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)));
  stream << text << std::flush;
  const std::string all = (std::ostringstream() << stream.rdbuf()).str();
  const std::size_t body = all.find("\r\n\r\n");
  if (body == std::string::npos) throw std::runtime_error("the control interface does not answer: " + all);
  nlohmann::json out = nlohmann::json::parse(all.substr(body));
  out["http"] = std::stoi(all.substr(9, 3));
  return out;
}

}  // namespace

ServeProcess::ServeProcess(const std::filesystem::path& folder, const std::vector<std::string>& arguments)
    : out_(folder / "serve.out"), err_(folder / "serve.err") {
  std::vector<std::string> words{PALPATE_BINARY, "serve", "--json"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::filesystem::remove(out_);
  pid_ = ::fork();
  if (pid_ == 0) become(pointers.data(), folder.c_str(), out_.c_str(), err_.c_str());
  const bool said =
      pid_ > 0 && eventually([&] { return contents(out_).find('\n') != std::string::npos || !running(); }, 20.0);
  const std::string line = contents(out_);
  if (said && !line.empty()) ports_ = nlohmann::json::parse(line.substr(0, line.find('\n')));
  if (ports_.is_null()) {
    signal(SIGKILL);
    wait(5.0);
    throw std::runtime_error("palpate serve did not start: " + err());
  }
}

ServeProcess::~ServeProcess() {
  signal(SIGKILL);
  wait(10.0);
}

nlohmann::json ServeProcess::health() const {
  return answer(dashboard_port(), request("GET", "/api/health", token(), ""));
}

nlohmann::json ServeProcess::post(const std::string& path, const nlohmann::json& body) const {
  return answer(dashboard_port(), request("POST", path, token(), body.dump()));
}

void ServeProcess::signal(int number) const {
  if (pid_ > 0) ::kill(pid_, number);
}

bool ServeProcess::running() {
  int status = 0;
  if (pid_ <= 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return pid_ > 0;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  pid_ = -1;
  return false;
}

int ServeProcess::wait(double longest_s) {
  return eventually([&] { return !running(); }, longest_s) ? exit_code_ : -1;
}

nlohmann::json ServeProcess::summary() const {
  std::istringstream lines(contents(out_));
  std::string line, last;
  while (std::getline(lines, line)) last = line;
  return nlohmann::json::parse(last);
}

std::string ServeProcess::err() const { return contents(err_); }

std::size_t ServeProcess::descriptors() const {
  const std::filesystem::path folder = "/proc/" + std::to_string(pid_) + "/fd";
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

std::size_t ServeProcess::threads() const {
  const std::filesystem::path folder = "/proc/" + std::to_string(pid_) + "/task";
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

double ServeProcess::memory_MB() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/statm");
  double pages = 0.0, resident = 0.0;
  file >> pages >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

double ServeProcess::cpu_s() const {
  const std::string text = contents("/proc/" + std::to_string(pid_) + "/stat");
  std::istringstream fields(text.substr(text.rfind(')') + 2));  // the name may hold spaces
  std::string skipped;
  double user = 0.0, system = 0.0;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace palpate::serve_test
