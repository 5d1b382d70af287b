#include "core/scene/field_file.h"

#include <functional>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include "core/base/errors.h"
#include "core/encoding/hash_grid.h"
#include "core/field/used_entries.h"

namespace skyquilt::scene {
namespace {

constexpr const char* kFix = "Train it again with --restart";
constexpr int64_t kMaxCellsPerAxis = int64_t{1} << 20;

// The box from which a field's map was made.
struct Box {
  bool contracted = false;
  Eigen::Vector3d min_enu, max_enu;
};

// Calls visit(name, number) for every number (int or double, by reference) that is needed to rebuild a field.
template <typename Field, typename BoxOf, typename Visit>
void VisitNumbers(Field& f, BoxOf& box, const Visit& visit) {
  const auto corner = [&visit](const std::string& name, auto& point) {
    visit(name + "_x", point[0]);
    visit(name + "_y", point[1]);
    visit(name + "_z", point[2]);
  };
  auto& g = f.config.grid;
  visit("levels", g.levels);
  visit("features", g.features);
  visit("log2_table_size", g.log2_table_size);
  visit("base_resolution", g.base_resolution);
  visit("finest_resolution", g.finest_resolution);
  corner("extent", g.extent);
  visit("hidden", f.config.hidden);
  visit("color_hidden_layers", f.config.color_hidden_layers);
  visit("sh_degree", f.config.sh_degree);
  visit("color_range", f.config.color_range);
  visit("density_bias", f.config.density_bias);
  visit("contracted", box.contracted);
  corner("min_enu", box.min_enu);
  corner("max_enu", box.max_enu);
  corner("core_min_enu", f.box.min_enu);
  corner("core_max_enu", f.box.max_enu);
  visit("margin_m", f.box.margin_m);
  visit("step_m", f.step_m);
}

// One bit per cell, the first in the lowest bit. Flags: a vector of bool, or of 0 and 1.
template <typename Flags>
std::vector<uint8_t> PackBits(const Flags& flags) {
  std::vector<uint8_t> bits((flags.size() + 7) / 8, 0);
  for (size_t i = 0; i < flags.size(); ++i) {
    if (static_cast<bool>(flags[i])) bits[i / 8] = static_cast<uint8_t>(bits[i / 8] | 1U << i % 8);
  }
  return bits;
}

template <typename Flags>
Flags UnpackBits(const std::vector<uint8_t>& bits, size_t n) {
  Flags flags(n);
  for (size_t i = 0; i < n && i / 8 < bits.size(); ++i) flags[i] = (bits[i / 8] >> i % 8 & 1U) != 0;
  return flags;
}

// Cells per axis of a field in a file, x first. Throws base::InputError as the reader does.
std::vector<int64_t> StoredSize(const checkpoint::ArchiveReader& reader, const std::string& prefix) {
  if (reader.Has(prefix + "occupancy_size")) return reader.Ints(prefix + "occupancy_size");
  const std::vector<int64_t> shape = reader.Shape(prefix + "occupied");
  return {shape.rbegin(), shape.rend()};
}

// Which of `cells` cells of a field in a file are occupied; of another size where the file has another number. Checkpoints of older programs have a
// byte per cell. Throws base::InputError as the reader does.
std::vector<bool> StoredOccupied(const checkpoint::ArchiveReader& reader, const std::string& prefix, size_t cells) {
  if (!reader.Has(prefix + "occupied_bits")) {
    const std::vector<uint8_t> bytes = reader.Bytes(prefix + "occupied");
    return {bytes.begin(), bytes.end()};
  }
  const std::vector<uint8_t> bits = reader.Bytes(prefix + "occupied_bits");
  if (bits.size() != (cells + 7) / 8) return {};
  return UnpackBits<std::vector<bool>>(bits, cells);
}

// False for a size that no grid can have.
bool SetSize(const std::vector<int64_t>& size, field::OccupancyGrid* occupancy) {
  if (size.size() != 3) return false;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (size[axis] <= 0 || size[axis] > kMaxCellsPerAxis) return false;
    occupancy->size[axis] = static_cast<int>(size[axis]);
  }
  return true;
}

}  // namespace

void PutDescription(const render::TrainedField& f, const std::string& prefix, checkpoint::ArchiveWriter& writer) {
  writer.SetAttribute(prefix + "name", f.name);
  writer.SetAttribute(prefix + "steps", f.steps);
  writer.SetAttribute(prefix + "seconds", f.seconds);
  writer.SetAttribute(prefix + "samples", f.samples);
  const Box box{f.map.contracted(), f.map.min_enu(), f.map.max_enu()};
  VisitNumbers(f, box, [&](const std::string& name, const auto& number) { writer.SetAttribute(prefix + name, number); });
  writer.SetAttribute(prefix + "encoding", encoding::Name(f.config.encoding));
  writer.SetAttribute(prefix + "density_hidden_layers", f.config.density_hidden_layers);
  writer.SetAttribute(prefix + "luminance", f.config.luminance ? 1 : 0);
  if (f.config.normal_head) writer.SetAttribute(prefix + "normal_head", 1);
  if (f.config.density_activation != field::DensityActivation::kExp) {
    writer.SetAttribute(prefix + "density_activation", field::Name(f.config.density_activation));
  }
  if (f.config.appearance > 0) writer.SetAttribute(prefix + "appearance", f.config.appearance);
  if (f.config.Cones()) {
    writer.SetAttribute(prefix + "multisample", f.config.multisample);
    writer.SetAttribute(prefix + "scale_features", f.config.scale_features ? 1 : 0);
    writer.SetAttribute(prefix + "footprint_min_m", f.footprint_min_m);
    writer.SetAttribute(prefix + "footprint_max_m", f.footprint_max_m);
  }
  writer.SetAttribute(prefix + "occupancy_cell", static_cast<double>(f.occupancy.cell));
}

void PutField(const render::TrainedField& f, const std::string& prefix, checkpoint::ArchiveWriter& writer) {
  PutDescription(f, prefix, writer);
  writer.Put(prefix + "grid", f.parameters.grid);
  writer.Put(prefix + "networks", f.parameters.networks);
  const auto& size = f.occupancy.size;
  writer.PutOwned(prefix + "occupied_bits", PackBits(f.occupancy.occupied));
  writer.PutOwned(prefix + "occupancy_size", std::vector<int64_t>(std::begin(size), std::end(size)));
  writer.Put(prefix + "occupancy_tau", f.occupancy.tau, {size[2], size[1], size[0]});
  writer.PutOwned(prefix + "judged_bits", PackBits(f.occupancy.judged));
}

void PutSceneField(const render::TrainedField& description, const std::filesystem::path& checkpoint, const std::string& prefix,
                   checkpoint::ArchiveWriter& writer, checkpoint::Precision tables, std::span<const float> code) {
  PutDescription(description, prefix, writer);
  const checkpoint::ArchiveReader reader(checkpoint);
  const std::vector<int64_t> size = StoredSize(reader, "");
  field::OccupancyGrid occupancy = description.occupancy;
  const bool fits = occupancy.cell > 0.0F && SetSize(size, &occupancy);
  if (fits) occupancy.occupied = StoredOccupied(reader, "", static_cast<size_t>(occupancy.CellCount()));
  if (!fits || occupancy.CellCount() != static_cast<int64_t>(occupancy.occupied.size()))
    throw base::InputError(checkpoint, "its occupancy grid has an impossible size", kFix);
  if (description.config.encoding == encoding::Kind::kHash) {
    if (reader.Shape("grid") != std::vector<int64_t>{encoding::HashGrid(description.config.grid).ParameterCount()}) {
      throw base::InputError(checkpoint, "the size of its hash tables disagrees with its configuration", kFix);
    }
  }
  // Several positions of a sample reach beyond its cell, as far as its pixel is wide: they can read any entry.
  if (description.config.encoding == encoding::Kind::kHash && description.config.multisample <= 1) {
    const encoding::HashGrid grid(description.config.grid);
    writer.PutPruned(prefix + "grid", checkpoint, "grid", field::UsedEntries(grid, occupancy), grid.features(), tables);
  } else {
    writer.PutCopy(prefix + "grid", checkpoint, "grid", tables);
  }
  if (code.empty()) {
    writer.PutCopy(prefix + "networks", checkpoint, "networks");
  } else {
    std::vector<float> networks = reader.Floats("networks");
    const field::HashField shape(description.config);
    if (static_cast<int64_t>(networks.size()) != shape.NetworkParameters()) {
      throw base::InputError(checkpoint, "the size of its networks disagrees with its configuration", kFix);
    }
    shape.FoldAppearance(code, networks);
    writer.PutOwned(prefix + "networks", std::move(networks));
  }
  // Rendering only needs to know whether a cell is occupied.
  writer.PutOwned(prefix + "occupied_bits", PackBits(occupancy.occupied));
  writer.PutOwned(prefix + "occupancy_size", size);
}

render::TrainedField GetDescription(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix) {
  render::TrainedField f;
  f.name = reader.StringAttribute(prefix + "name");
  f.steps = reader.IntAttribute(prefix + "steps");
  f.seconds = reader.DoubleAttribute(prefix + "seconds");
  f.samples = reader.IntAttribute(prefix + "samples");
  Box box;
  VisitNumbers(f, box, [&](const std::string& name, auto& number) {
    using Number = std::remove_reference_t<decltype(number)>;
    if constexpr (std::is_same_v<Number, double>) {
      number = reader.DoubleAttribute(prefix + name);
    } else {
      number = static_cast<Number>(reader.IntAttribute(prefix + name));
    }
  });
  f.config.luminance = reader.IntAttribute(prefix + "luminance") != 0;
  // Missing in files of fields without one.
  f.config.normal_head = reader.HasAttribute(prefix + "normal_head") && reader.IntAttribute(prefix + "normal_head") != 0;
  // Missing in files of fields with exp and without codes.
  if (reader.HasAttribute(prefix + "appearance")) f.config.appearance = static_cast<int>(reader.IntAttribute(prefix + "appearance"));
  f.config.density_hidden_layers = static_cast<int>(reader.IntAttribute(prefix + "density_hidden_layers"));
  f.occupancy.cell = static_cast<float>(reader.DoubleAttribute(prefix + "occupancy_cell"));
  // Missing in files of programs without cones.
  if (reader.HasAttribute(prefix + "multisample")) {
    f.config.multisample = static_cast<int>(reader.IntAttribute(prefix + "multisample"));
    f.config.scale_features = reader.IntAttribute(prefix + "scale_features") != 0;
    f.footprint_min_m = reader.DoubleAttribute(prefix + "footprint_min_m");
    f.footprint_max_m = reader.DoubleAttribute(prefix + "footprint_max_m");
    if (!(f.footprint_min_m >= 0.0 && f.footprint_min_m <= f.footprint_max_m)) {
      throw base::InputError(file, "its footprints have an impossible range", kFix);
    }
  }
  f.blend_m = f.box.margin_m;
  try {
    f.config.encoding = encoding::KindNamed(reader.StringAttribute(prefix + "encoding"));
    if (reader.HasAttribute(prefix + "density_activation")) {
      f.config.density_activation = field::DensityActivationNamed(reader.StringAttribute(prefix + "density_activation"));
    }
    f.map = box.contracted ? encoding::SpaceMap::Contracted(box.min_enu, box.max_enu) : encoding::SpaceMap::Box(box.min_enu, box.max_enu);
    const field::HashField checked(f.config);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, std::string("its field has an impossible configuration: ") + error.what(), kFix);
  }
  return f;
}

int64_t StoredParameterCount(const checkpoint::ArchiveReader& reader, const std::string& prefix) {
  return reader.Shape(prefix + "grid").at(0) + reader.Shape(prefix + "networks").at(0);
}

int64_t ParameterCountOf(const render::TrainedField& description) {
  const field::HashField field(description.config);
  return field.GridParameters() + field.NetworkParameters();
}

int64_t StoredCellCount(const checkpoint::ArchiveReader& reader, const std::string& prefix) {
  const std::vector<int64_t> size = StoredSize(reader, prefix);
  return std::accumulate(size.begin(), size.end(), int64_t{1}, std::multiplies<>());
}

render::TrainedField GetField(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix) {
  render::TrainedField f = GetDescription(reader, file, prefix);
  try {
    f.parameters.grid = reader.PrunedFloats(prefix + "grid");
    f.parameters.networks = reader.Floats(prefix + "networks");
    f.BuildNetworks();
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, std::string("its field has an impossible configuration: ") + error.what(), kFix);
  }
  const std::vector<int64_t> size = StoredSize(reader, prefix);
  bool fits = SetSize(size, &f.occupancy);
  const auto cells = static_cast<size_t>(fits ? f.occupancy.CellCount() : 0);
  f.occupancy.occupied = StoredOccupied(reader, prefix, cells);
  fits = fits && f.occupancy.occupied.size() == cells;
  const bool is_checkpoint = reader.Has(prefix + "judged_bits") || !reader.Has(prefix + "occupied_bits");
  if (is_checkpoint) {
    f.occupancy.tau = reader.Floats(prefix + "occupancy_tau");
    fits = fits && f.occupancy.tau.size() == cells;
    // In checkpoints of older programs all cells were judged by sharp samples alone.
    const std::vector<uint8_t> all((cells + 7) / 8, 0xFFU);
    f.occupancy.judged = UnpackBits<std::vector<uint8_t>>(reader.Has(prefix + "judged_bits") ? reader.Bytes(prefix + "judged_bits") : all, cells);
  }
  if (!fits || static_cast<int64_t>(f.parameters.grid.size()) != f.field->GridParameters() ||
      static_cast<int64_t>(f.parameters.networks.size()) != f.field->NetworkParameters() || !(f.occupancy.cell > 0.0F) || !(f.step_m > 0.0)) {
    throw base::InputError(file, "the sizes of the arrays of field '" + f.name + "' disagree with its configuration", kFix);
  }
  return f;
}

}  // namespace skyquilt::scene
