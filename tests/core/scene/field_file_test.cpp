#include "core/scene/field_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "core/base/errors.h"
#include "core/render/ray_engine.h"
#include "core/render/trained_field.h"
#include "tests/support/error_of.h"
#include "tests/support/random_field.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::scene {
namespace {

namespace fs = std::filesystem;

class TrainedFieldFile : public ::testing::Test {
 protected:
  static render::TrainedField Make(encoding::Kind kind, int density_hidden_layers) {
    render::TrainedField f = render::RandomField(4, {0, 0, 0}, {5, 5, 4}, 0.8, -1.0, false, kind, density_hidden_layers);
    f.name = "r0c0";
    f.steps = 70;
    return f;
  }
  fs::path Write(const render::TrainedField& f, const std::string& name) const {
    checkpoint::ArchiveWriter writer("block", 1);
    PutField(f, "a/", writer);
    writer.Commit(folder_.path() / name);
    return folder_.path() / name;
  }
  // The checkpoint of the field and the scene that is made from it.
  std::pair<fs::path, fs::path> WriteScene(const render::TrainedField& f) const {
    fs::path checkpoint = folder_ / "block.h5", scene = folder_ / "scene.h5";
    checkpoint::ArchiveWriter block("block", 1), writer("scene", 1);
    PutField(f, "", block);
    block.Commit(checkpoint);
    PutSceneField(f, checkpoint, "a/", writer);
    writer.Commit(scene);
    return {checkpoint, scene};
  }
  static render::TrainedField Read(const fs::path& file) { return GetField(checkpoint::ArchiveReader(file), file, "a/"); }
  // The same file with some attributes left out, and others set by `add`.
  fs::path Rewrite(
      const fs::path& file, const std::vector<std::string>& without,
      const std::function<void(checkpoint::ArchiveWriter&)>& add = [](checkpoint::ArchiveWriter&) {}) const {
    const checkpoint::ArchiveReader reader(file);
    checkpoint::ArchiveWriter writer(reader.kind(), reader.version());
    for (const std::string& name : reader.Names()) writer.PutCopy(name, file, name);
    for (const std::string& name : reader.AttributeNames()) {
      if (std::find(without.begin(), without.end(), name) == without.end()) CopyAttribute(reader, name, writer);
    }
    add(writer);
    fs::path rewritten = folder_.path() / "rewritten.h5";
    writer.Commit(rewritten);
    return rewritten;
  }
  // The type is found by trying.
  static void CopyAttribute(const checkpoint::ArchiveReader& reader, const std::string& name, checkpoint::ArchiveWriter& writer) {
    try {
      return writer.SetAttribute(name, reader.StringAttribute(name));
    } catch (const base::InputError&) {
    }
    try {
      return writer.SetAttribute(name, reader.IntAttribute(name));
    } catch (const base::InputError&) {
    }
    writer.SetAttribute(name, reader.DoubleAttribute(name));
  }
  static std::vector<render::RayColor> Look(const render::TrainedField& f) {
    render::FieldSet set;
    set.blocks = {&f};
    std::vector<render::Ray> rays;
    rays.reserve(40);
    for (int i = 0; i < 40; ++i) rays.push_back({{0.12 * i, 5.0 - 0.1 * i, 9.0}, Eigen::Vector3d(0.1, 0.05, -1.0).normalized()});
    std::vector<render::RayColor> out(rays.size());
    base::ThreadPool threads(1);
    render::RenderRays(set, rays, out, {}, threads);
    return out;
  }

  // Both render the same bits, and at least one ray has this opacity.
  static void ExpectSameLook(const render::TrainedField& before, const render::TrainedField& after, float least) {
    const std::vector<render::RayColor> seen_before = Look(before), seen_after = Look(after);
    float most = 0.0F;
    for (size_t i = 0; i < seen_before.size(); ++i) {
      EXPECT_EQ(seen_after[i].opacity, seen_before[i].opacity);
      for (size_t c = 0; c < 3; ++c) EXPECT_EQ(seen_after[i].rgb_srgb[c], seen_before[i].rgb_srgb[c]);
      most = std::max(most, seen_before[i].opacity);
    }
    EXPECT_GT(most, least);
  }

  TemporaryFolder folder_;
};

class TrainedFieldOf : public TrainedFieldFile, public ::testing::WithParamInterface<encoding::Kind> {};

TEST_P(TrainedFieldOf, ComesBackAsItWas) {
  const render::TrainedField before = Make(GetParam(), 3);
  const fs::path file = Write(before, "field.h5");
  const render::TrainedField after = Read(file);
  EXPECT_EQ(after.config.encoding, GetParam());
  EXPECT_EQ(after.config.density_hidden_layers, 3);
  EXPECT_EQ(after.field->encoding().kind(), GetParam());
  EXPECT_EQ(after.parameters.grid, before.parameters.grid);
  EXPECT_EQ(after.parameters.networks, before.parameters.networks);
  const checkpoint::ArchiveReader reader(file);
  EXPECT_EQ(StoredParameterCount(reader, "a/"), before.ParameterCount());
  ExpectSameLook(before, after, 0.1F);
}

INSTANTIATE_TEST_SUITE_P(Kinds, TrainedFieldOf,
                         ::testing::Values(encoding::Kind::kHash, encoding::Kind::kVoxels, encoding::Kind::kPlanes, encoding::Kind::kFrequency),
                         [](const auto& of) { return encoding::Name(of.param); });

TEST_F(TrainedFieldFile, WithoutANumberThatRebuildsItIsRefused) {
  const fs::path file = Write(Make(encoding::Kind::kHash, 1), "field.h5");
  for (const char* name : {"a/encoding", "a/levels", "a/density_hidden_layers", "a/min_enu_x", "a/luminance"}) {
    const fs::path lacking = Rewrite(file, {name});
    EXPECT_THROW(Read(lacking), base::InputError) << name;
  }
}

// The numbers that rebuild a field, in the order of kNames.
std::vector<double> Numbered(const render::TrainedField& f) {
  const auto& g = f.config.grid;
  std::vector<double> numbers = {static_cast<double>(g.levels),
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
  for (const auto& corner : {f.map.min_enu(), f.map.max_enu(), f.box.min_enu, f.box.max_enu}) {
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(corner[axis]);
  }
  numbers.push_back(f.box.margin_m);
  numbers.push_back(f.step_m);
  return numbers;
}

// Their names in files.
const std::vector<std::string> kNames = {
    "levels",         "features",       "log2_table_size",     "base_resolution", "finest_resolution", "extent_x",     "extent_y",
    "extent_z",       "hidden",         "color_hidden_layers", "sh_degree",       "color_range",       "density_bias", "contracted",
    "min_enu_x",      "min_enu_y",      "min_enu_z",           "max_enu_x",       "max_enu_y",         "max_enu_z",    "core_min_enu_x",
    "core_min_enu_y", "core_min_enu_z", "core_max_enu_x",      "core_max_enu_y",  "core_max_enu_z",    "margin_m",     "step_m"};

TEST_F(TrainedFieldFile, HasANameForEveryNumber) {
  for (const bool contracted : {false, true}) {
    render::TrainedField before = render::RandomField(4, {1, 2, 3}, {6, 6.5, 7}, 0.8, -1.0, contracted);
    // All values differ, so that exchanged numbers are noticed.
    before.config.grid.features = 2;
    before.config.color_hidden_layers = 2;
    before.config.color_range = 1.125;
    checkpoint::ArchiveWriter writer("block", 1);
    PutDescription(before, "a/", writer);
    const fs::path file = folder_.path() / "description.h5";
    writer.Commit(file);
    const checkpoint::ArchiveReader reader(file);
    EXPECT_EQ(Numbered(GetDescription(reader, file, "a/")), Numbered(before));
    for (size_t i = 0; i < kNames.size(); ++i) {
      const std::string name = "a/" + kNames[i];
      const bool whole = i < 3 || (i >= 8 && i <= 10) || i == 13;
      EXPECT_EQ(whole ? static_cast<double>(reader.IntAttribute(name)) : reader.DoubleAttribute(name), Numbered(before)[i]) << name;
    }
  }
}

// Table entries that a scene leaves out are never read.
TEST_P(TrainedFieldOf, RendersTheSameWithoutUnreadEntries) {
  render::TrainedField before = Make(GetParam(), 1);
  base::Random random(8);
  for (auto&& cell : before.occupancy.occupied) cell = random.Uniform() < 0.05F;
  const auto [checkpoint, scene] = WriteScene(before);
  const checkpoint::ArchiveReader reader(scene);
  render::TrainedField after = Read(scene);
  EXPECT_EQ(ParameterCountOf(after), before.ParameterCount());
  if (GetParam() == encoding::Kind::kHash) {
    EXPECT_LT(StoredParameterCount(reader, "a/"), before.ParameterCount() * 9 / 10);
  } else {
    EXPECT_EQ(StoredParameterCount(reader, "a/"), before.ParameterCount());
  }
  // Entries that are not in the file are read as zero; the random field has no zero entries.
  ASSERT_EQ(after.parameters.grid.size(), before.parameters.grid.size());
  for (size_t i = 0; i < after.parameters.grid.size(); ++i) {
    if (after.parameters.grid[i] == 0.0F) {
      after.parameters.grid[i] = std::nanf("");
    } else {
      ASSERT_EQ(after.parameters.grid[i], before.parameters.grid[i]);
    }
  }
  ExpectSameLook(before, after, 0.01F);
}

// A field with cones whose networks fit its configuration.
render::TrainedField ConesOf(int multisample, bool scale_features, uint64_t seed = 4) {
  render::TrainedField f = render::RandomField(seed, {0, 0, 0}, {5, 5, 4}, 0.8, -1.0);
  f.config.multisample = multisample;
  f.config.scale_features = scale_features;
  base::Random random(seed);
  const field::HashField shape(f.config);
  std::vector<float> grid(f.parameters.grid.size());
  f.parameters.networks.resize(static_cast<size_t>(shape.NetworkParameters()));
  shape.Initialize(random, grid, f.parameters.networks);
  f.footprint_min_m = 0.1 / 3.0;
  f.footprint_max_m = 0.7;
  f.BuildNetworks();
  return f;
}

// In the checkpoint of a block, and in the scene that is made from it.
TEST_F(TrainedFieldFile, KeepsItsFootprints) {
  for (const auto& [multisample, scale_features] : {std::pair(1, false), {1, true}, {4, false}, {6, false}, {6, true}}) {
    const render::TrainedField before = ConesOf(multisample, scale_features);
    const auto [checkpoint, scene] = WriteScene(before);
    for (const render::TrainedField& after : {GetField(checkpoint::ArchiveReader(checkpoint), checkpoint, ""), Read(scene)}) {
      EXPECT_EQ(after.config.multisample, multisample);
      EXPECT_EQ(after.config.scale_features, scale_features);
      EXPECT_EQ(after.field->config().multisample, multisample);
      EXPECT_EQ(after.field->FeatureRows(), before.field->FeatureRows());
      EXPECT_EQ(after.footprint_min_m, before.footprint_min_m);
      EXPECT_EQ(after.footprint_max_m, before.footprint_max_m);
      ExpectSameLook(before, after, 0.1F);
    }
  }
}

// Several positions of a sample are also outside its cell.
TEST_F(TrainedFieldFile, OfASceneRendersTheSameWithAnyNumberOfPositions) {
  for (const int multisample : {1, 4, 6}) {
    render::TrainedField before = ConesOf(multisample, false);
    before.footprint_min_m = 0.5;
    base::Random random(8);
    for (auto&& cell : before.occupancy.occupied) cell = random.Uniform() < 0.05F;
    const auto [checkpoint, scene] = WriteScene(before);
    ExpectSameLook(before, Read(scene), 0.01F);
  }
}

// A file without a head has no attribute of it, as files of programs that knew none.
TEST_F(TrainedFieldFile, KeepsItsNormalHead) {
  const render::TrainedField plain = ConesOf(1, true);
  const fs::path without = Write(plain, "plain.h5");
  EXPECT_FALSE(checkpoint::ArchiveReader(without).HasAttribute("a/normal_head"));
  EXPECT_FALSE(Read(without).config.normal_head);
  const render::TrainedField before = render::WithHead(ConesOf(1, true), 3);
  const fs::path with = Write(before, "head.h5");
  const render::TrainedField after = Read(with);
  EXPECT_TRUE(after.config.normal_head);
  EXPECT_EQ(after.weights.normal_head, before.weights.normal_head);
  ExpectSameLook(plain, after, 0.1F);
  EXPECT_NE(InputErrorOf([&] { Read(Rewrite(with, {"a/normal_head"})); }), "") << "weights without a head";
}

// With another activation and codes, whose networks are larger.
render::TrainedField FieldOf(field::DensityActivation activation, int appearance) {
  render::TrainedField f = render::RandomField(4, {0, 0, 0}, {5, 5, 4}, 0.8, -1.0);
  f.config.density_activation = activation;
  f.config.appearance = appearance;
  base::Random random(4);
  const field::HashField shape(f.config);
  std::vector<float> grid(f.parameters.grid.size());
  f.parameters.networks.resize(static_cast<size_t>(shape.NetworkParameters()));
  shape.Initialize(random, grid, f.parameters.networks);
  f.BuildNetworks();
  return f;
}

// In the checkpoint of a block and in the scene; files of default fields know nothing of either.
TEST_F(TrainedFieldFile, KeepsItsActivationAndItsRowsForCodes) {
  for (const auto& [activation, appearance] : {std::pair(field::DensityActivation::kExp, 0),
                                               {field::DensityActivation::kSoftplus, 0},
                                               {field::DensityActivation::kRelu, 5},
                                               {field::DensityActivation::kExp, 32}}) {
    const render::TrainedField before = FieldOf(activation, appearance);
    const auto [checkpoint, scene] = WriteScene(before);
    const checkpoint::ArchiveReader reader(checkpoint);
    EXPECT_EQ(reader.HasAttribute("density_activation"), activation != field::DensityActivation::kExp);
    EXPECT_EQ(reader.HasAttribute("appearance"), appearance > 0);
    for (const render::TrainedField& after : {GetField(reader, checkpoint, ""), Read(scene)}) {
      EXPECT_EQ(after.config.density_activation, activation);
      EXPECT_EQ(after.config.appearance, appearance);
      EXPECT_EQ(after.field->ColorInputRows(), before.field->ColorInputRows());
      ExpectSameLook(before, after, 0.1F);
    }
  }
}

TEST_F(TrainedFieldFile, WithAnUnknownActivationOrImpossibleCodesIsRefused) {
  const fs::path file = Write(FieldOf(field::DensityActivation::kRelu, 5), "field.h5");
  const auto refused = [&](const fs::path& rewritten, const std::string& why) {
    const checkpoint::ArchiveReader reader(rewritten);
    const std::string error = InputErrorOf([&] { Read(rewritten); });
    EXPECT_NE(error.find("rewritten.h5"), std::string::npos) << error;
    EXPECT_NE(error.find(why), std::string::npos) << error;
  };
  const auto set = [](const std::string& name, const auto& value) {
    return [name, value](checkpoint::ArchiveWriter& writer) { writer.SetAttribute(name, value); };
  };
  refused(Rewrite(file, {"a/density_activation"}, set("a/density_activation", std::string("square"))), "got \"square\"");
  for (const int numbers : {-1, 33, 1000}) refused(Rewrite(file, {"a/appearance"}, set("a/appearance", numbers)), "appearance must be 0..32");
  // Networks that were trained with another number of inputs.
  refused(Rewrite(file, {"a/appearance"}, set("a/appearance", 9)), "disagree");
  refused(Rewrite(file, {"a/appearance"}), "disagree");
  EXPECT_EQ(Read(Rewrite(file, {"a/density_activation"})).config.density_activation, field::DensityActivation::kExp) << "as older files";
}

// As every file of a program without cones.
TEST_F(TrainedFieldFile, WithoutFootprintsIsAFieldOfPoints) {
  const render::TrainedField points = Make(encoding::Kind::kHash, 1);
  const fs::path of_points = Write(points, "points.h5");
  for (const std::string& name : checkpoint::ArchiveReader(of_points).AttributeNames()) {
    EXPECT_EQ(name.find("multisample"), std::string::npos) << name;
    EXPECT_EQ(name.find("footprint"), std::string::npos) << name;
  }
  render::TrainedField cones = Make(encoding::Kind::kHash, 1);
  cones.config.multisample = 1;
  cones.footprint_min_m = 1.0;
  cones.footprint_max_m = 2.0;
  const render::TrainedField after =
      Read(Rewrite(Write(cones, "cones.h5"), {"a/multisample", "a/scale_features", "a/footprint_min_m", "a/footprint_max_m"}));
  EXPECT_FALSE(after.config.Cones());
  EXPECT_EQ(after.footprint_min_m, 0.0);
  EXPECT_EQ(after.footprint_max_m, std::numeric_limits<double>::infinity());
  ExpectSameLook(points, after, 0.1F);
}

TEST_F(TrainedFieldFile, WithImpossibleFootprintsIsRefused) {
  render::TrainedField field = Make(encoding::Kind::kHash, 1);
  field.config.multisample = 1;
  const std::pair<double, double> ranges[] = {{0.5, 0.4}, {-0.1, 0.4}, {std::nan(""), 0.4}, {0.1, std::nan("")}};
  for (const auto& [low, high] : ranges) {
    field.footprint_min_m = low;
    field.footprint_max_m = high;
    const std::string error = InputErrorOf([&, file = Write(field, "field.h5")] { Read(file); });
    EXPECT_NE(error.find("footprints"), std::string::npos) << low << " " << high << ": " << error;
  }
}

// Also where only the description is read, as for a scene that is larger than the memory.
TEST_F(TrainedFieldFile, WithImpossiblePositionsIsRefused) {
  const fs::path cones = Write(ConesOf(1, true), "field.h5");
  const std::vector<std::string> names = {"a/multisample", "a/scale_features"};
  for (const auto& [multisample, scale_features, why] :
       {std::tuple(3, 0, "multisample"), {-1, 0, "multisample"}, {1000, 1, "multisample"}, {0, 1, "scale_features"}}) {
    const fs::path file = Rewrite(cones, names, [&, m = multisample, f = scale_features](checkpoint::ArchiveWriter& writer) {
      writer.SetAttribute("a/multisample", m);
      writer.SetAttribute("a/scale_features", f);
    });
    const checkpoint::ArchiveReader reader(file);
    for (const std::string& error : {InputErrorOf([&] { Read(file); }), InputErrorOf([&] { GetDescription(reader, file, "a/"); })}) {
      EXPECT_NE(error.find("rewritten.h5"), std::string::npos) << error;
      EXPECT_NE(error.find(why), std::string::npos) << error;
    }
  }
  // Networks that were trained with another number of inputs.
  const fs::path without =
      Rewrite(cones, {"a/scale_features"}, [](checkpoint::ArchiveWriter& writer) { writer.SetAttribute("a/scale_features", 0); });
  EXPECT_NE(InputErrorOf([&] { Read(without); }).find("disagree"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { Read(Rewrite(cones, {"a/scale_features"})); }).find("scale_features"), std::string::npos);
}

TEST_F(TrainedFieldFile, WithImpossibleValuesAreRefusedByName) {
  const auto refused = [&](const fs::path& file, const std::string& why) {
    const std::string error = InputErrorOf([&] { Read(file); });
    EXPECT_NE(error.find("rewritten.h5"), std::string::npos) << why << ": " << error;
    EXPECT_NE(error.find(why), std::string::npos) << error;
  };
  const fs::path planes = Write(Make(encoding::Kind::kPlanes, 2), "field.h5");
  const auto encoded = [](const std::string& name) { return [name](checkpoint::ArchiveWriter& writer) { writer.SetAttribute("a/encoding", name); }; };
  refused(Rewrite(planes, {"a/encoding"}, encoded("cubes")), "cubes");
  refused(Rewrite(planes, {"a/encoding"}, encoded("hash")), "disagree");
  refused(Rewrite(planes, {"a/density_hidden_layers"}), "density_hidden_layers");
  refused(Rewrite(planes, {"a/log2_table_size"}), "log2_table_size");
}

}  // namespace
}  // namespace skyquilt::scene
