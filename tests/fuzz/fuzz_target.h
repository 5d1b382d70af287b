// One reader that takes files from strangers. Linked with replay_main.cpp (a test: seeds and many fixed mutations of them) or, built with clang and
// SKYQUILT_FUZZ=ON, with libFuzzer (scripts/fuzz.sh).
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::fuzz {

// Whole inputs to start from.
std::vector<std::string> Seeds();
// Reads the bytes as if they came from a file. Only base::InputError and base::UsageError, which say what is wrong, may be caught inside;
// whatever else happens is a finding.
void Feed(const std::string& bytes);

// Feed for a reader of one file of this name.
template <typename Reader>
void FeedFile(const std::string& name, const std::string& bytes, const Reader& read) {
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder / name;
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    read(file);
  } catch (const base::InputError&) {
  }
}

}  // namespace skyquilt::fuzz
