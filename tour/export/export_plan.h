// What goes into an exported tour, with its size, before anything is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tour/export/export_parts.h"
#include "tour/export/export_tour.h"
#include "tour/export/packed_pictures.h"
#include "tour/export/tile_tree.h"
#include "tour/format/read_tour.h"

namespace skyquilt::tour {

// The tour with what it refers to. Assets count as there when their digest is right and CheckAsset accepts them, as it would an upload.
struct TourContent {
  std::string tour_json;  // as it is saved
  PlayableTour playable;
  std::vector<std::string> assets;  // names of files that are used, each once
};
// Throws base::InputError when there is no tour, or it is damaged or has no stops.
TourContent ReadContent(const std::filesystem::path& project);

// Files that a tour has in any case, by name below data/: their content, or the file that has it.
struct FixedFiles {
  std::map<std::string, std::string> contents;
  std::map<std::string, std::filesystem::path> files;

  int64_t Bytes() const;
};
// Buildings are left out, with a warning, where they would take more than an eighth of the limit.
FixedFiles CollectFixedFiles(const ExportInput& input, const ExportParts& parts, const TourContent& content);

struct ExportPlan {
  PicturePlan pictures;
  std::optional<TileTree::Choice> tiles;  // none: there is no surface
  int64_t bytes = 0;                      // of everything
};
// other_bytes: of everything but pictures and tiles. tree: null without a surface. Throws base::InputError, naming `out` and the size that is needed,
// when not even the least fits.
ExportPlan PlanExport(const std::filesystem::path& out, int64_t limit_bytes, int64_t other_bytes, std::span<const StopPictures> pictures,
                      const TileTree* tree, const Tour& tour, base::ThreadPool& threads);

}  // namespace skyquilt::tour
