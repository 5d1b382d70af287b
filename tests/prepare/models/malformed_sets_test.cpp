// Faults of the field's data sets: each error names the file and how to fix it.
#include <gtest/gtest.h>

#include <limits>

#include "core/base/file.h"
#include "prepare/models/npy_array.h"
#include "prepare/models/read_model.h"
#include "tests/prepare/models/made_models.h"
#include "tests/prepare/models/made_sets.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::models {
namespace {

namespace fs = std::filesystem;

class MalformedSet : public ::testing::Test {
 protected:
  // The message for a poses_bounds.npy of these bytes and the three photos of MakeModel.
  std::string MessageOf(const std::string& npy) {
    base::WriteFileAtomically(folder_ / "poses_bounds.npy", npy);
    return InputErrorOf([&] { ReadModel(folder_.path(), ModelPhotos(folder_.path(), photos_)); });
  }
  void Expect(const std::string& message, const std::string& found, const std::string& fix) {
    EXPECT_NE(message.find("poses_bounds.npy"), std::string::npos) << message;
    EXPECT_NE(message.find(found), std::string::npos) << found << ": " << message;
    EXPECT_NE(message.find(fix), std::string::npos) << fix << ": " << message;
  }

  TemporaryFolder folder_;
  const std::string good_ = test::PosesBoundsFiles(test::MakeModel()).at("poses_bounds.npy");
  std::vector<std::string> photos_ = {"DJI_0001.png", "DJI_0002.png", "DJI_0003.png"};
};

constexpr const char* kMakeAgain = "Make it again with LLFF's imgs2poses.py";

TEST_F(MalformedSet, NpyThatEndsEarlyOrLate) {
  ASSERT_EQ(MessageOf(good_), "");
  for (size_t length = 0; length < good_.size(); ++length) {
    const std::string message = MessageOf(good_.substr(0, length));
    Expect(message, length < 6 ? "is not an array that NumPy saved" : "(truncated)", kMakeAgain);
  }
  Expect(MessageOf(good_ + "1"), "does not end after its 3 x 17 numbers", kMakeAgain);
}

TEST_F(MalformedSet, NpyOfAnotherKind) {
  const std::vector<double> values(51, 1.0);
  const auto with = [&](const std::string& type, const std::string& order, const std::string& shape) {
    return MessageOf(test::NpyBytes("{'descr': " + type + ", 'fortran_order': " + order + ", 'shape': " + shape + ", }", values));
  };
  Expect(with("'<i8'", "False", "(3, 17)"), "does not hold little-endian floating-point numbers", kMakeAgain);
  Expect(with("'>f8'", "False", "(3, 17)"), "does not hold little-endian floating-point numbers", kMakeAgain);
  Expect(with("[('a', '<f8')]", "False", "(3, 17)"), "does not hold little-endian floating-point numbers", kMakeAgain);
  Expect(with("'<f8'", "True", "(3, 17)"), "is not stored row after row", kMakeAgain);
  Expect(with("'<f8'", "False", "(51,)"), "has 1 dimensions, not 2", kMakeAgain);
  Expect(with("'<f8'", "False", "(3, 17, 1)"), "has 3 dimensions, not 2", kMakeAgain);
  Expect(with("'<f8'", "False", "(3, -17)"), "has no shape in its header", kMakeAgain);
  Expect(with("'<f8'", "False", "(17, 3)"), "has 3 numbers in a row, not 17", kMakeAgain);
  Expect(with("'<f8'", "False", "(18446744073709551615, 18446744073709551615)"), "(truncated)", kMakeAgain);
  Expect(with("'<f8'", "False", "(99999999999999999999, 1)"), "has no shape in its header", kMakeAgain);
  Expect(MessageOf(test::NpyOfDoubles(0, 17, {})), "has no poses", kMakeAgain);
  Expect(MessageOf("\x93NUMPY\x02" + std::string(1, '\0') + "\xff\xff\xff\x7f"), "has a header of 2147483647 bytes", kMakeAgain);
}

TEST_F(MalformedSet, NpyOfSinglePrecisionAndOfVersion2IsRead) {
  std::string single = test::NpyBytes("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }", {});
  const float values[2] = {0.5F, -3.0F};
  single.append(reinterpret_cast<const char*>(values), sizeof(values));
  base::WriteFileAtomically(folder_ / "a.npy", single);
  const NpyArray one = ReadNpyArray(folder_ / "a.npy", "");
  EXPECT_EQ(one.values, (std::vector<double>{0.5, -3.0}));
  std::string longer = single.substr(0, 10) + std::string(2, '\0') + single.substr(10);
  longer[6] = '\x02';
  base::WriteFileAtomically(folder_ / "a.npy", longer);
  EXPECT_EQ(ReadNpyArray(folder_ / "a.npy", "").values, one.values);
}

TEST_F(MalformedSet, RowsOfPosesBounds) {
  // The 51 numbers are at the end.
  const auto with = [&](size_t number, double value) {
    std::string changed = good_;
    changed.replace(changed.size() - 8 * (51 - number), 8, reinterpret_cast<const char*>(&value), 8);
    return MessageOf(changed);
  };
  Expect(with(17, std::numeric_limits<double>::quiet_NaN()), "a number that is not finite in row 1, column 0", kMakeAgain);
  Expect(with(17, 7.0), "row 1 has no rotation in the first three columns", kMakeAgain);
  Expect(with(21, 480.5), "row 1 has the height 480.5", kMakeAgain);
  Expect(with(9, -640.0), "row 0 has the width -640", kMakeAgain);
  Expect(with(48, 0.0), "row 2 has the focal length 0", kMakeAgain);
}

TEST_F(MalformedSet, AnotherNumberOfPictures) {
  photos_.pop_back();
  Expect(MessageOf(good_), "has poses of 3 pictures, but there are 2 in " + folder_.path().string(), "with all pictures of the scene");
}

TEST_F(MalformedSet, SmallerPicturesThatCannotBeMatched) {
  test::MakeMip360(folder_.path());
  const std::string message = InputErrorOf([&] {
    ReadModel(folder_.path(), ModelPhotos(folder_ / "images_4", {"image000.png", "image001.png", "image002.png"}));
  });
  for (const char* part : {"images_4", "has 3 pictures with other names than those of the model, of which there are 17", "its images/ beside it"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

// Also where another part has a picture of the same name.
TEST_F(MalformedSet, PicturesThatAreNotThere) {
  const test::MadeSet blender = test::MakeBlender(folder_ / "lego"), city = test::MakeMatrixCitySplit(folder_ / "city");
  struct Case {
    const test::MadeSet* set;
    const char *missing, *named;
  };
  for (const Case& one : {Case{&blender, "test/r_1.png", "picture test/r_1, which is not among the photos in "},
                          Case{&city, "test/block_1_test/0003.png", "picture ../../test/block_1_test/0003.png, which is not among the photos in "}}) {
    std::vector<std::string> names = one.set->names;
    ASSERT_EQ(std::erase(names, one.missing), 1U);
    const std::string message = InputErrorOf([&] { ReadModel(one.set->model, ModelPhotos(one.set->photo_root, names)); });
    for (const char* part : {"transforms_test.json", "line ", one.named, "Unpack all pictures"}) {
      EXPECT_NE(message.find(part), std::string::npos) << part << ": " << message;
    }
  }
}

TEST_F(MalformedSet, FilesOfASplitThatAreMissingOrTooMany) {
  const test::MadeSet set = test::MakeBlender(folder_.path());
  const auto message_of = [&] { return InputErrorOf([&] { ReadModel(set.model, ModelPhotos(set.photo_root, set.names)); }); };
  fs::rename(folder_ / "transforms_train.json", folder_ / "kept");
  EXPECT_NE(message_of().find("but no transforms_train.json. Add it"), std::string::npos) << message_of();
  base::WriteFileAtomically(folder_ / "transforms_train.json", R"({"camera_angle_x": 0.7})");
  EXPECT_NE(message_of().find("has no \"frames\""), std::string::npos) << message_of();
  fs::rename(folder_ / "kept", folder_ / "transforms_train.json");
  EXPECT_EQ(message_of(), "");
  base::WriteFileAtomically(folder_ / "transforms.json", "{}");
  EXPECT_NE(message_of().find("has transforms.json and transforms_train.json"), std::string::npos) << message_of();
  EXPECT_NE(message_of().find("Give one of the files instead of the folder"), std::string::npos) << message_of();
}

}  // namespace
}  // namespace skyquilt::prepare::models
