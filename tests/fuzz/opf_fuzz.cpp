// Projects of Pix4D and the files they name.
#include "tests/fuzz/model_files.h"

namespace skyquilt::fuzz {
namespace {

const ModelFileSet& Whole() {
  static const ModelFileSet whole(test::OpfFiles(test::MakeSurvey()), "project.opf");
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
