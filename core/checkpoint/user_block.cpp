#include "core/checkpoint/user_block.h"

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <vector>

#include "core/base/errors.h"
#include "core/checkpoint/digest.h"

namespace skyquilt::checkpoint {
namespace {

using base::InputError;

constexpr char kMagic[] = "SKYQUILT ARCHIVE ";
constexpr int kFormat = 1;
constexpr const char* kFix = "Remove it and run the same command again, or restore a copy";

std::ifstream OpenForReading(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file, "does not exist", "Run the command that writes it first");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file, "is not a file", "Give the path of an .h5 file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file, "cannot be opened", "Check its permissions");
  return stream;
}

}  // namespace

FileGuard MeasureFile(const std::filesystem::path& file) {
  std::ifstream stream = OpenForReading(file);
  std::vector<char> buffer(size_t{1} << 20U);
  FileGuard guard;
  stream.read(buffer.data(), kUserBlockBytes);
  guard.n_bytes = static_cast<uint64_t>(stream.gcount());
  Digest digest;
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    const auto n = static_cast<size_t>(stream.gcount());
    digest.Update({reinterpret_cast<const uint8_t*>(buffer.data()), n});
    guard.n_bytes += n;
  }
  if (stream.bad()) throw InputError(file, "cannot be read completely", "Check the disk, then run the same command again");
  guard.digest = digest.Value();
  return guard;
}

std::string UserBlockText(const std::string& kind, int version, const FileGuard& guard) {
  char line[64];
  std::snprintf(line, sizeof(line), "%s%d\n", kMagic, kFormat);
  std::string text = line;
  std::snprintf(line, sizeof(line), "bytes %" PRIu64 "\nxxh64 %016" PRIx64 "\n", guard.n_bytes, guard.digest);
  text += line;
  text += "kind " + kind + "\nversion " + std::to_string(version) + "\n";
  SKYQUILT_CHECK(text.size() < kUserBlockBytes, "the kind's name is too long");
  text.resize(kUserBlockBytes, '\0');
  return text;
}

void WriteUserBlock(const std::filesystem::path& file, const std::string& text) {
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) throw InputError(file, "cannot be written", "Free disk space or check permissions");
}

std::string VerifiedUserBlock(const std::filesystem::path& file, FileGuard* guard) {
  std::string text(kUserBlockBytes, '\0');
  {
    std::ifstream stream = OpenForReading(file);
    stream.read(text.data(), kUserBlockBytes);
    text.resize(static_cast<size_t>(stream.gcount()));
  }
  const std::string hdf5_signature = "\x89HDF\r\n\x1A\n";
  if (text.compare(0, hdf5_signature.size(), hdf5_signature) == 0) {
    throw InputError(file, "is an HDF5 file that Skyquilt did not write", "Give a checkpoint or a scene written by skyquilt");
  }
  if (text.compare(0, sizeof(kMagic) - 1, kMagic) != 0) {
    throw InputError(file, "is not a Skyquilt archive, or its beginning is damaged", kFix);
  }
  if (text.size() < kUserBlockBytes)
    throw InputError(file, "is damaged: it ends within its first " + std::to_string(kUserBlockBytes) + " bytes", kFix);
  int format = 0;
  FileGuard stored;
  const int n_read =
      std::sscanf(text.c_str() + sizeof(kMagic) - 1, "%3d bytes %20" SCNu64 " xxh64 %16" SCNx64, &format, &stored.n_bytes, &stored.digest);
  if (n_read >= 1 && format > kFormat) {
    throw InputError(
        file, "was written by a newer Skyquilt (archive format " + std::to_string(format) + ", this program reads " + std::to_string(kFormat) + ")",
        "Update the program");
  }
  if (n_read != 3) throw InputError(file, "is damaged: its first " + std::to_string(kUserBlockBytes) + " bytes cannot be parsed", kFix);
  *guard = MeasureFile(file);
  if (guard->n_bytes != stored.n_bytes) {
    throw InputError(file, "is damaged: it has " + std::to_string(guard->n_bytes) + " bytes, but " + std::to_string(stored.n_bytes) + " were written",
                     kFix);
  }
  if (guard->digest != stored.digest) throw InputError(file, "is damaged: its checksum does not match its content", kFix);
  return text;
}

}  // namespace skyquilt::checkpoint
