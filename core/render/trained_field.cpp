#include "core/render/trained_field.h"

#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "core/base/errors.h"

namespace skyquilt::render {
namespace {

constexpr const char* kArrays[] = {"grid", "networks", "occupied", "occupancy_depth"};
constexpr const char* kMend = "Train it again with --restart";

// Fixed order of the numbers that rebuild a field.
std::vector<double> Describe(const TrainedField& f) {
  const auto& g = f.config.grid;
  std::vector<double> d = {static_cast<double>(g.levels),
                           static_cast<double>(g.features),
                           static_cast<double>(g.log2_table_size),
                           g.base_resolution,
                           g.finest_resolution,
                           g.extent[0],
                           g.extent[1],
                           g.extent[2],
                           static_cast<double>(f.config.hidden),
                           static_cast<double>(f.config.color_hidden_layers),
                           static_cast<double>(f.config.sh_degree),
                           f.config.color_range,
                           f.config.density_bias,
                           f.map.contracted() ? 1.0 : 0.0};
  for (const auto& corner : {f.map.min_enu(), f.map.max_enu(), f.core_min_enu, f.core_max_enu}) {
    for (int axis = 0; axis < 3; ++axis) d.push_back(corner[axis]);
  }
  d.push_back(f.margin_m);
  d.push_back(f.step_m);
  return d;
}

}  // namespace

void TrainedField::Finish() {
  field = std::make_unique<field::HashField>(config);
  weights = field->Prepare(networks);
  blend_m = margin_m;
}

void PutOutline(const TrainedField& f, const std::string& prefix, checkpoint::ArchiveWriter& writer) {
  writer.SetAttribute(prefix + "name", f.name);
  writer.SetAttribute(prefix + "steps", f.steps);
  writer.SetAttribute(prefix + "seconds", f.seconds);
  writer.SetAttribute(prefix + "samples", f.samples);
  const std::vector<double> numbers = Describe(f);
  for (size_t i = 0; i < numbers.size(); ++i) writer.SetAttribute(prefix + "describe" + std::to_string(i), numbers[i]);
  writer.SetAttribute(prefix + "encoding", encoding::Name(f.config.encoding));
  writer.SetAttribute(prefix + "density_hidden_layers", f.config.density_hidden_layers);
  writer.SetAttribute(prefix + "luminance", f.config.luminance ? 1 : 0);
  writer.SetAttribute(prefix + "occupancy_cell", static_cast<double>(f.occupancy.cell));
}

void PutField(const TrainedField& f, const std::string& prefix, checkpoint::ArchiveWriter& writer) {
  PutOutline(f, prefix, writer);
  writer.Put(prefix + "grid", f.grid);
  writer.Put(prefix + "networks", f.networks);
  const std::vector<int64_t> shape = {f.occupancy.size[2], f.occupancy.size[1], f.occupancy.size[0]};
  writer.Put(prefix + "occupied", f.occupancy.occupied, shape);
  writer.Put(prefix + "occupancy_depth", f.occupancy.depth, shape);
}

void PutFieldOf(const TrainedField& outline, const std::filesystem::path& checkpoint, const std::string& prefix, checkpoint::ArchiveWriter& writer) {
  PutOutline(outline, prefix, writer);
  for (const char* array : kArrays) writer.PutCopy(prefix + array, checkpoint, array);
}

TrainedField GetOutline(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix) {
  TrainedField f;
  f.name = reader.StringAttribute(prefix + "name");
  f.steps = reader.IntAttribute(prefix + "steps");
  f.seconds = reader.DoubleAttribute(prefix + "seconds");
  f.samples = reader.IntAttribute(prefix + "samples");
  size_t next = 0;
  const auto number = [&] { return reader.DoubleAttribute(prefix + "describe" + std::to_string(next++)); };
  const auto integer = [&] { return static_cast<int>(std::lround(number())); };
  auto& g = f.config.grid;
  g.levels = integer();
  g.features = integer();
  g.log2_table_size = integer();
  g.base_resolution = number();
  g.finest_resolution = number();
  for (double& edge : g.extent) edge = number();
  f.config.hidden = integer();
  f.config.color_hidden_layers = integer();
  f.config.sh_degree = integer();
  f.config.color_range = number();
  f.config.density_bias = number();
  const bool contracted = integer() != 0;
  Eigen::Vector3d min_enu, max_enu;
  for (auto* corner : {&min_enu, &max_enu, &f.core_min_enu, &f.core_max_enu}) {
    for (int axis = 0; axis < 3; ++axis) (*corner)[axis] = number();
  }
  f.margin_m = number();
  f.step_m = number();
  f.config.luminance = reader.HasAttribute(prefix + "luminance") && reader.IntAttribute(prefix + "luminance") != 0;
  f.occupancy.cell = static_cast<float>(reader.DoubleAttribute(prefix + "occupancy_cell"));
  f.blend_m = f.margin_m;
  try {
    // Absent in files from before there was a choice.
    if (reader.HasAttribute(prefix + "encoding")) f.config.encoding = encoding::KindNamed(reader.StringAttribute(prefix + "encoding"));
    if (reader.HasAttribute(prefix + "density_hidden_layers")) {
      f.config.density_hidden_layers = static_cast<int>(reader.IntAttribute(prefix + "density_hidden_layers"));
    }
    f.map = contracted ? encoding::SpaceMap::Slab(min_enu, max_enu) : encoding::SpaceMap::Box(min_enu, max_enu);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, std::string("holds an impossible field: ") + error.what(), kMend);
  }
  return f;
}

int64_t StoredParameters(const checkpoint::ArchiveReader& reader, const std::string& prefix) {
  return reader.Shape(prefix + "grid").at(0) + reader.Shape(prefix + "networks").at(0);
}

int64_t StoredCells(const checkpoint::ArchiveReader& reader, const std::string& prefix) {
  const std::vector<int64_t> shape = reader.Shape(prefix + "occupied");
  return std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>());
}

TrainedField GetField(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix) {
  TrainedField f = GetOutline(reader, file, prefix);
  try {
    f.grid = reader.Floats(prefix + "grid");
    f.networks = reader.Floats(prefix + "networks");
    f.Finish();
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, std::string("holds an impossible field: ") + error.what(), kMend);
  }
  const std::vector<int64_t> shape = reader.Shape(prefix + "occupied");
  f.occupancy.occupied = reader.Bytes(prefix + "occupied");
  f.occupancy.depth = reader.Floats(prefix + "occupancy_depth");
  if (shape.size() == 3) {
    for (int axis = 0; axis < 3; ++axis) f.occupancy.size[axis] = static_cast<int>(shape[static_cast<size_t>(2 - axis)]);
  }
  const auto cells = static_cast<size_t>(f.occupancy.CellCount());
  if (static_cast<int64_t>(f.grid.size()) != f.field->GridParameters() || static_cast<int64_t>(f.networks.size()) != f.field->NetworkParameters() ||
      cells == 0 || f.occupancy.occupied.size() != cells || f.occupancy.depth.size() != cells || !(f.occupancy.cell > 0.0F) || !(f.step_m > 0.0)) {
    throw base::InputError(file, "arrays and configuration of field '" + f.name + "' disagree", kMend);
  }
  return f;
}

}  // namespace skyquilt::render
