// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <palpate/http/server.hpp>
#include <palpate/service/page_row.hpp>
#include <vector>

namespace palpate::service {

/// What the pages hear that look on: the greeting, the past, rows of the catheter that each of them watches, health,
/// events. Lives on the network's thread; the web server has one of its own.
class Page {
 public:
  /// To a client, from this thread.
  using Send = std::function<void(http::ClientId, http::Message)>;

  /// `settings` and `views` outlive this; `truths` has one entry a catheter, null where nothing is known.
  Page(const Settings& settings, const std::vector<CatheterView>& views, std::vector<const PlayedTruth*> truths,
       Send send);

  // What comes from the web server.
  void opened(http::ClientId client, std::int64_t now_ns);
  void text(http::ClientId client, const std::string& text, std::int64_t now_ns);
  void closed(http::ClientId client) { clients_.erase(client); }

  // What comes from the observer.
  /// The view has taken this record.
  void take(std::size_t catheter, const session::LiveRecord& record, std::int64_t now_ns);
  void take_event(const session::LiveRecord& event);
  void set_catheter(std::size_t catheter);

  /// By the clock: rows that were held back, and the health where it is due or a state has changed.
  void look(std::int64_t now_ns, const std::function<nlohmann::json()>& health);

 private:
  struct Shown {
    LiveFigures figures;
    PageHistory past;
    PageRowMaker maker;
    bool any = false, news = false;
    bool told_stale = false;
    std::int64_t due_ns = 0;
    LiveState said = LiveState::kWaiting;
  };
  struct Client {
    std::size_t watches = 0;
    bool wants_past = true;
    std::int64_t past_due_ns = 0;  ///< it is large: twice a second at most
  };
  nlohmann::json greeting(std::int64_t now_ns) const;
  void send_past(http::ClientId id, Client& client, std::int64_t now_ns);
  void send_row(std::size_t catheter, std::int64_t now_ns);
  bool watched(std::size_t catheter) const;
  void send_all(const nlohmann::json& data);

  const Settings& settings_;
  const std::vector<CatheterView>& views_;
  std::vector<const PlayedTruth*> truths_;
  std::vector<Shown> shown_;
  Send send_;
  std::map<http::ClientId, Client> clients_;
  std::int64_t health_due_ns_ = 0;
};

}  // namespace palpate::service
