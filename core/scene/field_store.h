// The fields of a scene file, held in memory as far as they fit: all of them if they do, otherwise those that are asked for.
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
  // Reads descriptions only. `memory_bytes` bounds the fields in memory; 0: no bound. With hard borders blocks do not blend.
  // Throws base::InputError for a damaged file.
  FieldStore(checkpoint::ArchiveReader reader, const std::filesystem::path& file, double memory_bytes, bool hard_borders);

  int size() const { return static_cast<int>(entries_.size()); }  // blocks
  bool HasContext() const { return has_context_; }
  // Blocks 0 to size() - 1. Without arrays unless IsLoaded. The reference stays good; what it refers to changes with EnsureLoaded.
  const render::TrainedField& block(int k) const { return *entries_[static_cast<size_t>(k)].field; }
  std::vector<const render::TrainedField*> Blocks() const;
  const render::TrainedField& context() const { return *context_.field; }
  bool IsLoaded(int k) const { return entries_[static_cast<size_t>(k)].loaded; }
  int64_t Parameters(int k) const { return entries_[static_cast<size_t>(k)].parameters; }
  int64_t ContextParameters() const { return context_.parameters; }
  // In memory once loaded.
  double Bytes(int k) const { return entries_[static_cast<size_t>(k)].bytes; }
  double ContextBytes() const { return context_.bytes; }
  // Whether everything fits at once.
  bool AllFit() const;

  // Loads these blocks and the context, and drops others, the longest unused first, as far as they must go. Not while somebody renders.
  // Throws base::UsageError when they alone exceed the memory, base::InputError for a damaged file.
  void EnsureLoaded(std::span<const int> blocks);
  void EnsureAllLoaded();

  int64_t loads() const { return loads_; }         // of fields so far; grows whenever what is loaded changes
  double loaded_bytes() const { return in_use_; }  // in memory now
  double most_bytes() const { return most_; }      // at any time so far

 private:
  struct Entry {
    std::string prefix;
    std::unique_ptr<render::TrainedField> field;  // with arrays when loaded
    int64_t parameters = 0;
    double bytes = 0.0;
    bool loaded = false;
    int64_t used = 0;  // number of the last EnsureLoaded that named it
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
