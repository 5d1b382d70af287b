// How far each pixel of a rendering can be trusted: the error that pixels like it had where the scene was not trained.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/render/ray.h"
#include "core/trust/error_model.h"
#include "core/trust/evidence.h"

namespace skyquilt::trust {

struct Trust {
  EvidenceCells evidence;
  ErrorModel model;
  std::string scene;  // SceneIdentity of the scene that was measured
};

// Where the trust of a scene is kept: trust.h5 beside it.
std::filesystem::path TrustFileOf(const std::filesystem::path& scene_h5);
// Of the first bytes of the file, which hold the digest of all others. Throws base::InputError when it cannot be read.
std::string SceneIdentity(const std::filesystem::path& scene_h5);
// Throws base::InputError when the file cannot be written.
void Save(const Trust& trust, const std::filesystem::path& file);
// Of this scene. Throws base::InputError, which says how to fix it, when the file is missing, damaged, of a newer program or of another scene.
Trust LoadTrustOf(const std::filesystem::path& scene_h5);

// Expected errors of a picture, one channel each.
struct TrustPicture {
  image::ImageF error;   // expected root mean square error, display values from 0 to 1; NaN where the scene shows no surface
  image::ImageF photos;  // training photos that show the place; 0 where the scene shows no surface
};
constexpr float kTopError = 0.25F;  // at the top of the colours in which people are shown errors (image::Colorize)
// Gives the rays of a row of the picture.
using RowRays = std::function<void(int row, std::span<render::Ray> rays)>;
// colors: row by row, width * height, as rendered by these rays, with opacity and depths. The same for any number of threads.
TrustPicture TrustOf(const Trust& trust, int width, int height, std::span<const render::RayColor> colors, const RowRays& rays,
                     base::ThreadPool& threads);
// In two steps: what is known about the pixels, and the errors that a model expects from it.
std::vector<PixelFacts> FactsOf(const EvidenceCells& evidence, int width, int height, std::span<const render::RayColor> colors, const RowRays& rays,
                                base::ThreadPool& threads);

TrustPicture PictureOf(const ErrorModel& model, int width, int height, std::span<const render::RayColor> colors, std::span<const PixelFacts> facts,
                       base::ThreadPool& threads);

}  // namespace skyquilt::trust
