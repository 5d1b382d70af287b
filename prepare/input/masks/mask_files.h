// Brings masks into the form that all later stages read: PNGs of the photos' sizes, named as COLMAP wants them.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::input {

// How a photo gets its mask.
struct MaskJob {
  const PhotoFile* photo = nullptr;
  std::filesystem::path file;                      // empty: none
  Eigen::Vector2i size = Eigen::Vector2i::Zero();  // of the file, pixels
  bool alpha = false;                              // from the photo's own alpha: dropped where that is opaque everywhere
};

// Width and height. 0 for a mask of several photos that has not this one's shape. Throws base::InputError for the photo's own mask of another shape,
// and for files that cannot be read.
Eigen::Vector2i SizeOfMask(const std::filesystem::path& file, const PhotoFile& photo, bool shared);

// The folder in which all these masks already are in that form; empty when they are not, or there are none.
std::filesystem::path MaskFolderOf(const std::vector<MaskJob>& jobs);

// Writes all masks to `folder`/NAME.png, and removes other files there. Equal ones stay untouched, so that what was made with them stays valid.
// Returns the folder, or an empty path when no photo has a mask. Throws base::InputError.
std::filesystem::path WriteMasks(const std::filesystem::path& photo_root, const std::filesystem::path& folder, std::vector<MaskJob>& jobs,
                                 base::ThreadPool& threads);

// A mask as one channel of this size, 0 = ignore and 255 = use; of another size: its nearest pixel. JPEG blurs black: there less than half of white
// is ignored.
image::Image8 LoadMaskAt(const std::filesystem::path& file, int width, int height);

}  // namespace skyquilt::prepare::input
