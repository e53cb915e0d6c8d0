// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <palpate/http/server.hpp>
#include <palpate/link/server.hpp>
#include <palpate/service/link_output.hpp>
#include <palpate/service/link_source.hpp>
#include <palpate/service/ndi_source.hpp>
#include <palpate/service/network_sink.hpp>
#include <palpate/service/operator.hpp>
#include <palpate/service/page.hpp>
#include <palpate/service/reels.hpp>
#include <palpate/service/service.hpp>
#include <palpate/service/standard_input.hpp>
#include <thread>

namespace palpate::service {

/// To the recording.
class RecorderSink final : public RecordSink {
 public:
  explicit RecorderSink(session::SessionWriter& writer) : writer_(writer) {}
  void offer(const session::LiveRecord& record) noexcept override { writer_.offer(record); }

 private:
  session::SessionWriter& writer_;
};

/// What a service is made of: service.cpp puts it together, service_run.cpp makes it go, service_health.cpp tells of
/// it.
struct Service::Parts {
  explicit Parts(Settings what);
  ~Parts();
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  // What there is. Destroyed from the bottom up: whoever is used comes before whoever uses it.
  Settings settings;
  HostClock clock;
  boost::asio::io_context io{1};
  std::deque<LiveCatheter> catheters;
  std::vector<CatheterView> views;
  std::vector<LinkOutput> outputs;
  std::optional<session::SessionWriter> writer;
  std::optional<RecorderSink> recorder;
  NetworkSink network;
  std::vector<RecordSink*> sinks;
  std::optional<ObserverLoop> loop;
  std::optional<Operator> operators;
  std::deque<LinkSource> links;
  std::optional<Player> player;
  std::optional<StandardInput> input;
  std::deque<NdiSource> auroras;
  std::optional<link::Server> server;
  std::deque<PlayedTruth> truths;  // one a catheter; empty where nothing is known
  std::optional<Page> page;
  std::optional<http::Server> web;
  boost::asio::posix::stream_descriptor network_ready{io};
  boost::asio::steady_timer tick{io}, look_timer{io};
  boost::asio::signal_set signals{io};
  std::function<void()> look;
  std::atomic<int> playing{0};        // finite sources that have not ended
  std::vector<std::string> refusals;  // what the system does not grant
  std::uint64_t strangers = 0;        // refused at the dashboard's port, as far as that was told
  std::int64_t strangers_due_ns = 0;
  std::string input_error;  // written before `playing` falls
  bool goes_on = false;     // a source that has no end
  std::thread observer_thread, player_thread, input_thread, web_thread;
  std::vector<std::thread> aurora_threads;

  void add_catheter(const CatheterSettings& each);
  void make_servers();
  void make_page();
  void make_loop();
  void make_sources(std::vector<Reel> reels);
  void make_links();
  void make_auroras();
  void make_input(int index);

  void start();
  void stop();
  void finish();
  void wait_for_records();
  void drain();
  void tick_later();
  void look_later();
  void answer(const http::Request& request, const http::Server::Reply& reply);
  void refuse(const std::string& why);
  void tell_of_strangers();
  void say(const std::string& event, const nlohmann::json& data, int catheter = -1);
  nlohmann::json health() const;
};

}  // namespace palpate::service
