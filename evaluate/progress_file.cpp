#include "evaluate/progress_file.h"

#include <cstdint>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/checkpoint/digest.h"

namespace skyquilt::evaluate {

namespace {

constexpr size_t kDigestBytes = sizeof(uint64_t);

uint64_t DigestOf(std::string_view bytes) {
  checkpoint::Digest digest;
  digest.Update({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  return digest.Value();
}

// The content without the digest. Throws base::UnreadableBytes unless it is whole.
std::string_view WholeContent(std::string_view bytes) {
  uint64_t digest = 0;
  if (bytes.size() < kDigestBytes) throw base::UnreadableBytes("it is damaged");
  const std::string_view content = bytes.substr(0, bytes.size() - kDigestBytes);
  std::memcpy(&digest, bytes.data() + content.size(), kDigestBytes);
  if (digest != DigestOf(content)) throw base::UnreadableBytes("it is damaged");
  return content;
}

}  // namespace

ProgressFile::ProgressFile(std::filesystem::path file, std::string key) : file_(std::move(file)), key_(std::move(key)) {}

bool ProgressFile::Read(const std::function<void(base::ByteUnpacker*)>& load) const {
  std::error_code ignored;
  if (!std::filesystem::exists(file_, ignored)) return false;
  std::string why;
  try {
    const std::string bytes = base::ReadFile(file_);
    std::string_view content = WholeContent(bytes);
    if (!content.starts_with(kMagic)) throw base::UnreadableBytes("it is another kind of file");
    content.remove_prefix(kMagic.size());
    base::ByteUnpacker in(content, "it does not have the expected content");
    if (in.Take<uint32_t>() != kVersion) throw base::UnreadableBytes("it is of another version of skyquilt");
    if (in.Take<std::string>() != key_) throw base::UnreadableBytes("it belongs to other inputs or options");
    load(&in);
    in.End();
    return true;
  } catch (const base::UnreadableBytes& error) {
    why = error.what();
  } catch (const base::InputError& error) {
    why = error.finding();
  }
  base::LogInfo("{} is not used: {}", file_.string(), why);
  Remove();
  return false;
}

size_t ProgressFile::Write(size_t expected_bytes, const std::function<void(base::BytePacker*)>& save) const {
  base::BytePacker out;
  out.Reserve(expected_bytes);
  for (const char letter : kMagic) out.Add(letter);
  out.Add(kVersion);
  out.Add(key_);
  save(&out);
  out.Add(DigestOf(out.bytes()));
  base::WriteFileAtomically(file_, out.bytes());
  return out.bytes().size();
}

void ProgressFile::Remove() const {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace skyquilt::evaluate
