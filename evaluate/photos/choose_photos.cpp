#include "evaluate/photos/choose_photos.h"

namespace skyquilt::evaluate::photos {

std::vector<int> HeldOutPhotos(const survey::Survey& survey) {
  std::vector<int> held_out;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (survey.photos[i].is_test) held_out.push_back(static_cast<int>(i));
  }
  return held_out;
}

std::vector<size_t> EvenlySpacedIndices(size_t n, int count) {
  const size_t wanted = count <= 0 || static_cast<size_t>(count) >= n ? n : static_cast<size_t>(count);
  std::vector<size_t> places;
  for (size_t i = 0; i < wanted; ++i) places.push_back((2 * i + 1) * n / (2 * wanted));
  return places;
}

std::vector<int> SelectEvenly(const std::vector<int>& photos, int count) {
  std::vector<int> chosen;
  for (const size_t place : EvenlySpacedIndices(photos.size(), count)) chosen.push_back(photos[place]);
  return chosen;
}

}  // namespace skyquilt::evaluate::photos
