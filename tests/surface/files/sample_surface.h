// A small surface for tests of files, and readers for what was written.
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "surface/map_frame.h"
#include "surface/mesh.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::surface {

inline constexpr double kSampleTile_m = 64.0;

scene::SceneInfo SampleInfo(const geo::Geodetic& origin, bool georeferenced = true);
inline MapFrame TorontoFrame() {
  return MapFrame(SampleInfo({43.64, -79.39, 100.0}));
}
// Places where frames go wrong: equator, high latitude, both poles, both sides of the date line, below sea level.
std::vector<geo::Geodetic> DifficultOrigins();

// A hilly square of 2 * cells^2 triangles that fills its tile of the quadtree, with a texture whose red grows to the east, whose green grows to the
// south and whose blue is 40.
TexturedTile SampleTile(const TileId& id, int cells = 4);
// Four tiles of level 0 around (0, 0), where their parents meet too, and all that is above them up to one.
std::vector<TexturedTile> SamplePyramid();
std::vector<CloudPoint> SamplePoints(int count);

template <typename T>
T ReadAs(const std::string& bytes, size_t offset) {
  T value;
  if (offset + sizeof(T) > bytes.size()) throw std::out_of_range("read beyond the end of the file");
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

// A GLB file taken apart; throws when its chunks or lengths are not as the specification wants them.
struct Glb {
  nlohmann::json json;
  std::string binary;

  explicit Glb(const std::filesystem::path& file);
  // Numbers of an accessor, one row per element.
  std::vector<std::vector<double>> Accessor(size_t index) const;
  const nlohmann::json& primitive(size_t index) const { return json["meshes"][0]["primitives"][index]; }
  std::string Picture(size_t image) const;
};

class InToronto : public InTemporaryFolder {
 protected:
  const MapFrame frame_ = TorontoFrame();
};

std::vector<std::string> Lines(const std::string& text);
std::vector<std::string> NamesIn(const std::filesystem::path& folder);  // sorted

}  // namespace skyquilt::surface
