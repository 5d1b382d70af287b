// reconstruction.json of OpenSfM with the tables beside it.
#include "tests/fuzz/model_files.h"

namespace skyquilt::fuzz {
namespace {

const ModelFileSet& Whole() {
  static const ModelFileSet whole(test::OpensfmFiles(test::MakeSurvey()), "reconstruction.json");
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
