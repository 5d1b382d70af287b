#include "core/scene/field_store.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/scene/field_file.h"
#include "core/scene/scene_file.h"

namespace skyquilt::scene {

FieldStore::FieldStore(checkpoint::ArchiveReader reader, const std::filesystem::path& file, double memory_bytes, bool hard_borders)
    : reader_(std::move(reader)), file_(file), memory_bytes_(memory_bytes), hard_borders_(hard_borders) {
  const int64_t n_blocks = reader_.IntAttribute("blocks");
  for (int64_t i = 0; i < n_blocks; ++i) entries_.push_back(ReadDescription(BlockPrefix(i)));
  has_context_ = reader_.HasAttribute(std::string(kContextPrefix) + "name");
  if (has_context_) context_ = ReadDescription(kContextPrefix);
}

FieldStore::Entry FieldStore::ReadDescription(const std::string& prefix) const {
  Entry entry;
  entry.prefix = prefix;
  entry.field = std::make_unique<render::TrainedField>(GetDescription(reader_, file_, prefix));
  if (hard_borders_) entry.field->blend_m = 0.0;
  entry.parameters = StoredParameterCount(reader_, prefix);
  entry.bytes = 4.0 * static_cast<double>(ParameterCountOf(*entry.field)) + static_cast<double>(StoredCellCount(reader_, prefix));
  return entry;
}

std::vector<const render::TrainedField*> FieldStore::Blocks() const {
  std::vector<const render::TrainedField*> blocks;
  for (const Entry& entry : entries_) blocks.push_back(entry.field.get());
  return blocks;
}

bool FieldStore::AllFit() const {
  double bytes = context_.bytes;
  for (const Entry& entry : entries_) bytes += entry.bytes;
  return !(memory_bytes_ > 0.0) || bytes <= memory_bytes_;
}

void FieldStore::Load(Entry* entry) {
  render::TrainedField field = GetField(reader_, file_, entry->prefix);
  field.occupancy.tau = {};  // for training only
  field.blend_m = entry->field->blend_m;
  *entry->field = std::move(field);
  entry->loaded = true;
  in_use_ += entry->bytes;
  most_ = std::max(most_, in_use_);
  ++loads_;
}

void FieldStore::Unload(Entry* entry) {
  const double blend_m = entry->field->blend_m;
  *entry->field = GetDescription(reader_, file_, entry->prefix);
  entry->field->blend_m = blend_m;
  entry->loaded = false;
  in_use_ -= entry->bytes;
}

void FieldStore::EnsureLoaded(std::span<const int> blocks) {
  ++calls_;
  double missing = has_context_ && !context_.loaded ? context_.bytes : 0.0;
  double together = context_.bytes;
  for (const int k : blocks) {
    Entry& entry = entries_[static_cast<size_t>(k)];
    entry.used = calls_;
    together += entry.bytes;
    if (!entry.loaded) missing += entry.bytes;
  }
  if (memory_bytes_ > 0.0) {
    if (together > memory_bytes_) {
      throw base::UsageError(file_.string() + ": rendering needs " + std::to_string(blocks.size()) + " blocks and the context in memory together, " +
                             base::FormatCount(together) + "B, but a rank may use " + base::FormatCount(memory_bytes_) +
                             "B: raise --memory, or use fewer ranks on one machine");
    }
    while (in_use_ + missing > memory_bytes_) {
      Entry* oldest = nullptr;
      for (Entry& entry : entries_) {
        if (entry.loaded && entry.used != calls_ && (oldest == nullptr || entry.used < oldest->used)) oldest = &entry;
      }
      SKYQUILT_CHECK(oldest != nullptr, "nothing left to unload");
      Unload(oldest);
    }
  }
  if (has_context_ && !context_.loaded) Load(&context_);
  for (const int k : blocks) {
    if (!entries_[static_cast<size_t>(k)].loaded) Load(&entries_[static_cast<size_t>(k)]);
  }
}

void FieldStore::EnsureAllLoaded() {
  std::vector<int> all(entries_.size());
  std::iota(all.begin(), all.end(), 0);
  EnsureLoaded(all);
}

}  // namespace skyquilt::scene
