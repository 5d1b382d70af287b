#include "surface/views/view_files.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/output_file.h"
#include "core/base/progress.h"
#include "surface/views/view_record.h"

namespace skyquilt::surface {
namespace {

constexpr std::string_view kViewMagic = "SQVIEW02";
constexpr size_t kHashChars = 16;

template <typename T>
std::string_view BytesOf(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

template <typename T>
std::string_view BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::array<char, kHashChars> FixedText(const std::string& text) {
  std::array<char, kHashChars> fixed = {};
  std::copy_n(text.begin(), std::min(text.size(), kHashChars), fixed.begin());
  return fixed;
}

// What a file of this view begins with.
std::string Preamble(const ViewPose& pose, const std::string& key) {
  const ViewRecord record = RecordOf(pose);
  const std::array<char, kHashChars> fixed_key = FixedText(key);
  std::string text(kViewMagic);
  text.append(BytesOf(fixed_key)).append(BytesOf(record));
  return text;
}

}  // namespace

std::string ViewFileName(size_t view) {
  std::string number = std::to_string(view);
  if (number.size() < 5) number.insert(0, 5 - number.size(), '0');
  return "view_" + number + ".bin";
}

void SaveView(const RenderedView& view, const std::string& key, const std::filesystem::path& file) {
  std::string content = Preamble(view.pose, key);
  content.append(BytesOf(view.depth_m)).append(BytesOf(view.cosine));
  view.weight.empty() ? content.append(view.cosine.size(), static_cast<char>(kFullWeight)) : content.append(BytesOf(view.weight));
  content.append(base::HashHex(content));
  base::WriteFileAtomically(file, content);
}

std::optional<RenderedView> LoadView(const std::filesystem::path& file, const ViewPose& pose, const std::string& key) {
  const std::string preamble = Preamble(pose, key);
  const size_t n_pixels = PixelsOf(pose), depth_bytes = n_pixels * sizeof(float);
  const size_t content_bytes = preamble.size() + n_pixels * kViewPixelBytes;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored) || std::filesystem::file_size(file, ignored) != content_bytes + kHashChars)
    return std::nullopt;
  const std::string text = base::ReadFile(file);
  if (text.size() != content_bytes + kHashChars || text.compare(0, preamble.size(), preamble) != 0) return std::nullopt;
  const std::string_view content = std::string_view(text).substr(0, content_bytes);
  if (base::HashHex(content) != std::string_view(text).substr(content_bytes)) return std::nullopt;
  RenderedView view;
  view.pose = pose;
  view.depth_m.resize(n_pixels);
  view.cosine.resize(n_pixels);
  view.weight.resize(n_pixels);
  if (n_pixels > 0) {
    std::memcpy(view.depth_m.data(), text.data() + preamble.size(), depth_bytes);
    std::memcpy(view.cosine.data(), text.data() + preamble.size() + depth_bytes, n_pixels);
    std::memcpy(view.weight.data(), text.data() + preamble.size() + depth_bytes + n_pixels, n_pixels);
  }
  return view;
}

RenderedView RequireView(const std::filesystem::path& file, const ViewPose& pose, const std::string& key) {
  std::optional<RenderedView> view = LoadView(file, pose, key);
  if (!view) throw base::InputError(file, "is missing or damaged", "Run the command again; it renders this view again");
  return std::move(*view);
}

void JoinViews(const std::vector<ViewPose>& poses, const std::string& key, const std::vector<std::filesystem::path>& parts,
               const std::filesystem::path& file) {
  std::vector<ViewRecord> records;
  records.reserve(poses.size());
  for (const ViewPose& pose : poses) records.push_back(RecordOf(pose));
  ViewsHeader header;
  header.key = FixedText(key);
  header.checksum = FixedText(base::HashHex(BytesOf(records)));
  header.views = poses.size();

  base::Progress progress("joining surface views", static_cast<double>(poses.size()), "views");
  base::OutputFile joined(file);
  joined.Append(BytesOf(header));
  joined.Append(BytesOf(records));
  for (size_t i = 0; i < poses.size(); ++i) {
    base::ThrowIfCancelled();
    const RenderedView view = RequireView(parts[i], poses[i], key);
    std::string picture(BytesOf(view.depth_m));
    picture.append(BytesOf(view.cosine)).append(BytesOf(view.weight));
    picture.resize(PictureBytes(poses[i]), '\0');
    joined.Append(picture);
    joined.Append(base::HashHex(picture));
    progress.Update(static_cast<double>(i + 1));
  }
  joined.Complete();
  joined.Publish();
  base::SyncPath(file.parent_path());
  progress.Finish();
}

}  // namespace skyquilt::surface
