// What the names of files that drones and programs write say of them. Upper and lower case are the same.
#pragma once

#include <optional>
#include <string>

namespace skyquilt::prepare::input {

enum class FileGroup {
  kPicture,       // jpg, jpeg, png, tif, tiff: can be a photo
  kHeic,          // phones' pictures
  kRaw,           // a camera's own format
  kVideo,         //
  kOtherPicture,  // of another format
  kOther          // no picture
};
FileGroup GroupOf(const std::string& name);
// As in "3 raw pictures", and how to make photos of them. Empty for kPicture and kOther; all of kHeic are read.
std::string GroupName(FileGroup group);
std::string HowToConvert(FileGroup group);

// Path of a file, taken apart. Together they are the name.
struct NameParts {
  std::string folder;     // with '/' at its end, or empty
  std::string stem;       // without the extension
  std::string extension;  // with its '.', or empty
};
NameParts PartsOf(const std::string& name);

// What several files of one shot have in common.
struct ShotName {
  std::string shot;    // the stem without what tells the files of a shot apart
  std::string camera;  // that, in lower case: "g" of _MS_G, "3" of _3, "t" of _T
};
// A spectral band: _MS_G, _MS_R, _MS_RE, _MS_NIR, _MS_B (DJI), _GRE, _RED, _REG, _NIR (Parrot).
std::optional<ShotName> BandName(const std::string& stem);
// A spectral band where others of the shot have other numbers: IMG_0001_1 to IMG_0001_12 (MicaSense).
std::optional<ShotName> NumberedBandName(const std::string& stem);
// A picture of heat: _T (DJI), _IR, _THRM, _THERMAL, IRX_ (Autel).
std::optional<ShotName> ThermalName(const std::string& stem);
// A picture in colour of a drone with several cameras: _D, _W, _Z, _V, _S after a number (DJI), MAX_ (Autel).
std::optional<ShotName> ColourName(const std::string& stem);
// The stem without any of these.
std::string ShotOf(const std::string& stem);

bool IsThumbnailStem(const std::string& stem);   // THUMB_x, x_thumb, x_thumbnail
bool IsSharedMaskStem(const std::string& stem);  // mask, camera_mask: of all photos
// The stem of the photo: x of x_mask.
std::optional<std::string> MaskedStem(const std::string& stem);
// A map that photogrammetry made: orthophoto, odm_orthophoto, orthomosaic, dsm, dtm.
bool IsMapStem(const std::string& stem);

bool IsHiddenName(const std::string& file_name);
// Folders of systems that no photos are kept in: @eaDir, __MACOSX, $RECYCLE.BIN, lost+found and hidden ones.
bool IsSystemFolder(const std::string& folder_name);
bool IsThumbnailFolder(const std::string& folder_name);
bool IsMaskFolder(const std::string& folder_name);  // masks, mask

}  // namespace skyquilt::prepare::input
