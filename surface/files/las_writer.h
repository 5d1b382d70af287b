// cloud.las: LAS 1.4 (ASPRS, revision 15), point format 7, coordinates of the maps in millimetres, the CRS as well-known text.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/base/output_file.h"
#include "surface/files/file_writer.h"

namespace skyquilt::surface {

class LasWriter : public FileWriter {
 public:
  // Keeps a reference to the frame. More than max_points points are split into cloud_1.las, cloud_2.las, ... of up to so many points.
  LasWriter(const MapFrame& frame, const std::filesystem::path& folder, int64_t max_points);

  void AddPoints(std::span<const CloudPoint> points) override;
  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  void BeginPart();
  void EndPart();
  std::vector<uint8_t> Header() const;

  const MapFrame& frame_;
  std::filesystem::path folder_;
  int64_t max_points_;
  std::string wkt_;
  std::vector<std::unique_ptr<base::OutputFile>> parts_;
  int64_t points_ = 0;
  // Of the last part.
  int64_t part_points_ = 0;
  std::array<int32_t, 3> min_ = {}, max_ = {};
};

}  // namespace skyquilt::surface
