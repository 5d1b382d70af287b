// Checkpoints: the plain header in front of the HDF5 data (length and digest), and the HDF5 data itself when the header is accepted. The digest does
// not protect against deliberate forgery, so content with a forged digest is not tested.
#include "core/base/file.h"
#include "core/checkpoint/archive.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  const TemporaryFolder folder;
  const std::vector<float> floats(300, 0.5F);
  const std::vector<uint8_t> bytes(7, 3);
  checkpoint::ArchiveWriter writer("block", 1);
  writer.Put("grid", floats, {100, 3});
  writer.Put("group/bytes", bytes);
  writer.SetAttribute("name", std::string("r0c0"));
  writer.SetAttribute("steps", 12);
  writer.Commit(folder / "block.h5");
  return {base::ReadFile(folder / "block.h5")};
}

void Feed(const std::string& bytes) {
  FeedFile("block.h5", bytes, [](const std::filesystem::path& file) {
    const checkpoint::ArchiveReader reader(file);
    for (const std::string& name : reader.Names()) {
      reader.Shape(name);
      if (reader.TypeName(name) == "float32") reader.Floats(name);
    }
  });
}

}  // namespace skyquilt::fuzz
