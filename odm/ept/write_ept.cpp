#include "odm/ept/write_ept.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/output_file.h"
#include "core/base/progress.h"
#include "odm/ept/octree.h"
#include "surface/files/las_part.h"

namespace skyquilt::odm::ept {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kCloudFix = "Make the point cloud again with --rerun-from odm_georeferencing";
constexpr size_t kBlockPoints = 1 << 16;
constexpr int kMostChunkDepth = 7;

// The points of all files, one by one.
class Cloud {
 public:
  explicit Cloud(const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
      parts_.push_back(std::make_unique<surface::LasPart>(file, kCloudFix));
      count_ += parts_.back()->count();
      if (parts_.back()->scale() != parts_.front()->scale() || parts_.back()->offset() != parts_.front()->offset()) {
        throw base::InputError(file, "has another scale or offset than the first part of the cloud", kCloudFix);
      }
    }
  }
  size_t count() const { return count_; }
  const Eigen::Vector3d& scale() const { return parts_.front()->scale(); }
  const Eigen::Vector3d& offset() const { return parts_.front()->offset(); }
  const std::vector<std::unique_ptr<surface::LasPart>>& parts() const { return parts_; }

  template <typename Take>
  void ForEach(const Take& take) const {
    for (const std::unique_ptr<surface::LasPart>& part : parts_) {
      for (size_t first = 0; first < part->count(); first += kBlockPoints) {
        base::ThrowIfCancelled();
        const size_t n = std::min(kBlockPoints, part->count() - first);
        const std::span<const uint8_t> block = part->Points(first, n);
        for (size_t i = 0; i < n; ++i) take(PointOf(block.subspan(i * surface::LasPart::kRecordBytes, surface::LasPart::kRecordBytes)));
        part->ReleasePages();
      }
    }
  }

 private:
  static Point PointOf(std::span<const uint8_t> record) {
    Point point;
    std::memcpy(point.xyz.data(), record.data(), sizeof point.xyz);
    std::memcpy(point.rgb.data(), record.data() + surface::LasPart::kColorAt, sizeof point.rgb);
    point.classification = record[surface::LasPart::kClassAt];
    point.user_data = record[surface::LasPart::kUserDataAt];
    return point;
  }

  std::vector<std::unique_ptr<surface::LasPart>> parts_;
  size_t count_ = 0;
};

struct Bounds {
  std::array<int64_t, 3> low, high;
};

Bounds BoundsOf(const Cloud& cloud) {
  Bounds bounds;
  bounds.low.fill(std::numeric_limits<int64_t>::max());
  bounds.high.fill(std::numeric_limits<int64_t>::min());
  cloud.ForEach([&](const Point& point) {
    for (size_t axis = 0; axis < 3; ++axis) {
      bounds.low[axis] = std::min<int64_t>(bounds.low[axis], point.xyz[axis]);
      bounds.high[axis] = std::max<int64_t>(bounds.high[axis], point.xyz[axis]);
    }
  });
  return bounds;
}

// About the middle of the points.
Cube CubeOf(const Bounds& bounds) {
  int64_t extent = 1;
  for (size_t axis = 0; axis < 3; ++axis) extent = std::max(extent, bounds.high[axis] - bounds.low[axis] + 1);
  Cube cube;
  cube.size = static_cast<int64_t>(std::bit_ceil(static_cast<uint64_t>(std::max<int64_t>(extent, kSpan))));
  for (size_t axis = 0; axis < 3; ++axis) cube.low[axis] = bounds.low[axis] - (cube.size - (bounds.high[axis] - bounds.low[axis] + 1)) / 2;
  return cube;
}

// The least depth whose nodes hold at most so many points each.
int ChunkDepth(const Cloud& cloud, const Cube& cube, size_t chunk_points) {
  if (cloud.count() <= chunk_points) return 0;
  const int most = std::min(kMostChunkDepth, cube.Levels());
  std::map<NodeKey, size_t> counts;
  cloud.ForEach([&](const Point& point) { ++counts[{most, cube.CellOf(point, most)}]; });
  for (int depth = 1; depth < most; ++depth) {
    std::map<NodeKey, size_t> coarse;
    size_t largest = 0;
    for (const auto& [key, n] : counts) {
      const int shift = most - depth;
      size_t& sum = coarse[{depth, {key.cell[0] >> shift, key.cell[1] >> shift, key.cell[2] >> shift}}];
      sum += n;
      largest = std::max(largest, sum);
    }
    if (largest <= chunk_points) return depth;
  }
  return most;
}

// Without waiting for the disk: there are many files, and the folder gets its name when all are there.
void AppendPoints(const fs::path& file, std::span<const Point> points) {
  std::ofstream out(file, std::ios::binary | std::ios::app);
  out.write(reinterpret_cast<const char*>(points.data()), static_cast<std::streamsize>(points.size_bytes()));
  out.close();
  if (!out) base::ThrowFileError(file, "cannot be written", errno);
}

// Points that wait on disk, a file per chunk.
class ChunkFiles {
 public:
  explicit ChunkFiles(fs::path folder) : folder_(std::move(folder)) { fs::create_directories(folder_); }
  ~ChunkFiles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  ChunkFiles(const ChunkFiles&) = delete;
  ChunkFiles& operator=(const ChunkFiles&) = delete;

  void Add(const NodeKey& key, const Point& point) {
    std::vector<Point>& waiting = waiting_[key];
    waiting.push_back(point);
    if (waiting.size() >= kWaiting) Flush(key, &waiting);
  }
  // The chunks in order, each removed after it was taken.
  void TakeAll(const std::function<void(const NodeKey& key, std::vector<Point> points)>& take) {
    for (auto& [key, waiting] : waiting_) {
      base::ThrowIfCancelled();
      std::vector<Point> points;
      const fs::path file = FileOf(key);
      if (fs::exists(file)) {
        const std::string bytes = base::ReadFile(file);
        points.resize(bytes.size() / kRecordBytes);
        std::memcpy(points.data(), bytes.data(), points.size() * kRecordBytes);
        fs::remove(file);
      }
      points.insert(points.end(), waiting.begin(), waiting.end());
      waiting = {};
      take(key, std::move(points));
    }
  }

 private:
  static constexpr size_t kWaiting = 4096;
  fs::path FileOf(const NodeKey& key) const { return folder_ / (key.Name() + ".bin"); }
  void Flush(const NodeKey& key, std::vector<Point>* waiting) {
    AppendPoints(FileOf(key), *waiting);
    waiting->clear();
  }

  fs::path folder_;
  std::map<NodeKey, std::vector<Point>> waiting_;
};

Json Field(const char* name, const char* type, int size) {
  return {{"name", name}, {"type", type}, {"size", size}};
}

Json SchemaOf(const Cloud& cloud) {
  Json schema = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::array<const char*, 3> names = {"X", "Y", "Z"};
    Json field = Field(names[static_cast<size_t>(axis)], "signed", 4);
    field["scale"] = cloud.scale()[axis];
    field["offset"] = cloud.offset()[axis];
    schema.push_back(field);
  }
  for (const char* color : {"Red", "Green", "Blue"}) schema.push_back(Field(color, "unsigned", 2));
  for (const char* name : {"Classification", "UserData"}) schema.push_back(Field(name, "unsigned", 1));
  return schema;
}

// The six numbers of a box in map coordinates.
Json BoxOf(const Cloud& cloud, const std::array<int64_t, 3>& low, const std::array<int64_t, 3>& high) {
  Json box = Json::array();
  for (const std::array<int64_t, 3>& corner : {low, high}) {
    for (int axis = 0; axis < 3; ++axis) {
      box.push_back(static_cast<double>(corner[static_cast<size_t>(axis)]) * cloud.scale()[axis] + cloud.offset()[axis]);
    }
  }
  return box;
}

void WriteMetadata(const Cloud& cloud, const Cube& cube, const Bounds& bounds, const EptCrs& crs, const fs::path& folder) {
  std::array<int64_t, 3> cube_high = cube.low;
  for (int64_t& value : cube_high) value += cube.size;
  Json srs = Json::object();
  if (crs.epsg > 0) srs = {{"authority", "EPSG"}, {"horizontal", std::to_string(crs.epsg)}};
  if (!crs.wkt.empty()) srs["wkt"] = crs.wkt;
  const Json ept = {{"bounds", BoxOf(cloud, cube.low, cube_high)},
                    {"boundsConforming", BoxOf(cloud, bounds.low, bounds.high)},
                    {"dataType", "binary"},
                    {"hierarchyType", "json"},
                    {"points", cloud.count()},
                    {"schema", SchemaOf(cloud)},
                    {"span", kSpan},
                    {"srs", srs},
                    {"version", "1.0.0"}};
  base::WriteFileAtomically(folder / "ept.json", base::JsonText(ept, 2) + "\n");
  fs::create_directories(folder / "ept-sources");
  Json sources = Json::array();
  for (size_t i = 0; i < cloud.parts().size(); ++i) {
    const surface::LasPart& part = *cloud.parts()[i];
    sources.push_back({{"id", part.file().filename().string()}, {"origin", i}, {"points", part.count()}});
  }
  base::WriteFileAtomically(folder / "ept-sources" / "list.json", base::JsonText(sources, 2) + "\n");
}

}  // namespace

int64_t WriteEpt(const std::vector<fs::path>& files, const EptCrs& crs, const fs::path& folder, size_t chunk_points) {
  if (files.empty()) return 0;
  const Cloud cloud(files);
  if (cloud.count() == 0) return 0;
  base::PartialPath partial(folder);
  const fs::path data = partial.path() / "ept-data";
  fs::create_directories(data);
  const Bounds bounds = BoundsOf(cloud);
  const Cube cube = CubeOf(bounds);
  std::map<NodeKey, size_t> hierarchy;
  base::Progress progress("point cloud for viewers", static_cast<double>(cloud.count()), "points");
  const NodeSink sink = [&](const NodeKey& key, std::span<const Point> points) {
    AppendPoints(data / (key.Name() + ".bin"), points);
    hierarchy[key] = points.size();
    progress.Advance(static_cast<double>(points.size()));
  };
  const int depth = ChunkDepth(cloud, cube, chunk_points);
  if (depth == 0) {
    std::vector<Point> points;
    points.reserve(cloud.count());
    cloud.ForEach([&](const Point& point) { points.push_back(point); });
    BuildSubtree(cube, {}, std::move(points), sink);
  } else {
    UpperNodes upper(cube, depth);
    ChunkFiles chunks(partial.path() / "waiting");
    cloud.ForEach([&](const Point& point) {
      if (!upper.Take(point)) chunks.Add({depth, cube.CellOf(point, depth)}, point);
    });
    upper.Finish(sink);
    chunks.TakeAll([&](const NodeKey& key, std::vector<Point> points) { BuildSubtree(cube, key, std::move(points), sink); });
  }
  progress.Finish();
  Json counts = Json::object();
  for (const auto& [key, n] : hierarchy) counts[key.Name()] = n;
  fs::create_directories(partial.path() / "ept-hierarchy");
  base::WriteFileAtomically(partial.path() / "ept-hierarchy" / "0-0-0-0.json", base::JsonText(counts) + "\n");
  WriteMetadata(cloud, cube, bounds, crs, partial.path());
  std::error_code error;
  fs::remove_all(folder, error);
  if (error) throw base::InputError(folder, "cannot be removed: " + error.message(), "Check the permissions of its folder");
  partial.Publish();
  return static_cast<int64_t>(cloud.count());
}

}  // namespace skyquilt::odm::ept
