#include "surface/files/las_writer.h"

#include <algorithm>
#include <limits>

#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/gis/zone_wkt.h"

namespace skyquilt::surface {
namespace {

constexpr double kScale_m = 0.001;
constexpr uint16_t kHeaderBytes = 375, kRecordHeadBytes = 54, kPointBytes = 36;
constexpr uint8_t kPointFormat = 7;
constexpr uint16_t kWktGlobalEncoding = 16, kWktRecord = 2112;

// Point format 7 (LAS 1.4 R15, table 21).
void PutPoint(std::vector<uint8_t>* bytes, const std::array<int32_t, 3>& xyz, const CloudPoint& point) {
  for (const int32_t value : xyz) Put(bytes, value);
  Put(bytes, uint16_t{0});    // intensity
  Put(bytes, uint8_t{0x11});  // return 1 of 1
  Put(bytes, uint8_t{0});     // flags, scanner channel, direction, edge
  Put(bytes, point.las_class);
  Put(bytes, point.views);  // user data
  Put(bytes, int16_t{0});   // scan angle
  Put(bytes, uint16_t{0});  // point source
  Put(bytes, 0.0);          // GPS time
  for (const uint8_t value : point.rgb) Put(bytes, static_cast<uint16_t>(value * 257));
}

}  // namespace

LasWriter::LasWriter(const MapFrame& frame, const std::filesystem::path& folder, int64_t max_points)
    : frame_(frame), folder_(folder), max_points_(std::max<int64_t>(max_points, 1)) {
  wkt_ = frame.georeferenced() ? gis::WktOfZone(frame.zone(), frame.heights().reference())
                               : "LOCAL_CS[\"local frame\",LOCAL_DATUM[\"local frame\",0],UNIT[\"metre\",1],AXIS[\"X\",EAST],AXIS[\"Y\",NORTH]]";
  SKYQUILT_CHECK(wkt_.size() < std::numeric_limits<uint16_t>::max(), "the WKT is too long");
}

void LasWriter::AddPoints(std::span<const CloudPoint> points) {
  std::vector<uint8_t> bytes;
  bytes.reserve(points.size() * kPointBytes);
  for (const CloudPoint& point : points) {
    const Eigen::Array3d whole = ((point.position - frame_.offset()) / kScale_m).array().round();
    // 2147 km from the offset; only a broken coordinate is there.
    if (!(whole.abs() < static_cast<double>(std::numeric_limits<int32_t>::max())).all()) continue;
    if (parts_.empty() || part_points_ == max_points_) {
      if (!parts_.empty()) parts_.back()->Append(bytes);
      bytes.clear();
      BeginPart();
    }
    std::array<int32_t, 3> xyz;
    for (size_t axis = 0; axis < 3; ++axis) {
      xyz[axis] = static_cast<int32_t>(whole[static_cast<Eigen::Index>(axis)]);
      min_[axis] = part_points_ == 0 ? xyz[axis] : std::min(min_[axis], xyz[axis]);
      max_[axis] = part_points_ == 0 ? xyz[axis] : std::max(max_[axis], xyz[axis]);
    }
    PutPoint(&bytes, xyz, point);
    ++part_points_;
    ++points_;
  }
  if (!parts_.empty()) parts_.back()->Append(bytes);
}

void LasWriter::BeginPart() {
  EndPart();
  part_points_ = 0;
  base::OutputFile& part =
      *parts_.emplace_back(std::make_unique<base::OutputFile>(folder_ / ("cloud_" + std::to_string(parts_.size() + 1) + ".las")));
  part.Append(Header());
}

void LasWriter::EndPart() {
  if (parts_.empty()) return;
  parts_.back()->WriteAt(0, Header());
  parts_.back()->Complete();
}

// The public header block and the variable length record with the CRS. Fields that are not used, and the day of creation, are zero: the same points
// give the same file.
std::vector<uint8_t> LasWriter::Header() const {
  std::vector<uint8_t> bytes;
  PutText(&bytes, "LASF", 4);
  Put(&bytes, uint16_t{0});  // file source
  Put(&bytes, kWktGlobalEncoding);
  PutText(&bytes, "", 16);  // project
  Put(&bytes, uint8_t{1});  // version 1.4
  Put(&bytes, uint8_t{4});
  PutText(&bytes, "Skyquilt", 32);  // system
  PutText(&bytes, "Skyquilt", 32);  // software
  Put(&bytes, uint16_t{0});         // day and year of creation
  Put(&bytes, uint16_t{0});
  Put(&bytes, kHeaderBytes);
  const auto record_bytes = static_cast<uint16_t>(wkt_.size() + 1);
  Put(&bytes, static_cast<uint32_t>(kHeaderBytes + kRecordHeadBytes + record_bytes));  // where points begin
  Put(&bytes, uint32_t{1});                                                            // variable length records
  Put(&bytes, kPointFormat);
  Put(&bytes, kPointBytes);
  PutText(&bytes, "", 24);  // counts of older versions
  for (int axis = 0; axis < 3; ++axis) Put(&bytes, kScale_m);
  for (int axis = 0; axis < 3; ++axis) Put(&bytes, frame_.offset()[axis]);
  for (size_t axis = 0; axis < 3; ++axis) {
    const double offset = frame_.offset()[static_cast<Eigen::Index>(axis)];
    Put(&bytes, max_[axis] * kScale_m + offset);
    Put(&bytes, min_[axis] * kScale_m + offset);
  }
  PutText(&bytes, "", 20);  // waveforms, extended variable length records
  Put(&bytes, static_cast<uint64_t>(part_points_));
  Put(&bytes, static_cast<uint64_t>(part_points_));  // of the first return
  PutText(&bytes, "", size_t{14} * 8);               // of the others
  SKYQUILT_CHECK(bytes.size() == kHeaderBytes, "LAS header of " + std::to_string(bytes.size()) + " bytes");
  Put(&bytes, uint16_t{0});
  PutText(&bytes, "LASF_Projection", 16);
  Put(&bytes, kWktRecord);
  Put(&bytes, record_bytes);
  PutText(&bytes, "OGC WKT of the CRS", 32);
  PutText(&bytes, wkt_, record_bytes);
  return bytes;
}

void LasWriter::Complete() {
  EndPart();
}

void LasWriter::Publish() {
  if (parts_.size() == 1) {
    parts_.front()->Publish(folder_ / "cloud.las");
    return;
  }
  for (const auto& part : parts_) part->Publish();
}

std::vector<WrittenFile> LasWriter::Rows() const {
  if (parts_.empty()) return {};
  uint64_t bytes = 0;
  for (const auto& part : parts_) bytes += part->size();
  std::string detail = base::CountText(points_, "point");
  if (parts_.size() > 1) detail += " in " + base::CountText(static_cast<int64_t>(parts_.size()), "file");
  return {{.file = parts_.size() == 1 ? "cloud.las" : "cloud_1.las",
           .content = "point cloud",
           .format = "LAS 1.4",
           .crs = frame_.CrsName(),
           .vertical = frame_.VerticalName(),
           .bytes = static_cast<int64_t>(bytes),
           .detail = detail}};
}

}  // namespace skyquilt::surface
