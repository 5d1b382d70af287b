#include "core/scene/field_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/base/errors.h"
#include "core/render/ray_engine.h"
#include "core/render/trained_field.h"
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
  static render::TrainedField Read(const fs::path& file) { return GetField(checkpoint::ArchiveReader(file), file, "a/"); }
  // The same file with some attributes left out, and others set.
  fs::path Rewrite(const fs::path& file, const std::vector<std::string>& without, const std::string& text, const std::string& value) const {
    const checkpoint::ArchiveReader reader(file);
    checkpoint::ArchiveWriter writer(reader.kind(), reader.version());
    for (const std::string& name : reader.Names()) writer.PutCopy(name, file, name);
    for (const std::string& name : reader.AttributeNames()) {
      if (name.rfind("skyquilt.", 0) == 0 || std::find(without.begin(), without.end(), name) != without.end()) continue;
      if (name == "a/name" || name == "a/encoding") {
        writer.SetAttribute(name, reader.StringAttribute(name));
      } else if (name.rfind("a/describe", 0) == 0 || name == "a/seconds" || name == "a/occupancy_cell") {
        writer.SetAttribute(name, reader.DoubleAttribute(name));
      } else {
        writer.SetAttribute(name, reader.IntAttribute(name));
      }
    }
    if (!text.empty()) writer.SetAttribute(text, value);
    const fs::path rewritten = folder_.path() / "rewritten.h5";
    writer.Commit(rewritten);
    return rewritten;
  }
  static std::vector<render::RayColor> Look(const render::TrainedField& f) {
    render::FieldSet set;
    set.blocks = {&f};
    std::vector<render::Ray> rays;
    for (int i = 0; i < 40; ++i) rays.push_back({{0.12 * i, 5.0 - 0.1 * i, 9.0}, Eigen::Vector3d(0.1, 0.05, -1.0).normalized()});
    std::vector<render::RayColor> out(rays.size());
    base::ThreadPool threads(1);
    render::RenderRays(set, rays, out, {}, threads);
    return out;
  }

  // The same to the bit, and something to see: some ray is at least so opaque.
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
  EXPECT_EQ(StoredParameters(reader, "a/"), before.ParameterCount());
  ExpectSameLook(before, after, 0.1F);
}

INSTANTIATE_TEST_SUITE_P(Kinds, TrainedFieldOf,
                         ::testing::Values(encoding::Kind::kHash, encoding::Kind::kVoxels, encoding::Kind::kPlanes, encoding::Kind::kFrequency),
                         [](const auto& of) { return encoding::Name(of.param); });

TEST_F(TrainedFieldFile, FromBeforeThereWereOtherEncodingsAreHashGridsOfOneLayer) {
  const render::TrainedField before = Make(encoding::Kind::kHash, 1);
  const fs::path old = Rewrite(Write(before, "field.h5"), {"a/encoding", "a/density_hidden_layers"}, "", "");
  ASSERT_FALSE(checkpoint::ArchiveReader(old).HasAttribute("a/encoding"));
  const render::TrainedField after = Read(old);
  EXPECT_EQ(after.config.encoding, encoding::Kind::kHash);
  EXPECT_EQ(after.config.density_hidden_layers, 1);
  EXPECT_EQ(after.parameters.networks, before.parameters.networks);
}

// What a scene leaves out may be anything: nothing looks at it.
TEST_P(TrainedFieldOf, LooksTheSameWithoutWhatNothingReads) {
  render::TrainedField before = Make(GetParam(), 1);
  base::Random random(8);
  for (uint8_t& cell : before.occupancy.occupied) cell = random.Uniform() < 0.05F ? 1 : 0;
  checkpoint::ArchiveWriter block("block", 1);
  PutField(before, "", block);
  const fs::path checkpoint = folder_.path() / "block.h5", scene = folder_.path() / "scene.h5";
  block.Commit(checkpoint);
  checkpoint::ArchiveWriter writer("scene", 1);
  PutFieldOf(before, checkpoint, "a/", writer);
  writer.Commit(scene);
  const checkpoint::ArchiveReader reader(scene);
  render::TrainedField after = Read(scene);
  EXPECT_EQ(HeldParameters(after), before.ParameterCount());
  if (GetParam() == encoding::Kind::kHash) {
    EXPECT_LT(StoredParameters(reader, "a/"), before.ParameterCount() * 9 / 10);
  } else {
    EXPECT_EQ(StoredParameters(reader, "a/"), before.ParameterCount());
  }
  // Zero was read back for what is not in the file: no entry of the random field is.
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

TEST_F(TrainedFieldFile, ThatCannotBeAreRefusedByName) {
  const auto refused = [&](const fs::path& file, const std::string& why) {
    try {
      Read(file);
      ADD_FAILURE() << "expected a refusal: " << why;
    } catch (const base::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("rewritten.h5"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  const fs::path planes = Write(Make(encoding::Kind::kPlanes, 2), "field.h5");
  refused(Rewrite(planes, {"a/encoding"}, "a/encoding", "cubes"), "cubes");
  refused(Rewrite(planes, {"a/encoding"}, "a/encoding", "hash"), "disagree");
  refused(Rewrite(planes, {"a/density_hidden_layers"}, "", ""), "disagree");
}

}  // namespace
}  // namespace skyquilt::scene
