#include "core/geo/height_reference.h"

#include <stdexcept>

namespace skyquilt::geo {

std::string NameOf(HeightReference reference) {
  switch (reference) {
    case HeightReference::kEllipsoid:
      return "ellipsoid";
    case HeightReference::kEgm96:
      return "egm96";
    case HeightReference::kUnknown:
      break;
  }
  return "unknown";
}

std::optional<HeightReference> HeightReferenceNamed(std::string_view name) {
  for (const HeightReference reference : {HeightReference::kEllipsoid, HeightReference::kEgm96, HeightReference::kUnknown}) {
    if (name == NameOf(reference)) return reference;
  }
  return std::nullopt;
}

Vertical VerticalNamed(std::string_view name) {
  if (name == "as-tagged") return Vertical::kAsTagged;
  if (name == "ellipsoid") return Vertical::kEllipsoid;
  if (name == "egm96") return Vertical::kEgm96;
  throw std::invalid_argument("no vertical system is called '" + std::string(name) + "'");
}

}  // namespace skyquilt::geo
