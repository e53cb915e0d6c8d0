// SPDX-License-Identifier: Apache-2.0
#include <utility>  // before Beast, which forgets it
//
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <tests/serve/page_client.hpp>
#include <tests/serve/serve_process.hpp>
#include <thread>

namespace palpate::serve_test {

namespace asio = boost::asio;
namespace beast = boost::beast;

namespace {

double utc_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

struct PageClient::Parts {
  explicit Parts(const ServeProcess& program) {
    socket.next_layer().connect(
        {asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(program.dashboard_port())});
    socket.set_option(beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
      request.set(beast::http::field::authorization, "Bearer " + program.token());
    }));
    socket.handshake("127.0.0.1:" + std::to_string(program.dashboard_port()), "/live");
    thread = std::thread([this] { read(); });
  }
  ~Parts() {
    boost::system::error_code ignored;
    socket.next_layer().shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
    thread.join();
  }

  void read() {
    beast::flat_buffer buffer;
    boost::system::error_code error;
    while (true) {
      buffer.clear();
      socket.read(buffer, error);
      const std::lock_guard lock(mutex);
      if (error) {
        closed = true;
        return;
      }
      const std::string bytes = beast::buffers_to_string(buffer.data());
      socket.got_text() ? take_text(bytes) : take_numbers(bytes);
    }
  }
  void take_text(const std::string& bytes) {
    texts.push_back(nlohmann::json::parse(bytes));
    if (texts.back()["type"] == "hello") hello = texts.back();
  }
  void take_numbers(const std::string& bytes) {
    std::vector<double> numbers(bytes.size() / sizeof(double));
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    if (numbers.at(0) != 1.0) return;
    ++rows;
    row.assign(numbers.begin() + 2, numbers.end());
    latencies_s.push_back(1e-3 * (utc_ms() - at("received_ms")));
  }
  double at(const std::string& field) const {
    std::size_t place = 0;
    for (const auto& each : hello.at("row")) {
      if (each.at("name") == field) return row.at(place);
      place += each.at("count").get<std::size_t>();
    }
    throw std::runtime_error("no such field: " + field);
  }

  asio::io_context io;
  beast::websocket::stream<asio::ip::tcp::socket> socket{io};
  std::thread thread;
  std::mutex mutex;
  bool closed = false;
  nlohmann::json hello;
  std::vector<nlohmann::json> texts;
  std::size_t rows = 0;
  std::vector<double> row, latencies_s;
};

PageClient::PageClient(const ServeProcess& program) : parts_(std::make_unique<Parts>(program)) {}
PageClient::~PageClient() = default;

void PageClient::say(const nlohmann::json& data) { parts_->socket.write(asio::buffer(data.dump())); }

bool PageClient::closed() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->closed;
}

nlohmann::json PageClient::hello() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->hello;
}

std::size_t PageClient::rows() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->rows;
}

double PageClient::latest(const std::string& field) const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->at(field);
}

std::vector<double> PageClient::latencies_s() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->latencies_s;
}

std::vector<nlohmann::json> PageClient::texts(const std::string& type) const {
  const std::lock_guard lock(parts_->mutex);
  std::vector<nlohmann::json> out;
  for (const auto& text : parts_->texts)
    if (text.at("type") == type) out.push_back(text);
  return out;
}

}  // namespace palpate::serve_test
