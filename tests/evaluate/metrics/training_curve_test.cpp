#include "evaluate/metrics/training_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::metrics {
namespace {

TEST(ParseCurve, ReadsColumnsByName) {
  const auto curve = ParseCurve("seconds,step,psnr,loss,more\n1.5,100,20.5,0.01,9\n3.0,200,22.5,0.005,9\n");
  ASSERT_EQ(curve.size(), 2U);
  EXPECT_DOUBLE_EQ(curve[1].step, 200.0);
  EXPECT_DOUBLE_EQ(curve[1].seconds, 3.0);
  EXPECT_DOUBLE_EQ(curve[1].loss, 0.005);
  EXPECT_DOUBLE_EQ(curve[1].psnr_db, 22.5);
}

TEST(ParseCurve, SkipsTornLinesAndMarksWhatIsNotANumber) {
  const auto curve = ParseCurve("step,seconds,loss,psnr\r\n1,0.1,nonsense,10\r\n2,0.2\n3,0.3,0.5,11");
  ASSERT_EQ(curve.size(), 2U);
  EXPECT_TRUE(std::isnan(curve[0].loss));
  EXPECT_DOUBLE_EQ(curve[0].psnr_db, 10.0);
  EXPECT_DOUBLE_EQ(curve[1].loss, 0.5);
  EXPECT_TRUE(ParseCurve("").empty());
}

TEST(ReadCurves, TakesTheFilesThatAreThere) {
  const TemporaryFolder folder;
  std::ofstream(folder / "context.log.csv") << "step,seconds,loss,psnr\n1,1,0.5,10\n";
  std::ofstream(folder / "block_r0c0.log.csv") << "step,seconds,loss,psnr\n1,1,0.5,10\n2,2,0.4,11\n";
  const Curves curves = ReadCurves(folder.path(), {"context", "r0c0", "r9c9"});
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_EQ(curves.at("context").size(), 1U);
  EXPECT_EQ(curves.at("r0c0").size(), 2U);
}

}  // namespace
}  // namespace skyquilt::evaluate::metrics
