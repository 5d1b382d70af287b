#include "tour/export/tile_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "tests/tour/export/sample_tour_project.h"
#include "tour/export/script_data.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::ordered_json;

class Tiles : public testing::Test {
 protected:
  Tiles() { WriteSampleTiles(folder_.path()); }
  TileTree Tree() const { return TileTree(folder_.path()); }

  TemporaryFolder folder_;
};

// Contents of a tile and what is below it. Checks what readers rely on: with replacement, a tile has all its children of the full tree or none.
void Collect(const Json& tile, const Json& full, std::set<std::string>* files) {
  files->insert(tile["content"]["uri"].get<std::string>());
  if (!tile.contains("children")) {
    EXPECT_EQ(tile["geometricError"], 0.0);
    return;
  }
  ASSERT_EQ(tile["children"].size(), full["children"].size());
  EXPECT_GT(tile["geometricError"], 0.0);
  for (size_t i = 0; i < tile["children"].size(); ++i) {
    EXPECT_LT(tile["children"][i]["geometricError"], tile["geometricError"]);
    Collect(tile["children"][i], full["children"][i], files);
  }
}

std::set<std::string> FilesOf(const TileTree& tree, const TileTree::Choice& choice) {
  const Json full = Json::parse(tree.Text(tree.All())), trimmed = Json::parse(tree.Text(choice));
  EXPECT_EQ(trimmed["geometricError"], full["geometricError"]);
  EXPECT_EQ(trimmed["root"]["transform"], full["root"]["transform"]);
  EXPECT_EQ(trimmed["root"]["refine"], "REPLACE");
  std::set<std::string> files, kept;
  Collect(trimmed["root"], full["root"], &files);
  int64_t bytes = ScriptBytes("tiles/tileset.json", static_cast<int64_t>(tree.Text(choice).size()));
  for (size_t i = 0; i < tree.nodes().size(); ++i) {
    if (!choice.kept[i]) continue;
    kept.insert(tree.nodes()[i].file);
    bytes += tree.nodes()[i].bytes;
  }
  EXPECT_EQ(files, kept) << "what is written is what tileset.json names";
  EXPECT_EQ(choice.tiles, kept.size());
  EXPECT_LE(bytes, choice.bytes);
  return files;
}

TEST_F(Tiles, AreAllThereWhenThereIsRoom) {
  const TileTree tree = Tree();
  EXPECT_EQ(FilesOf(tree, tree.All()).size(), 21U);
  EXPECT_EQ(FilesOf(tree, tree.Least()), std::set<std::string>{"2_0_0.glb"});
  const Eigen::Vector3d place(0.0, 0.0, 20.0);
  EXPECT_EQ(tree.Choose(tree.All().bytes, {&place, 1}).kept, tree.All().kept);
  EXPECT_EQ(tree.Choose(0, {&place, 1}).kept, tree.Least().kept);
  EXPECT_EQ(tree.Choose(tree.All().bytes, {}).kept, tree.All().kept);
}

TEST_F(Tiles, KeepToEveryLimitAndBecomeMore) {
  const TileTree tree = Tree();
  const Eigen::Vector3d place(10.0, 50.0, 20.0);
  size_t before = 0;
  for (int64_t limit = tree.Least().bytes; limit <= tree.All().bytes; limit += 700) {
    const TileTree::Choice choice = tree.Choose(limit, {&place, 1});
    EXPECT_LE(choice.bytes, limit);
    const size_t now = FilesOf(tree, choice).size();
    EXPECT_GE(now, before);
    before = now;
    // Nothing more would fit.
    for (size_t i = 0; i < tree.nodes().size(); ++i) {
      const TileTree::Node& node = tree.nodes()[i];
      if (!choice.kept[i] || node.children.empty() || choice.kept[node.children.front()]) continue;
      int64_t more = 0;
      for (const size_t child : node.children) more += tree.nodes()[child].bytes;
      EXPECT_GT(choice.bytes + more, limit);
    }
  }
}

TEST_F(Tiles, AreFinestNearThePlaces) {
  const TileTree tree = Tree();
  // The middle level and one quarter of the finest.
  int64_t limit = tree.Least().bytes;
  for (const TileTree::Node& node : tree.nodes()) {
    if (node.file.starts_with("1_")) limit += node.bytes;
    if (node.file == "0_0_0.glb") limit += 4 * node.bytes;
  }
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector3d place(10.0 + 44.0 * (corner % 2), 10.0 + 44.0 * (corner / 2), 15.0);
    const std::set<std::string> files = FilesOf(tree, tree.Choose(limit, {&place, 1}));
    EXPECT_EQ(files.size(), 9U);
    EXPECT_TRUE(files.contains("0_" + std::to_string(corner % 2 * 3) + "_" + std::to_string(corner / 2 * 3) + ".glb")) << corner;
  }
}

// As the writer makes it for a survey of several coarsest tiles.
TEST_F(Tiles, ARootWithoutContentHasItsChildren) {
  Json tileset = Json::parse(base::ReadFile(folder_ / "tileset.json"));
  tileset["root"].erase("content");
  base::WriteFileAtomically(folder_ / "tileset.json", base::JsonText(tileset));
  const TileTree tree = Tree();
  EXPECT_EQ(tree.Least().tiles, 4U);
  EXPECT_EQ(tree.All().tiles, 20U);
  const TileTree::Choice choice = tree.Choose(0, {});
  const Json least = Json::parse(tree.Text(choice));
  EXPECT_EQ(least["root"]["children"].size(), 4U);
  EXPECT_FALSE(least["root"]["children"][0].contains("children"));
}

TEST_F(Tiles, DamageIsNamed) {
  const std::string good = base::ReadFile(folder_ / "tileset.json");
  const auto expect_refused = [&](const std::string& from, const std::string& to) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    base::WriteFileAtomically(folder_ / "tileset.json", bad);
    EXPECT_THROW(Tree(), base::InputError) << to;
  };
  expect_refused("\"root\"", "\"tree\"");
  expect_refused("1_0_0.glb", "../../secret.glb");
  expect_refused("1_0_0.glb", "9_9_9.glb");
  expect_refused("\"box\"", "\"sphere\"");
  expect_refused("{", "[");
}

}  // namespace
}  // namespace skyquilt::tour
