// Holds the fields of a scene file in memory, so that a scene larger than memory can be rendered: all fields when they fit, otherwise those that are
// needed at the time. Not thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/render/trained_field.h"

namespace skyquilt::scene {

class FieldStore {
 public:
  // Reads only the descriptions of the fields. memory_bytes: limit for the fields in memory; 0: no limit. hard_borders: blocks are not blended.
  // Throws base::InputError for a damaged file.
  FieldStore(checkpoint::ArchiveReader reader, const std::filesystem::path& file, double memory_bytes, bool hard_borders);

  int size() const { return static_cast<int>(entries_.size()); }  // number of blocks
  bool HasContext() const { return has_context_; }
  // Block 0 <= k < size(); without arrays unless IsLoaded(k). The reference stays valid, but EnsureLoaded changes the field.
  const render::TrainedField& block(int k) const { return *entries_[static_cast<size_t>(k)].field; }
  std::vector<const render::TrainedField*> Blocks() const;
  const render::TrainedField& context() const { return *context_.field; }
  bool IsLoaded(int k) const { return entries_[static_cast<size_t>(k)].loaded; }
  int64_t Parameters(int k) const { return entries_[static_cast<size_t>(k)].parameters; }
  int64_t ContextParameters() const { return context_.parameters; }
  // Size in memory when loaded.
  double Bytes(int k) const { return entries_[static_cast<size_t>(k)].bytes; }
  double ContextBytes() const { return context_.bytes; }
  // Whether all fields fit in memory together.
  bool AllFit() const;

  // Loads these blocks and the context. Unloads other blocks as far as memory requires, least recently used first. Not while rays are rendered.
  // Throws base::UsageError when these blocks and the context alone exceed the memory, base::InputError for a damaged file.
  void EnsureLoaded(std::span<const int> blocks);
  void EnsureAllLoaded();

  int64_t loads() const { return loads_; }         // fields loaded so far; when it is unchanged, so are the loaded fields
  double loaded_bytes() const { return in_use_; }  // in memory now
  double peak_bytes() const { return most_; }      // peak so far

 private:
  struct Entry {
    std::string prefix;
    std::unique_ptr<render::TrainedField> field;  // with arrays when loaded
    int64_t parameters = 0;
    double bytes = 0.0;
    bool loaded = false;
    int64_t used = 0;  // number of the last EnsureLoaded call that needed it
  };
  Entry ReadDescription(const std::string& prefix) const;
  void Load(Entry* entry);
  void Unload(Entry* entry);

  checkpoint::ArchiveReader reader_;
  std::filesystem::path file_;
  double memory_bytes_;
  bool hard_borders_;
  std::vector<Entry> entries_;
  Entry context_;
  bool has_context_ = false;
  int64_t calls_ = 0;
  int64_t loads_ = 0;
  double in_use_ = 0.0;
  double most_ = 0.0;
};

}  // namespace skyquilt::scene
