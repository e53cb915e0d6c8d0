// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <boost/asio/post.hpp>
#include <palpate/http/hub.hpp>

namespace palpate::http {

namespace {

double watch_period_s(const ServerTimes& times) {
  return std::clamp(0.05 * std::min(times.request_s, times.stuck_s), 0.005, 0.25);
}

}  // namespace

Hub::Hub(ServerOptions settings, Server::Handler answers, ClientEvents clients)
    : options(std::move(settings)), handler(std::move(answers)), events(std::move(clients)) {}

bool Hub::admit(const std::shared_ptr<Member>& member) {
  if (members_.size() >= options.most_connections) {
    count([](ServerHealth& health) { ++health.refused; });
    const auto oldest = std::ranges::find_if(members_, [](const auto& each) { return !each->known; });
    if (oldest == members_.end()) return false;
    const std::shared_ptr<Member> leaves = *oldest;
    leaves->close();
  }
  members_.push_back(member);
  count([](ServerHealth& health) { ++health.accepted; });
  count_members();
  return true;
}

void Hub::forget(const Member* member) {
  std::erase_if(members_, [&](const auto& each) { return each.get() == member; });
  count_members();
}

void Hub::replace(const Member* old, const std::shared_ptr<Member>& member) {
  const auto place = std::ranges::find_if(members_, [&](const auto& each) { return each.get() == old; });
  if (place != members_.end()) *place = member;
}

void Hub::count_members() {
  count([this](ServerHealth& health) {
    health.connections = members_.size();
    health.clients = clients_.size();
  });
}

ClientId Hub::add_client(const std::shared_ptr<Client>& client) {
  clients_[++latest_client_] = client;
  count_members();
  return latest_client_;
}

void Hub::remove_client(ClientId client) {
  clients_.erase(client);
  count_members();
}

void Hub::deliver(ClientId client, Message message) {
  {
    const std::lock_guard lock(inbox_mutex_);
    if (closed_ || !message.bytes) return;
    if (message.droppable && inbox_.size() >= kMostUnread) {
      count([](ServerHealth& health) { ++health.dropped; });
      return;
    }
    inbox_.emplace_back(client, std::move(message));
    if (inbox_.size() > 1) return;  // it has been told
  }
  boost::asio::post(io, [this] { hand_out(); });
}

void Hub::hand_out() {
  std::vector<std::pair<ClientId, Message>> messages;
  {
    const std::lock_guard lock(inbox_mutex_);
    messages.swap(inbox_);
  }
  for (auto& [client, message] : messages) {
    const auto found = clients_.find(client);
    if (found == clients_.end()) continue;
    const std::shared_ptr<Client> keep = found->second;  // one that overflows leaves the map
    keep->send(std::move(message));
  }
}

ServerHealth Hub::health() const {
  const std::lock_guard lock(health_mutex_);
  return health_;
}

void Hub::watch() {
  watch_.expires_at(in_seconds(watch_period_s(options.times)));
  watch_.async_wait([this](const boost::system::error_code& error) {
    if (error || ended_) return;    // one that was due when it was cancelled comes without an error
    const auto members = members_;  // one that is closed leaves
    for (const auto& member : members)
      if (member->deadline < Clock::now()) member->overdue();
    watch();
  });
}

void Hub::close_all() {
  {
    const std::lock_guard lock(inbox_mutex_);
    closed_ = true;
    inbox_.clear();
  }
  ended_ = true;
  watch_.cancel();
  const auto members = members_;
  for (const auto& member : members) member->close();
}

}  // namespace palpate::http
