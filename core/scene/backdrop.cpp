#include "core/scene/backdrop.h"

#include <stdexcept>

#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

constexpr const char* kMean[3] = {"background_r", "background_g", "background_b"};
constexpr const char* kHeights = "backdrop/heights";
constexpr const char* kColors = "backdrop/colors";

}  // namespace

std::array<float, 3> Backdrop::Color(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const {
  Eigen::Vector3d x;
  if (!surface.Meet(origin_enu, direction_enu, &x)) return mean_srgb;
  const PlanSurface::Corners corners = surface.Around(x.x(), x.y());
  std::array<float, 3> rgb = {0.0F, 0.0F, 0.0F};
  for (size_t i = 0; i < 4; ++i) {
    for (size_t c = 0; c < 3; ++c) rgb[c] += static_cast<float>(corners.weight[i]) * rgb_srgb[3 * corners.cell[i] + c];
  }
  return rgb;
}

void PutBackdrop(const Backdrop& backdrop, checkpoint::ArchiveWriter& writer) {
  for (size_t c = 0; c < 3; ++c) writer.SetAttribute(kMean[c], static_cast<double>(backdrop.mean_srgb[c]));
  const PlanSurface& s = backdrop.surface;
  if (s.Empty()) return;
  writer.SetAttribute("backdrop_min_x", s.min_x());
  writer.SetAttribute("backdrop_min_y", s.min_y());
  writer.SetAttribute("backdrop_cell_m", s.cell_m());
  writer.Put(kHeights, s.heights(), {s.rows(), s.columns()});
  writer.Put(kColors, backdrop.rgb_srgb, {s.rows(), s.columns(), 3});
}

Backdrop GetBackdrop(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  Backdrop backdrop;
  for (size_t c = 0; c < 3; ++c) {
    if (reader.HasAttribute(kMean[c])) backdrop.mean_srgb[c] = static_cast<float>(reader.DoubleAttribute(kMean[c]));
  }
  if (!reader.Has(kHeights)) return backdrop;
  const std::string mend = "Train it again with --restart";
  const std::vector<int64_t> shape = reader.Shape(kHeights);
  if (shape.size() != 2 || reader.Shape(kColors) != std::vector<int64_t>{shape[0], shape[1], 3}) {
    throw base::InputError(file, "heights and colours of the backdrop disagree", mend);
  }
  try {
    backdrop.surface =
        PlanSurface(reader.DoubleAttribute("backdrop_min_x"), reader.DoubleAttribute("backdrop_min_y"), reader.DoubleAttribute("backdrop_cell_m"),
                    static_cast<int>(shape[1]), static_cast<int>(shape[0]), reader.Doubles(kHeights));
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, std::string("holds an impossible backdrop: ") + error.what(), mend);
  }
  backdrop.rgb_srgb = reader.Floats(kColors);
  return backdrop;
}

}  // namespace skyquilt::scene
