#include "core/network/onnx_network.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "tests/support/error_of.h"
#include "tests/support/made_onnx.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::network {
namespace {

class OnnxNetworkTest : public testing::Test {
 protected:
  OnnxNetwork Read(const std::string& bytes) const {
    const std::filesystem::path file = folder_ / "network.onnx";
    std::ofstream(file, std::ios::binary) << bytes;
    return {file, "Give another one"};
  }
  TemporaryFolder folder_;
};

TEST_F(OnnxNetworkTest, RunsAtTheShapeItIsLoadedFor) {
  OnnxNetwork net = Read(onnx::ColorModel({{1, 0, 0, 0.5F}, {0, 2, -1, 0}}, -1, -2));
  ASSERT_EQ(net.inputs().size(), 1U);
  EXPECT_EQ(net.inputs()[0].shape, (std::vector<int64_t>{1, 3, 0, 0}));
  for (const auto& [height, width] : {std::pair<int64_t, int64_t>{2, 3}, {4, 2}}) {
    net.Load({1, 3, height, width});
    EXPECT_EQ(net.Outputs(), 1U);
    Tensor photo({1, 3, height, width});
    const auto n = static_cast<size_t>(height * width);
    for (size_t i = 0; i < 3 * n; ++i) photo.values[i] = static_cast<float>(i);
    const Tensor scores = net.Run(std::array{photo});
    EXPECT_EQ(scores.shape, (std::vector<int64_t>{1, 2, height, width}));
    for (size_t i = 0; i < n; ++i) {
      EXPECT_FLOAT_EQ(scores.values[i], photo.values[i] + 0.5F);
      EXPECT_FLOAT_EQ(scores.values[n + i], 2.0F * photo.values[n + i] - photo.values[2 * n + i]);
    }
  }
}

TEST_F(OnnxNetworkTest, NetworksOfOtherWeightsHaveOtherDigests) {
  const std::string one = Read(onnx::ColorModel({{1, 0, 0, 0}}, 4, 4)).Digest(), same = Read(onnx::ColorModel({{1, 0, 0, 0}}, 4, 4)).Digest();
  EXPECT_EQ(one, same);
  EXPECT_NE(one, Read(onnx::ColorModel({{1, 0, 0, 1}}, 4, 4)).Digest());
}

TEST_F(OnnxNetworkTest, ErrorsNameTheFileAndTheRemedy) {
  const std::string good = onnx::ColorModel({{1, 0, 0, 0}}, 4, 4);
  std::string unknown_layer = good;
  unknown_layer.replace(unknown_layer.find("Conv"), 4, "Cane");
  for (const std::string& bytes : {std::string(), std::string("text"), good.substr(0, good.size() / 2), unknown_layer}) {
    const std::string error = InputErrorOf([&] { Read(bytes).Load({1, 3, 4, 4}); });
    EXPECT_NE(error.find("network.onnx"), std::string::npos) << error;
    EXPECT_NE(error.find("Give another one"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace skyquilt::network
