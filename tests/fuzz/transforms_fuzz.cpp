// transforms.json of nerfstudio and Blender, and the points they name.
#include "tests/fuzz/model_files.h"

namespace skyquilt::fuzz {
namespace {

const ModelFileSet& Whole() {
  static const ModelFileSet whole(test::TransformsFiles(test::MakeSurvey()), "transforms.json");
  return whole;
}

}  // namespace

std::vector<std::string> Seeds() {
  return Whole().Seeds();
}

void Feed(const std::string& bytes) {
  Whole().Feed(bytes);
}

}  // namespace skyquilt::fuzz
