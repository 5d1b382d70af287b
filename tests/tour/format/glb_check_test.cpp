// Models that are not what they should be.
#include "tour/format/glb_check.h"

#include <gtest/gtest.h>

#include "core/base/json_text.h"
#include "tests/support/error_of.h"
#include "tests/tour/format/sample_assets.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

std::string WhyNotGlb(const std::string& bytes) {
  return ErrorOf<base::Refused>([&] { CheckGlb(BytesOf(bytes)); });
}

std::string WhyNotGlb(const std::function<void(Json&)>& change) {
  return WhyNotGlb(SampleGlb(change));
}

TEST(GlbCheck, AcceptsAWholeModel) {
  EXPECT_EQ(WhyNotGlb(SampleGlb()), "");
  EXPECT_EQ(WhyNotGlb([](Json& json) { json["extensionsRequired"] = {"KHR_texture_transform", "KHR_materials_unlit"}; }), "");
  EXPECT_EQ(WhyNotGlb([](Json& json) { json["extensionsUsed"] = {"OWN_anything"}; }), "");
  EXPECT_EQ(WhyNotGlb([](Json& json) { json["accessors"][0]["count"] = 3.0; }), "");
}

TEST(GlbCheck, EveryTruncationIsRefused) {
  const std::string whole = SampleGlb();
  for (size_t length = 0; length < whole.size(); ++length) EXPECT_NE(WhyNotGlb(whole.substr(0, length)), "") << length;
  EXPECT_NE(WhyNotGlb(whole + "PK\x03\x04").find("after the end"), std::string::npos) << "also an archive";
}

TEST(GlbCheck, PartsFillTheFile) {
  const SampleModel model;
  const std::string json = GlbChunk("JSON", base::JsonText(model.json), ' '), binary = GlbChunk(std::string("BIN\0", 4), model.binary, '\0');
  ASSERT_EQ(WhyNotGlb(GlbOfChunks(json + binary)), "");
  EXPECT_NE(WhyNotGlb(GlbOfChunks(json + binary, 1)).find("version 2"), std::string::npos);
  for (const std::string& chunks :
       {std::string(), binary + json, json + json, json + binary + binary, json + binary + GlbChunk("HTML", "<script>", ' '), json + binary + "abc",
        json + binary + std::string(4, '\0'), binary, GlbChunk("JSON", "", ' ') + binary}) {
    EXPECT_NE(WhyNotGlb(GlbOfChunks(chunks)), "") << chunks.size();
  }
  std::string long_chunk = GlbOfChunks(json + binary);
  long_chunk[12] = static_cast<char>(long_chunk[12] + 4);
  EXPECT_NE(WhyNotGlb(long_chunk), "");
  std::string endless = GlbOfChunks(json + binary);
  endless.replace(12, 4, "\xFC\xFF\xFF\xFF");
  EXPECT_NE(WhyNotGlb(endless), "");
  EXPECT_NE(WhyNotGlb(GlbOfChunks(GlbChunk("JSON", "{\"asset\":", ' ') + binary)), "");
  EXPECT_NE(WhyNotGlb(GlbOfChunks(GlbChunk("JSON", std::string(100'000, '['), ' ') + binary)), "");
  EXPECT_NE(WhyNotGlb(GlbOfChunks(GlbChunk("JSON", std::string(5U << 20U, ' '), ' ') + binary)).find("4 MiB"), std::string::npos);
}

TEST(GlbCheck, NothingOutsideOfTheFileIsRead) {
  for (const char* uri : {"other.bin", "https://example.org/x.bin", "data:application/octet-stream;base64,AAAA", "../../etc/passwd", ""}) {
    EXPECT_NE(WhyNotGlb([&](Json& json) { json["buffers"][0]["uri"] = uri; }).find("uri"), std::string::npos) << uri;
    EXPECT_NE(WhyNotGlb([&](Json& json) { json["images"][0] = {{"uri", uri}}; }).find("uri"), std::string::npos) << uri;
    EXPECT_NE(WhyNotGlb([&](Json& json) { json["extensions"]["OWN_sound"]["sources"] = {{{"uri", uri}}}; }).find("uri"), std::string::npos) << uri;
  }
  EXPECT_NE(WhyNotGlb([](Json& json) { json["images"][0].erase("bufferView"); }), "");
  EXPECT_NE(WhyNotGlb([](Json& json) { json["images"][0]["mimeType"] = "image/svg+xml"; }), "");
  EXPECT_NE(WhyNotGlb([](Json& json) { json["images"][0]["mimeType"] = "image/jpeg"; }).find("images[0]"), std::string::npos) << "it is a PNG";
  EXPECT_NE(WhyNotGlb([](Json& json) { json["images"][0]["bufferView"] = 0; }), "");
}

// Else a small file keeps the check busy for hours.
TEST(GlbCheck, PicturesAreCheckedOnce) {
  EXPECT_EQ(WhyNotGlb([](Json& json) { json["images"].push_back(json["images"][0]); }), "") << "one picture for two textures";
  EXPECT_NE(WhyNotGlb([](Json& json) {
              for (size_t i = 0; i < 100; ++i) {
                json["images"].push_back(json["images"][0]);
                json["images"].back()["bufferView"] = json["bufferViews"].size();
                json["bufferViews"].push_back(json["bufferViews"][2]);
              }
            }).find("overlap"),
            std::string::npos);
}

TEST(GlbCheck, EverythingStaysWithinItsBounds) {
  const std::pair<const char*, Json> changes[] = {{"/buffers/0/byteLength", 1},
                                                  {"/buffers/0/byteLength", 1e9},
                                                  {"/buffers/0/byteLength", -1},
                                                  {"/bufferViews/0/byteLength", 1000},
                                                  {"/bufferViews/0/byteOffset", 999999},
                                                  {"/bufferViews/0/buffer", 1},
                                                  {"/bufferViews/0", 7},
                                                  {"/bufferViews", {{"a", 1}}},
                                                  {"/accessors/0/count", 4},
                                                  {"/accessors/0/count", 4294967295},
                                                  {"/accessors/0/count", 1.5},
                                                  {"/accessors/0/bufferView", 3},
                                                  {"/accessors/0/type", "VEC9"},
                                                  {"/accessors/0/componentType", 5124},
                                                  {"/accessors/0/byteOffset", 4},
                                                  {"/accessors/1/bufferView", "0"},
                                                  {"/bufferViews/0/byteStride", 8},
                                                  {"/bufferViews/0/byteStride", 256},
                                                  {"/meshes/0/primitives", nullptr},
                                                  {"/meshes/0/primitives/0/indices", 2},
                                                  {"/meshes/0/primitives/0/attributes/POSITION", 9},
                                                  {"/meshes/0/primitives/0/attributes", Json::object()},
                                                  {"/meshes", Json::array()},
                                                  {"/scenes", nullptr},
                                                  {"/nodes/1/mesh", 1},
                                                  {"/nodes/1/children", {7}},
                                                  {"/nodes/1/children", {0}},
                                                  {"/nodes/1/children", {2}},
                                                  {"/nodes/1/children", {1}},
                                                  {"/nodes/1", "node"},
                                                  {"/nodes/0/children", 1},
                                                  {"/asset/version", "1.0"},
                                                  {"/asset", nullptr},
                                                  {"/extensionsRequired", {"KHR_draco_mesh_compression"}},
                                                  {"/extensionsRequired", {1}},
                                                  {"/extensionsRequired", "x"},
                                                  {"/buffers/1", {{"byteLength", 4}}},
                                                  {"/buffers", nullptr}};
  for (const auto& [pointer, value] : changes) {
    EXPECT_NE(WhyNotGlb([&, &where = pointer, &what = value](Json& json) { json[Json::json_pointer(where)] = what; }), "")
        << pointer << " = " << base::JsonText(value);
  }
  EXPECT_NE(WhyNotGlb([](Json& json) {
              json["accessors"][0] = {{"componentType", 5126}, {"count", 100'000'000}, {"type", "MAT4"}};
            }),
            "")
      << "zeros that a viewer would make";
}

TEST(GlbCheck, SparseAccessorsStayWithinTheirBoundsToo) {
  const auto with = [](Json sparse) { return WhyNotGlb([&](Json& json) { json["accessors"][0]["sparse"] = std::move(sparse); }); };
  const Json good = {{"count", 2}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
  EXPECT_EQ(with(good), "");
  Json bad = good;
  bad["count"] = 4;
  EXPECT_NE(with(bad), "");
  bad = good;
  bad["indices"]["byteOffset"] = 4;
  EXPECT_NE(with(bad), "");
  bad = good;
  bad["values"]["bufferView"] = 1;
  EXPECT_NE(with(bad), "");
  bad = good;
  bad.erase("values");
  EXPECT_NE(with(bad), "");
}

}  // namespace
}  // namespace skyquilt::tour
