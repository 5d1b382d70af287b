// Ground control points: gcp.json, {"crs", "points": [{"name", "x", "y", "z", "marks": [{"photo", "pixel"}]}]}, in the CRS of the project's maps.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/geo/utm.h"
#include "core/survey/survey.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::viewer {

constexpr size_t kMaxControlPoints = 10'000;
constexpr size_t kMaxPointName = 256;  // 64 characters of any script

// The photos in which points can be marked, by name: those of a survey, and those without a pose.
class MarkablePhotos {
 public:
  // survey: may be null.
  explicit MarkablePhotos(const survey::Survey* survey);

  bool Has(const std::string& name) const { return photos_.contains(name); }
  // Whether the pixel is in the photo, its edges included. Unknown sizes (no pose) end nowhere.
  bool Contains(const std::string& name, double x, double y) const;
  // The photo that a file of another program means, see PhotoNames::Find. Empty: there is none.
  std::string Find(const std::string& name) const;
  // Without folders, unless another photo would have the same name then.
  std::string ShortName(const std::string& name) const;
  const prepare::models::PhotoNames& finder() const { return finder_; }

 private:
  std::unordered_map<std::string, const camera::Camera*> photos_;
  std::vector<std::string> names_;
  prepare::models::PhotoNames finder_;
};

// "EPSG:32632"; nothing for a project without geo-reference.
std::optional<std::string> CrsNameOf(bool georeferenced, const geo::UtmZone& zone);

// Names of photos that are marked in gcp.json but are not markable: marks of photos that have left the survey may stay.
std::set<std::string> UnknownMarks(const nlohmann::json& gcp, const MarkablePhotos& photos);

// Throws base::Refused. crs: as CrsNameOf. allowed: unknown photos that may be marked, beside marks with "unknown": true, which the
// page may bring back after they were deleted.
void CheckControlPoints(const nlohmann::json& gcp, const std::optional<std::string>& crs, const MarkablePhotos& photos,
                        const std::set<std::string>& allowed);

}  // namespace skyquilt::viewer
