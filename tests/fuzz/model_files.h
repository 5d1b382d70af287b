// Fuzzes models of several files. An input is one of the files; its first byte says which one. The others are valid.
#pragma once

#include <iterator>

#include "prepare/models/read_model.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/prepare/models/made_models.h"

namespace skyquilt::fuzz {

class ModelFileSet {
 public:
  // path: of the model, one of the files.
  ModelFileSet(test::Files files, std::string path) : files_(std::move(files)), path_(std::move(path)) { test::WriteFiles(files_, folder_.path()); }

  std::vector<std::string> Seeds() const {
    std::vector<std::string> seeds;
    for (const auto& [name, content] : files_) seeds.push_back(std::string(1, static_cast<char>('0' + static_cast<char>(seeds.size()))) + content);
    return seeds;
  }
  void Feed(const std::string& bytes) const {
    if (bytes.empty()) return;
    const size_t which = static_cast<unsigned char>(bytes[0] - '0') % files_.size();
    const auto& [name, content] = *std::next(files_.begin(), static_cast<std::ptrdiff_t>(which));
    test::WriteFiles({{name, bytes.substr(1)}}, folder_.path());
    try {
      prepare::ReadModel(folder_ / path_, prepare::ModelPhotos(folder_.path(), {"DJI_0001.png", "DJI_0002.png", "DJI_0003.png"}));
    } catch (const base::InputError&) {
    }
    test::WriteFiles({{name, content}}, folder_.path());
  }

 private:
  test::Files files_;
  std::string path_;
  TemporaryFolder folder_;
};

}  // namespace skyquilt::fuzz
