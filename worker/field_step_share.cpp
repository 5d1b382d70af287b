// What members of a team pass on to each other in a step of FieldStep.
#include <cstring>
#include <stdexcept>

#include "worker/field_step.h"

namespace skyquilt::worker {
namespace {

template <typename T>
void Append(const T* values, size_t n, std::string* bytes) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes->append(reinterpret_cast<const char*>(values), n * sizeof(T));
}

template <typename T>
void Take(const std::string& bytes, size_t* at, T* values, size_t n) {
  if (n * sizeof(T) > bytes.size() - *at)
    throw std::runtime_error("a member of the team has worked on other rays: do all ranks run the same program?");
  std::memcpy(values, bytes.data() + *at, n * sizeof(T));
  *at += n * sizeof(T);
}

}  // namespace

std::string FieldStep::PackShare(const RayBatch& batch, const StepShare& share) const {
  std::string bytes;
  const size_t network_size = slot_gradients_.size() / kGradientSlots;
  for (size_t slot = 0; slot < kGradientSlots; ++slot) {
    if (!share.Mine(slot)) continue;
    Append(slot_gradients_.data() + slot * network_size, network_size, &bytes);
    for (size_t k = slot; k < batch.packets.size(); k += kGradientSlots) {
      const Packet& packet = batch.packets[k];
      const auto live = static_cast<size_t>(results_[k].live);
      const auto begin = static_cast<size_t>(packet.begin);
      Append(&results_[k], 1, &bytes);
      for (int row = 0; row < field_.FeatureRows(); ++row) {
        Append(features_.data() + packet.features + static_cast<size_t>(row) * packet.stride, live, &bytes);
      }
      for (const auto* axis : {&batch.x, &batch.y, &batch.z}) Append(axis->data() + begin, live, &bytes);
      Append(observed_.data() + begin, static_cast<size_t>(packet.count), &bytes);
      if (gain_gradients_.empty()) continue;
      Append(gain_gradients_.data() + packet.first_ray, static_cast<size_t>(packet.n_rays), &bytes);
    }
  }
  return bytes;
}

void FieldStep::UnpackShare(const std::string& bytes, const StepShare& sender, RayBatch& batch) {
  size_t at = 0;
  const size_t network_size = slot_gradients_.size() / kGradientSlots;
  for (size_t slot = 0; slot < kGradientSlots; ++slot) {
    if (!sender.Mine(slot)) continue;
    Take(bytes, &at, slot_gradients_.data() + slot * network_size, network_size);
    for (size_t k = slot; k < batch.packets.size(); k += kGradientSlots) {
      const Packet& packet = batch.packets[k];
      const auto begin = static_cast<size_t>(packet.begin);
      Take(bytes, &at, &results_[k], 1);
      if (results_[k].live < 0 || results_[k].live > packet.count) throw std::runtime_error("a member of the team has worked on other rays");
      const auto live = static_cast<size_t>(results_[k].live);
      for (int row = 0; row < field_.FeatureRows(); ++row) {
        Take(bytes, &at, features_.data() + packet.features + static_cast<size_t>(row) * packet.stride, live);
      }
      for (auto* axis : {&batch.x, &batch.y, &batch.z}) Take(bytes, &at, axis->data() + begin, live);
      Take(bytes, &at, observed_.data() + begin, static_cast<size_t>(packet.count));
      if (gain_gradients_.empty()) continue;
      Take(bytes, &at, gain_gradients_.data() + packet.first_ray, static_cast<size_t>(packet.n_rays));
    }
  }
  if (at != bytes.size()) throw std::runtime_error("a member of the team has worked on other rays");
}

void FieldStep::PassOn(RayBatch& batch, const StepShare& share) {
  const std::vector<std::string> all = share.exchange(PackShare(batch, share));
  for (int number = 0; number < share.members; ++number) {
    if (number != share.number) UnpackShare(all.at(static_cast<size_t>(number)), {share.members, number, {}}, batch);
  }
}

}  // namespace skyquilt::worker
