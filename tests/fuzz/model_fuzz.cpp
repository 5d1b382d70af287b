// Models of several files. An input is one of the files; its first byte says which one. The others are valid. The build says which model:
// FUZZ_FILES, the function of made_models.h that makes them, and FUZZ_MODEL, the file that is given to --model.
#include <iterator>

#include "prepare/models/read_model.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/prepare/models/made_models.h"

namespace skyquilt::fuzz {
namespace {

struct Model {
  test::Files files = test::FUZZ_FILES(test::MakeModel());
  TemporaryFolder folder;
  Model() { test::WriteFiles(files, folder.path()); }
};

const Model& Whole() {
  static const Model whole;
  return whole;
}

}  // namespace

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const auto& [name, content] : Whole().files)
    seeds.push_back(std::string(1, static_cast<char>('0' + static_cast<char>(seeds.size()))) + content);
  return seeds;
}

void Feed(const std::string& bytes) {
  if (bytes.empty()) return;
  const Model& whole = Whole();
  const size_t which = static_cast<unsigned char>(bytes[0] - '0') % whole.files.size();
  const auto& [name, content] = *std::next(whole.files.begin(), static_cast<std::ptrdiff_t>(which));
  test::WriteFiles({{name, bytes.substr(1)}}, whole.folder.path());
  try {
    prepare::models::ReadModel(whole.folder / FUZZ_MODEL,
                               prepare::models::ModelPhotos(whole.folder.path(), {"DJI_0001.png", "DJI_0002.png", "DJI_0003.png"}));
  } catch (const base::InputError&) {
  }
  test::WriteFiles({{name, content}}, whole.folder.path());
}

}  // namespace skyquilt::fuzz
