// Finds the masks of photos, as programs that make masks name and place them, and makes them usable for all later stages: 0 = ignored pixel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/list_files.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::input {

// Where masks may be. Paths are absolute.
struct MaskPlaces {
  bool none = false;                              // no photo gets a mask
  std::filesystem::path given;                    // folder, or one mask for all photos, that the user named; empty: searched for
  std::vector<std::filesystem::path> folders;     // outside of the photo folder: masks/ beside images/
  std::vector<std::filesystem::path> shared;      // files there that are one mask for all photos: mask.png
  std::vector<std::filesystem::path> transforms;  // transforms.json whose frames may name masks
};

// The places around a photo folder. `option`: prepare.masks: a folder, a file, "none", or empty. `transforms`: of the model, if there is one. Throws
// base::InputError when there is no such folder or file.
MaskPlaces FindMaskPlaces(const std::filesystem::path& photo_root, const std::string& option, const std::vector<std::filesystem::path>& transforms);

struct PhotoMasks {
  std::filesystem::path folder;     // has the masks as COLMAP wants them, folder/NAME.png; empty: there are none
  std::vector<std::string> origin;  // of each photo: the file it came from, relative to the photo folder where it is inside, or "alpha"
};

// Of each photo the first of these; names are compared without upper and lower case. For a photo sub/x.jpg:
//   the file that mask_path of a transforms.json names (nerfstudio)
//   in folders called masks or mask, in the folder given, or beside the photo: sub/x.jpg.png (COLMAP), sub/x_mask.png (OpenDroneMap, MicMac,
//     Metashape) or .jpg, .tif; sub/x.png or any picture of its name (not beside the photo, except in black and white); then the same without sub/
//     where that is unique
//   one for all photos of a folder: sub/mask.png or camera_mask.png, those of the folders above, masks/sub.png; the only file of the folder of masks
//   its own alpha (PNG, TIFF), unless that was filled (PhotoFile::filled)
// Masks of another size with the same shape are scaled (nearest pixel). `files`: the list (list_files.h), whose kMask are masks in the photo folder;
// `mask` of photos and files is filled. Unless all masks already are PNGs of the photos' sizes with COLMAP's names in one folder, they are written to
// `own_folder`, where files of earlier calls that are equal stay untouched. Logs what was found, and warns of masks that fit no photo. Throws
// base::InputError for a mask of another shape than its photo, and for folders of masks that fit no photo at all.
PhotoMasks FindMasks(const std::filesystem::path& photo_root, const MaskPlaces& places, const std::filesystem::path& own_folder,
                     std::vector<PhotoFile>& photos, std::vector<InputFile>& files, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::input
