#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/image/image.h"
#include "core/image/pixel_cache_file.h"

namespace skyquilt::image {
namespace {

using base::InputError;

// The cache under construction, in a temporary file. Its lock lets only one rank of a node build it; it is removed unless finished.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& final_file) : final_(final_file), partial_(final_file.string() + ".tmp") {
    do {
      Close();
      descriptor_ = open(partial_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
      if (descriptor_ < 0) Fail("cannot be created");
      while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && (errno == EWOULDBLOCK || errno == EINTR)) {
        if (base::CancelRequested()) {
          Close();
          throw base::Interrupted();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    } while (!IsStillNamed());
  }
  ~PartialFile() {
    if (descriptor_ >= 0 && !finished_) unlink(partial_.c_str());
    Close();
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void Clear() {
    if (ftruncate(descriptor_, 0) != 0) Fail("cannot be emptied");
  }
  void Append(std::span<const uint8_t> bytes) {
    WriteAt(bytes, size_);
    size_ += bytes.size();
  }
  void WriteAt(std::span<const uint8_t> bytes, size_t offset) {
    while (!bytes.empty()) {
      const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) Fail("cannot be written");
      bytes = bytes.subspan(static_cast<size_t>(written));
      offset += static_cast<size_t>(written);
    }
  }
  void Finish() {
    if (fsync(descriptor_) != 0) Fail("cannot be written");
    base::Publish(partial_, final_);
    finished_ = true;
  }
  size_t size() const { return size_; }

 private:
  // False if another process renamed or removed this file while we waited for the lock.
  bool IsStillNamed() const {
    struct stat ours {};
    struct stat named {};
    return fstat(descriptor_, &ours) == 0 && stat(partial_.c_str(), &named) == 0 && ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
  }
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  [[noreturn]] void Fail(const std::string& what) const {
    const std::string reason = std::strerror(errno);
    throw InputError(partial_, what + " (" + reason + ")", "Free disk space, choose another output folder, or use a smaller image width");
  }

  std::filesystem::path final_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
  size_t size_ = 0;
  bool finished_ = false;
};

struct Decoded {
  Image8 rgb;
  Image8 mask;
};

Decoded DecodeOne(const PixelSource& source, int image_width) {
  Decoded decoded;
  decoded.rgb = LoadRgb8(source.photo);
  const int full_width = decoded.rgb.width;
  const int full_height = decoded.rgb.height;
  const bool reduce = image_width > 0 && image_width < full_width;
  const int width = reduce ? image_width : full_width;
  const int height = reduce ? ScaledHeight(full_width, full_height, image_width) : full_height;
  if (reduce) decoded.rgb = Resize(decoded.rgb, width, height);
  if (!source.mask.empty()) {
    const Image8 mask = LoadMask(source.mask);
    if (mask.width != full_width || mask.height != full_height) {
      throw InputError(source.mask,
                       "is a mask of " + std::to_string(mask.width) + "x" + std::to_string(mask.height) + " pixels for a photo of " +
                           std::to_string(full_width) + "x" + std::to_string(full_height),
                       "A mask must have its photo's size");
    }
    decoded.mask = ResizeMask(mask, width, height);
  }
  return decoded;
}

bool AlreadyBuilt(const std::filesystem::path& file, const std::string& key) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const base::MemoryMap map(file);
  const std::optional<PixelCacheIndex> index = ReadPixelCacheIndex(map.bytes());
  return index && index->key == key;
}

}  // namespace

void BuildPixelCache(const std::filesystem::path& file, const std::string& key, const std::vector<PixelSource>& sources, int image_width,
                     base::ThreadPool& threads) {
  PartialFile partial(file);
  if (AlreadyBuilt(file, key)) return;
  partial.Clear();
  const std::string blank(kPixelCacheHeaderBytes, '\0');
  const auto bytes_of = [](const std::string& text) { return std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()); };
  partial.Append(bytes_of(blank));

  PixelCacheIndex index;
  index.key = key;
  std::vector<std::pair<size_t, InputError>> failed;
  base::Progress progress("decoding photos", static_cast<double>(sources.size()), "photos");
  const size_t group = 2 * static_cast<size_t>(threads.size());  // limits memory, but keeps all threads busy
  for (size_t first = 0; first < sources.size(); first += group) {
    base::ThrowIfCancelled();
    const size_t n = std::min(group, sources.size() - first);
    std::vector<Decoded> decoded(n);
    std::mutex mutex;
    threads.ParallelFor(static_cast<int64_t>(n), [&](int64_t task, int) {
      const auto i = static_cast<size_t>(task);
      try {
        decoded[i] = DecodeOne(sources[first + i], image_width);
      } catch (const InputError& error) {
        const std::lock_guard lock(mutex);
        failed.emplace_back(first + i, error);
      }
    });
    for (size_t i = 0; i < n && failed.empty(); ++i) {
      PixelCache::Entry entry;
      entry.width = decoded[i].rgb.width;
      entry.height = decoded[i].rgb.height;
      entry.rgb_offset = partial.size();
      partial.Append(decoded[i].rgb.data);
      if (!decoded[i].mask.Empty()) {
        entry.mask_offset = partial.size();
        partial.Append(decoded[i].mask.data);
      }
      index.entries.push_back(entry);
    }
    progress.Update(static_cast<double>(first + n));
  }
  std::sort(failed.begin(), failed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<InputError> errors;
  for (const auto& [photo, error] : failed) errors.push_back(error);
  ThrowPhotoErrors(errors, sources.size());

  const std::string index_text = PixelCacheIndexText(index);
  const size_t index_offset = partial.size();
  partial.Append(bytes_of(index_text));
  const std::string header = PixelCacheHeader(index_text, index_offset);
  partial.WriteAt(bytes_of(header), 0);
  partial.Finish();
  progress.Finish();
}

}  // namespace skyquilt::image
