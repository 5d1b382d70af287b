// Renders the pictures of a tour into a work folder, from where an interrupted run continues.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "tour/pictures/picture_request.h"
#include "tour/pictures/render_picture.h"

namespace skyquilt::tour {

struct PictureFiles {
  std::vector<std::filesystem::path> files;  // of the requests, in their order; see OpenPicture. Equal requests share a file
  int64_t rendered = 0, rays = 0;            // by this call
  double seconds = 0.0;                      // of rendering alone
};

// Those that are not whole in the folder yet, without repetitions.
std::vector<PictureRequest> MissingPictures(std::span<const PictureRequest> requests, const PictureField& field, const std::filesystem::path& folder);

// Renders what is missing, with a progress bar. A picture is whole in the folder or absent, so a killed run loses at most one. When all are there,
// pictures of other requests are removed from the folder. Throws base::UsageError for an exposure that is not allowed, before anything is rendered;
// base::InputError (disk full, no permission); base::Interrupted.
PictureFiles MakePictures(std::span<const PictureRequest> requests, const PictureField& field, const std::filesystem::path& folder);

}  // namespace skyquilt::tour
