// A video of a tour.
#pragma once

#include <filesystem>
#include <string>

#include "tour/format/tour.h"
#include "tour/pictures/render_picture.h"
#include "tour/ways/heights.h"

namespace skyquilt::tour {

struct VideoSpec {
  int width = 480, height = 270, fps = 12;  // even sizes
  std::string exposure = "normal";          // of stops that state none
};

// Writes the frames of FilmOf (tour/ways/film.h) as MP4. Frames in which nothing moves are rendered once. heights: null when nothing is known to be
// in the way. Throws base::InputError, base::UsageError for an exposure that is not allowed, base::Interrupted.
void WriteTourVideo(const Tour& tour, const Heights* heights, const PictureField& field, const VideoSpec& spec, const std::filesystem::path& file);

}  // namespace skyquilt::tour
