// How to read the coordinates of the mesh and the cloud: georeference.json for people and programs, offset.txt for those that know the file
// coords.txt of OpenDroneMap.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/output_file.h"
#include "surface/files/file_writer.h"

namespace skyquilt::surface {

// Lines of comment for the head of text files whose coordinates have the offset subtracted.
std::vector<std::string> DescribePlace(const MapFrame& frame);

// georeference.json: crs ("EPSG:32617" or null), offset [easting, northing, height], vertical, origin {latitude_deg, longitude_deg, height_m} of the
// survey's east-north-up frame or null, note.
// offset.txt, with geo-reference only: "WGS84 UTM 17N" (or the EPSG code of a polar zone), then easting and northing of the offset.
class GeoreferenceFile : public FileWriter {
 public:
  // Keeps a reference to the frame.
  GeoreferenceFile(const MapFrame& frame, const std::filesystem::path& folder);

  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  const MapFrame& frame_;
  base::OutputFile json_;
  std::unique_ptr<base::OutputFile> offset_;
};

}  // namespace skyquilt::surface
