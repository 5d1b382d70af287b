#include "prepare/control/control_photos.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>

namespace skyquilt::prepare {
namespace {

std::vector<std::string> NamesOf(const std::vector<PhotoSize>& photos) {
  std::vector<std::string> names;
  names.reserve(photos.size());
  for (const PhotoSize& photo : photos) names.push_back(photo.name);
  return names;
}

// In pixels from the corner, of an image of this size.
Eigen::Vector2d FromCorner(const RawMark& mark, const Eigen::Vector2i& size) {
  switch (mark.origin) {
    case PixelOrigin::kCorner:
      return mark.pixel;
    case PixelOrigin::kFirstPixel:
      return mark.pixel + Eigen::Vector2d::Constant(0.5);
    case PixelOrigin::kMiddle:
      break;
  }
  return mark.pixel * size.maxCoeff() + 0.5 * size.cast<double>();
}

bool IsInside(const Eigen::Vector2d& pixel, const Eigen::Vector2i& size) {
  return (pixel.array() >= 0.0).all() && (pixel.array() <= size.cast<double>().array()).all();
}

// Apart from what rounding of the smaller one's sides explains.
bool HaveOneShape(const Eigen::Vector2i& a, const Eigen::Vector2i& b) {
  const int64_t difference = int64_t{a.x()} * b.y() - int64_t{a.y()} * b.x();
  return std::abs(difference) <= std::max(a.maxCoeff(), b.maxCoeff());
}

Eigen::Vector2i Stored(const PhotoSize& photo) {
  return {photo.width, photo.height};
}

Eigen::Vector2i Original(const PhotoSize& photo) {
  return {photo.original_width, photo.original_height};
}

// Multiplying before dividing keeps marks exact where the sizes are equal, or halved.
Eigen::Vector2d Scaled(const RawMark& mark, const Eigen::Vector2i& from, const Eigen::Vector2i& to) {
  return FromCorner(mark, from).cwiseProduct(to.cast<double>()).cwiseQuotient(from.cast<double>());
}

// Whether the marks without a stated size were made in the photos as they were before.
bool AreOfOriginals(const std::vector<RawMark>& marks, const std::vector<const PhotoSize*>& photos) {
  bool outside = false;
  for (size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].photo_size.x() > 0) continue;
    const Eigen::Vector2i original = Original(*photos[i]);
    const bool fits = original.minCoeff() > 0 && HaveOneShape(original, Stored(*photos[i])) && IsInside(FromCorner(marks[i], original), original);
    if (!fits) return false;
    outside = outside || !IsInside(FromCorner(marks[i], Stored(*photos[i])), Stored(*photos[i]));
  }
  return outside;
}

}  // namespace

ControlPhotos::ControlPhotos(const std::vector<PhotoSize>& photos) : photos_(photos), finder_(NamesOf(photos)) {}

const PhotoSize* ControlPhotos::Find(const std::string& name) const {
  const std::optional<size_t> found = finder_.Find(name);
  return found ? &photos_[*found] : nullptr;
}

std::vector<Eigen::Vector2d> StoredPixels(const std::filesystem::path& file, const std::vector<RawMark>& marks,
                                          const std::vector<const PhotoSize*>& photos, std::vector<std::string>& warnings) {
  const bool of_originals = AreOfOriginals(marks, photos);
  size_t n_scaled = 0;
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(marks.size());
  for (size_t i = 0; i < marks.size(); ++i) {
    const RawMark& mark = marks[i];
    const Eigen::Vector2i stored = Stored(*photos[i]);
    Eigen::Vector2i marked = mark.photo_size;
    if (marked.x() <= 0) marked = of_originals ? Original(*photos[i]) : stored;
    if (!HaveOneShape(marked, stored)) {
      FailControlLine(file, mark.line,
                      fmt::format("the mark of {} was made in {} with {}x{} pixels, which now has {}x{}", mark.label, photos[i]->name, marked.x(),
                                  marked.y(), stored.x(), stored.y()),
                      "Give the photos that were marked, neither turned nor cropped");
    }
    const Eigen::Vector2d pixel = Scaled(mark, marked, stored);
    if (!IsInside(pixel, stored)) {
      FailControlLine(file, mark.line,
                      fmt::format("the mark of {} at x {:g}, y {:g} is outside {}, which has {}x{} pixels", mark.label, mark.pixel.x(),
                                  mark.pixel.y(), photos[i]->name, marked.x(), marked.y()),
                      mark.origin == PixelOrigin::kMiddle
                          ? "Correct the mark: OpenSfM counts from the image's middle in parts of its larger side"
                          : "Correct the mark, or state the size of the photo that was marked in columns image_width and image_height of the marks");
    }
    if (marked != stored) ++n_scaled;
    pixels.push_back(pixel);
  }
  if (n_scaled > 0) {
    warnings.push_back(fmt::format("{}: {} of {} marks were made in photos of another size and are scaled to the present one", file.string(),
                                   n_scaled, marks.size()));
  }
  return pixels;
}

}  // namespace skyquilt::prepare
