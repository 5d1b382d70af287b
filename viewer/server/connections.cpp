#include "viewer/server/connections.h"

#include <algorithm>
#include <utility>

namespace skyquilt::viewer::server {

ConnectionSlot::~ConnectionSlot() {
  if (connections_ != nullptr) connections_->entries_.erase(id_);
}

void ConnectionSlot::Set(Standing standing) {
  const auto found = connections_->entries_.find(id_);
  if (found != connections_->entries_.end()) found->second.standing = standing;
}

void ConnectionSlot::SetClose(std::function<void()> close) {
  const auto found = connections_->entries_.find(id_);
  if (found != connections_->entries_.end()) found->second.close = std::move(close);
}

std::optional<ConnectionSlot> Connections::Admit(std::function<void()> close) {
  if (entries_.size() >= max_ && !CloseOne()) return {};
  const uint64_t id = next_id_++;
  entries_[id].close = std::move(close);
  return std::make_optional<ConnectionSlot>(*this, id);
}

bool Connections::CloseOne() {
  for (const Standing standing : {Standing::kStranger, Standing::kWaiting}) {
    const auto found = std::find_if(entries_.begin(), entries_.end(), [standing](const auto& entry) { return entry.second.standing == standing; });
    if (found == entries_.end()) continue;
    // Taken out first: close() may end in the slot's destructor.
    const auto close = std::move(found->second.close);
    entries_.erase(found);
    close();
    return true;
  }
  return false;
}

void Connections::CloseAll() {
  const auto entries = std::exchange(entries_, {});
  for (const auto& [id, entry] : entries) entry.close();
}

}  // namespace skyquilt::viewer::server
