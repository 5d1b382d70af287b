// Sets of photos that are hard to find poses for, made from simulated surveys whose true poses are known: a folder of JPEGs with tags like those of a
// drone, without any model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/transform.h"

namespace skyquilt::bench {

enum class PhotoSet {
  kPlain,       // as simulated
  kTwoCameras,  // the second half is of a camera with a narrower view
  kTurned,      // every third photo is turned by 90 degrees, while its tags are not
  kBlurred,     // every fourth photo is blurred along the flight
  kOtherPlace,  // with kIntruders photos of another place, whose tags say they were taken here
  kNoTags,      // without position and gimbal angles
  kSolarFarm    // of a place that looks alike everywhere
};
constexpr int kIntruders = 4;

// In the order of the enumeration: plain, two_cameras, turned, blurred, other_place, no_tags, solar_farm.
const std::vector<std::string>& PhotoSetNames();
const char* NameOf(PhotoSet set);
// What is hard about it, for a table.
const char* AboutSet(PhotoSet set);
// Throws base::UsageError for an unknown name.
PhotoSet PhotoSetOf(const std::string& name);

struct TruePhoto {
  std::string name;  // of the file
  geo::Rigid3d cam_from_enu;
  double focal_px = 0.0;
  bool intruder = false;  // of another place: it must not get a pose; its own has no meaning
};

struct TrueSet {
  std::vector<TruePhoto> photos;
  double height_m = 0.0;  // median of the cameras' heights above take-off, by the tags

  size_t CountOurs() const;  // that are no intruders
};

// Writes the photos of a set into the new folder `out`. `survey`: a simulated survey in its exact frame; `other`: one of another place, used for
// kOtherPlace only, with at least kIntruders photos. kPlain and kSolarFarm take the photos as they are. Throws base::InputError.
TrueSet MakePhotoSet(PhotoSet set, const std::filesystem::path& survey, const std::filesystem::path& other, const std::filesystem::path& out);

}  // namespace skyquilt::bench
