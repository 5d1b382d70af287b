#include "surface/surface_table.h"

#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::surface {
namespace {

template <typename Value>
Value ReadNumber(const std::filesystem::path& file, const char* key) {
  try {
    return base::ParseJson(base::ReadFile(file)).at(key).get<Value>();
  } catch (const nlohmann::json::exception&) {
    throw base::InputError(file, "is damaged", "Run 'skyquilt surface' again with --restart");
  }
}

}  // namespace

double ReadVoxel(const std::filesystem::path& file) {
  return ReadNumber<double>(file, "voxel_m");
}

int64_t ReadTriangles(const std::filesystem::path& file) {
  return ReadNumber<int64_t>(file, "triangles");
}

void WriteSurfaceTable(const SurfaceResult& result, const EdgeCounts& edges, const MapFrame& frame, const std::filesystem::path& file) {
  nlohmann::ordered_json table;
  table["crs"] = frame.CrsName();
  table["vertical"] = frame.VerticalName();
  table["voxel_m"] = result.voxel_m;
  table["triangles"] = result.triangles;
  table["edges"] = edges.edges;
  table["boundary_edges"] = edges.boundary;
  table["non_manifold_edges"] = edges.non_manifold;
  table["area_m2"] = result.area_m2;
  table["filled_m2"] = result.filled_m2;
  table["points"] = result.points;
  table["photos"] = result.photos;
  table["virtual_views"] = result.virtual_views;
  table["seconds"] = result.seconds;
  table["files"] = nlohmann::ordered_json::array();
  for (const WrittenFile& written : result.files) {
    table["files"].push_back({{"file", written.file.generic_string()},
                              {"content", written.content},
                              {"format", written.format},
                              {"crs", written.crs},
                              {"vertical", written.vertical},
                              {"bytes", written.bytes},
                              {"detail", written.detail}});
  }
  base::WriteFileAtomically(file, base::JsonText(table, 2) + "\n");
}

}  // namespace skyquilt::surface
