#include "core/metrics/lpips.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/support/made_onnx.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::metrics {
namespace {

using image::Image8;
using image::ImageF;

using namespace onnx;

// Nodes that divide `input` by its norm over the channels, as LPIPS does with features; the result is named prefix + "unit".
std::string UnitLength(const std::string& input, const std::string& prefix) {
  return Text(1, Node("Mul", {input, input}, prefix + "square")) +
         Text(1, Node("ReduceSum", {prefix + "square"}, prefix + "sum", Axes({1}) + Flag("keepdims", 1))) +
         Text(1, Node("Sqrt", {prefix + "sum"}, prefix + "length")) + Text(1, Node("Div", {input, prefix + "length"}, prefix + "unit"));
}

// mean((in0 - in1)^2): the simplest network with the inputs and the output that scripts/export_lpips.py writes.
std::string SquaredDifferenceModel(int height, int width, bool second_input = true) {
  const std::string other = second_input ? "in1" : "in0";
  const std::string mean = Axes({1, 2, 3}) + Flag("keepdims", 1);
  std::string graph = Text(1, Node("Sub", {"in0", other}, "difference")) + Text(1, Node("Mul", {"difference", "difference"}, "square")) +
                      Text(1, Node("ReduceMean", {"square"}, "distance", mean)) + Text(2, "graph") + Text(11, Value("in0", {1, 3, height, width}));
  if (second_input) graph += Text(11, Value("in1", {1, 3, height, width}));
  graph += Text(12, Value("distance", {1, 1, 1, 1}));
  return Number(1, 7) + Text(8, Number(2, 11)) + Text(7, graph);
}

class LpipsTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& bytes) const {
    std::filesystem::path file = folder_.path() / "network.onnx";
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
  TemporaryFolder folder_;
};

TEST_F(LpipsTest, FeedsBothImagesInTheNetworksRange) {
  Lpips lpips(Write(SquaredDifferenceModel(12, 16)));
  ImageF a(16, 12, 3);
  ImageF b(16, 12, 3);
  double sum = 0.0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    a.data[i] = static_cast<float>(i % 17) / 17.0F;
    b.data[i] = static_cast<float>(i % 5) / 5.0F;
    sum += std::pow(2.0 * static_cast<double>(a.data[i] - b.data[i]), 2);  // [0,1] becomes [-1,1]: twice the difference
  }
  EXPECT_NEAR(lpips.Distance(a, b, nullptr), sum / static_cast<double>(a.data.size()), 1e-5);
  EXPECT_EQ(lpips.Distance(a, a, nullptr), 0.0);
}

TEST_F(LpipsTest, TakesImagesOfAnySizeWhenTheNetworkDoes) {
  Lpips lpips(Write(SquaredDifferenceModel(-1, -2)));
  for (const auto& [width, height] : {std::pair{16, 12}, std::pair{33, 20}}) {
    EXPECT_NEAR(lpips.Distance(ImageF(width, height, 3, 0.25F), ImageF(width, height, 3, 0.75F), nullptr), 1.0, 1e-5) << width;
  }
}

TEST_F(LpipsTest, RunsTheNormalisationOfFeatures) {
  const std::string mean = Axes({1, 2, 3}) + Flag("keepdims", 1);
  const std::string graph = UnitLength("in0", "a_") + UnitLength("in1", "b_") + Text(1, Node("Sub", {"a_unit", "b_unit"}, "difference")) +
                            Text(1, Node("Mul", {"difference", "difference"}, "square")) + Text(1, Node("ReduceMean", {"square"}, "distance", mean)) +
                            Text(2, "graph") + Text(11, Value("in0", {1, 3, -1, -2})) + Text(11, Value("in1", {1, 3, -1, -2})) +
                            Text(12, Value("distance", {1, 1, 1, 1}));
  Lpips lpips(Write(Number(1, 7) + Text(8, Number(2, 11)) + Text(7, graph)));
  ImageF a(20, 18, 3);
  ImageF b(20, 18, 3);
  double sum = 0.0;
  for (size_t pixel = 0; pixel < 360; ++pixel) {
    double length_a = 0.0;
    double length_b = 0.0;
    const auto signed_value = [](float value) { return 2.0 * static_cast<double>(value) - 1.0; };
    for (size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
      a.data[i] = static_cast<float>(i % 17) / 17.0F;
      b.data[i] = static_cast<float>(i % 5) / 5.0F + 0.01F;
      length_a += std::pow(signed_value(a.data[i]), 2);
      length_b += std::pow(signed_value(b.data[i]), 2);
    }
    for (size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
      sum += std::pow(signed_value(a.data[i]) / std::sqrt(length_a) - signed_value(b.data[i]) / std::sqrt(length_b), 2);
    }
  }
  EXPECT_NEAR(lpips.Distance(a, b, nullptr), sum / 1080.0, 1e-5);
}

TEST_F(LpipsTest, RefusesImagesOfAnotherSizeThanTheNetworks) {
  Lpips lpips(Write(SquaredDifferenceModel(12, 16)));
  const std::string message = InputErrorOf([&] { lpips.Distance(ImageF(12, 16, 3), ImageF(12, 16, 3), nullptr); });
  EXPECT_NE(message.find("takes only images of 16x12"), std::string::npos) << message;
}

TEST_F(LpipsTest, MaskedPixelsDoNotDiffer) {
  Lpips lpips(Write(SquaredDifferenceModel(12, 16)));
  ImageF a(16, 12, 3, 0.5F);
  ImageF b(16, 12, 3, 0.5F);
  Image8 mask(16, 12, 1, 255);
  a.At(3, 3)[0] = 0.9F;
  b.At(3, 3)[1] = std::numeric_limits<float>::quiet_NaN();
  *mask.At(3, 3) = 0;
  EXPECT_EQ(lpips.Distance(a, b, &mask), 0.0);
  EXPECT_GT(lpips.Distance(a, b, nullptr), 0.0);
}

TEST_F(LpipsTest, ErrorsTellWhatIsWrongWithAFile) {
  const auto message = [&](const std::string& bytes) { return InputErrorOf([&] { Lpips lpips(Write(bytes)); }); };
  EXPECT_NE(InputErrorOf([&] { Lpips lpips(folder_.path() / "absent.onnx"); }).find("absent.onnx"), std::string::npos);
  EXPECT_NE(message("").find("is not an ONNX network"), std::string::npos);
  EXPECT_NE(message("some text, long enough to be looked at").find("is not an ONNX network"), std::string::npos);
  EXPECT_NE(message(SquaredDifferenceModel(12, 16, false)).find("with 1 inputs"), std::string::npos);
  const std::string good = SquaredDifferenceModel(12, 16);
  EXPECT_NE(message(good.substr(0, good.size() - 30)), "");
}

// The script that exports LPIPS checks files by the same contract as the program reads them.
class ExportScript : public LpipsTest {
 protected:
  // Exit status, and what it printed.
  std::pair<int, std::string> Run(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = {"-S", SKYQUILT_SOURCE_DIR "/scripts/export_lpips.py"};  // -S: without installed modules
    all.insert(all.end(), arguments.begin(), arguments.end());
    base::ChildProcess script = base::ChildProcess::StartReading({base::FindProgram("python3"), all});
    std::string text;
    while (script.Receive(&text)) {
    }
    return {script.Wait().ShellStatus(), text};
  }
};

TEST_F(ExportScript, AcceptsWhatTheProgramReads) {
  for (const std::string& model : {SquaredDifferenceModel(12, 16), SquaredDifferenceModel(-1, -2)}) {
    const std::filesystem::path file = Write(model);
    EXPECT_NO_THROW(Lpips{file});
    const auto [status, text] = Run({"--check", file.string()});
    EXPECT_EQ(status, 0) << text;
  }
}

TEST_F(ExportScript, RefusesWhatTheProgramRefuses) {
  for (const std::string& model : {std::string(), std::string("some text, long enough to be looked at"), SquaredDifferenceModel(12, 16, false)}) {
    const std::filesystem::path file = Write(model);
    EXPECT_THROW(Lpips{file}, base::InputError);
    const auto [status, text] = Run({"--check", file.string()});
    EXPECT_EQ(status, 1) << text;
    EXPECT_NE(text.find("network.onnx"), std::string::npos) << text;
  }
}

TEST_F(ExportScript, TellsHowToInstallWhatIsMissing) {
  const std::filesystem::path file = folder_.path() / "new.onnx";
  const auto [status, text] = Run({file.string()});
  EXPECT_EQ(status, 2);
  EXPECT_NE(text.find("pip install torch lpips"), std::string::npos) << text;
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(LpipsTest, RefusesAnUnknownLayer) {
  std::string model = SquaredDifferenceModel(12, 16);
  const size_t at = model.find("ReduceMean");
  model.replace(at, 10, "NoSuchType");
  EXPECT_NE(InputErrorOf([&] { Lpips lpips(Write(model)); }), "");
}

}  // namespace
}  // namespace skyquilt::metrics
