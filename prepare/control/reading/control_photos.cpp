#include "prepare/control/reading/control_photos.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>

#include "core/survey/orientation.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {
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

// How the program that made the marks showed the photos.
struct Shown {
  bool upright = false, original = false;
};

// Width and height of the photo in which the mark was made; 0: not known.
Eigen::Vector2i MarkedSize(const RawMark& mark, const PhotoSize& photo, const Shown& shown) {
  if (mark.photo_size.x() > 0) return mark.photo_size;
  const Eigen::Vector2i size = shown.original ? Original(photo) : Stored(photo);
  return shown.upright ? survey::UprightSize(size, photo.orientation) : size;
}

// The present size, turned as the program did.
Eigen::Vector2i ShownSize(const PhotoSize& photo, const Shown& shown) {
  return shown.upright ? survey::UprightSize(Stored(photo), photo.orientation) : Stored(photo);
}

// In the stored photo. Multiplying before dividing keeps marks exact where the sizes are equal, or halved.
Eigen::Vector2d PixelOf(const RawMark& mark, const PhotoSize& photo, const Shown& shown) {
  const Eigen::Vector2i marked = MarkedSize(mark, photo, shown);
  const Eigen::Vector2d pixel = FromCorner(mark, marked).cwiseProduct(ShownSize(photo, shown).cast<double>()).cwiseQuotient(marked.cast<double>());
  return shown.upright ? survey::StoredFromUpright(pixel, Stored(photo), photo.orientation) : pixel;
}

bool Fits(const RawMark& mark, const PhotoSize& photo, const Shown& shown) {
  const Eigen::Vector2i marked = MarkedSize(mark, photo, shown);
  return marked.minCoeff() > 0 && HaveOneShape(marked, ShownSize(photo, shown)) && IsInside(FromCorner(mark, marked), marked);
}

size_t CountMisfits(const std::vector<RawMark>& marks, const std::vector<const PhotoSize*>& photos, const Shown& shown) {
  size_t n = 0;
  for (size_t i = 0; i < marks.size(); ++i) n += Fits(marks[i], *photos[i], shown) ? 0 : 1;
  return n;
}

// What to do about marks in turned pictures whose photos do not say so; empty: they would not fit those either.
std::string TurnedAdvice(const RawMark& mark, const PhotoSize& photo) {
  if (mark.origin == PixelOrigin::kMiddle) return "";
  constexpr int kClockwise = 6;
  const PhotoSize turned{photo.name, photo.width, photo.height, photo.original_width, photo.original_height, kClockwise};
  if (!Fits(mark, turned, {.upright = true})) return "";
  if (survey::ExchangesSides(photo.orientation)) {
    return "It fits the photo shown upright, but most others fit the photos as they are stored: make all marks in one of the two ways";
  }
  return fmt::format(
      "It fits the photo turned by 90 degrees, but the photo's EXIF orientation ({}) does not say so: give the photos with their original tags "
      "(exiftool -TagsFromFile ORIGINAL -Orientation), or turn the marks: of a photo shown turned clockwise the stored x is y, the stored y {} - x",
      photo.orientation, photo.height);
}

// `n_misfits`: marks that do not fit, this one among them.
[[noreturn]] void FailMark(const std::filesystem::path& file, const RawMark& mark, const PhotoSize& photo, const Shown& shown, size_t n_misfits) {
  const Eigen::Vector2i stored = Stored(photo), marked = MarkedSize(mark, photo, shown);
  const std::string turned = TurnedAdvice(mark, photo);
  if (!HaveOneShape(marked, ShownSize(photo, shown))) {
    tables::FailTableLine(file, mark.line,
                          fmt::format("the mark of {} was made in {} with {}x{} pixels, which now has {}x{}", mark.label, photo.name, marked.x(),
                                      marked.y(), stored.x(), stored.y()),
                          turned.empty() ? "Give the photos that were marked, neither turned nor cropped" : turned);
  }
  std::string advice = "Correct the mark, or state the size of the photo that was marked in columns image_width and image_height of the marks";
  if (mark.origin == PixelOrigin::kMiddle) advice = "Correct the mark: OpenSfM counts from the image's middle in parts of its larger side";
  if (shown.upright) advice = "Correct the mark: the others show that they were made in upright photos";
  tables::FailTableLine(
      file, mark.line,
      fmt::format("the mark of {} at x {:g}, y {:g} is outside {}, which has {}x{} pixels{}", mark.label, mark.pixel.x(), mark.pixel.y(), photo.name,
                  marked.x(), marked.y(), shown.upright && survey::ExchangesSides(photo.orientation) ? " upright" : ""),
      // One mark alone is rather a slip.
      turned.empty() || n_misfits < 2 ? advice : turned);
}

}  // namespace

ControlPhotos::ControlPhotos(const std::vector<PhotoSize>& photos) : photos_(photos), finder_(NamesOf(photos)) {}

const PhotoSize* ControlPhotos::Find(const std::string& name) const {
  const std::optional<size_t> found = finder_.Find(name);
  return found ? &photos_[*found] : nullptr;
}

std::vector<StoredMark> StoredPixels(const std::filesystem::path& file, const std::vector<RawMark>& marks,
                                     const std::vector<const PhotoSize*>& photos, std::vector<std::string>& warnings) {
  Shown shown;
  size_t least = CountMisfits(marks, photos, shown);
  for (const Shown& other : {Shown{true, false}, Shown{false, true}, Shown{true, true}}) {
    const size_t n = least > 0 ? CountMisfits(marks, photos, other) : 0;
    if (n >= least || (other.original && n > 0)) continue;
    least = n;
    shown = other;
  }
  const Shown upright{true, shown.original};
  const bool undecided = !shown.upright && CountMisfits(marks, photos, upright) <= least;
  size_t n_scaled = 0, n_turned = 0;
  std::vector<StoredMark> stored;
  stored.reserve(marks.size());
  for (size_t i = 0; i < marks.size(); ++i) {
    if (!Fits(marks[i], *photos[i], shown)) FailMark(file, marks[i], *photos[i], shown, least);
    StoredMark mark{PixelOf(marks[i], *photos[i], shown)};
    if (undecided && photos[i]->orientation != 1) mark.if_upright = PixelOf(marks[i], *photos[i], upright);
    if (MarkedSize(marks[i], *photos[i], shown) != ShownSize(*photos[i], shown)) ++n_scaled;
    if (shown.upright && photos[i]->orientation != 1) ++n_turned;
    stored.push_back(mark);
  }
  if (n_scaled > 0) {
    warnings.push_back(fmt::format("{}: {} of {} marks were made in photos of another size and are scaled to the present one", file.string(),
                                   n_scaled, marks.size()));
  }
  if (n_turned > 0) {
    warnings.push_back(
        fmt::format("{}: {} of {} marks were made in photos shown upright, as their EXIF orientation says, and are turned to the stored photos: "
                    "as they are written, they do not fit them",
                    file.string(), n_turned, marks.size()));
  }
  return stored;
}

}  // namespace skyquilt::prepare::control
