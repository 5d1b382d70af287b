// Photos that COLMAP or our decoder cannot read as they are (more than 8 bits per number, floating point, several bands, CMYK in TIFF, HEIC, raw),
// and transparent ones that are to be shown over white or black, are converted once, so that the search for poses, training and all later stages see
// the same pictures.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/thread_pool.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::input {

// The folder whose photos all others read: `photo_root` where all photos are plain and no bands are chosen, else `folder`, absolute, which then holds
// every photo under its name: 8-bit PNGs of converted ones (whatever the name's extension; programs look at the content), links to the others.
// `bands`: prepare.bands; `alpha`: prepare.alpha, photos of 8 or 16 bits that it fills are marked as `filled`. White is one value for all converted
// photos (white_level.h); values stay proportional to those of the file. Photos that cannot be converted are moved to `photos.unreadable`, with a
// warning; the others are marked as `converted`. A second call with the same photos and options finds the files finished. Throws base::InputError
// when fewer than kMinPhotos remain or the folder cannot be written.
std::filesystem::path MakePlainPhotos(const std::filesystem::path& photo_root, const std::string& bands, const std::string& alpha,
                                      const std::filesystem::path& folder, PhotoSet& photos, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::input
