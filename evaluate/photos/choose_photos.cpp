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

std::vector<int> SpreadOrder(const std::vector<int>& photos) {
  size_t range = 1;
  while (range < photos.size()) range *= 2;
  std::vector<int> order;
  for (size_t i = 0; i < range; ++i) {
    // The bits of i from the last to the first.
    size_t place = 0;
    for (size_t bit = 1, mirrored = range / 2; bit < range; bit *= 2, mirrored /= 2) {
      if ((i & bit) != 0) place += mirrored;
    }
    if (place < photos.size()) order.push_back(photos[place]);
  }
  return order;
}

}  // namespace skyquilt::evaluate::photos
