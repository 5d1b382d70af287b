#include "tour/export/script_data.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/output_file.h"

namespace skyquilt::tour {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::string_view kCall = "skyquiltData(\"", kBetween = "\", \"", kEnd = "\");\n";
constexpr size_t kPieceBytes = 3U << 18U;  // a multiple of 3, so that pieces need no padding between them

class ScriptFileWriter {
 public:
  ScriptFileWriter(const std::filesystem::path& folder, std::string_view name) : target_(ScriptFile(folder, name)), file_(Prepared(target_)) {
    file_.Append(kCall);
    file_.Append(name);
    file_.Append(kBetween);
  }
  // All pieces but the last have a multiple of 3 bytes.
  void Add(std::string_view piece) { file_.Append(Base64(piece)); }
  int64_t Finish() {
    file_.Append(kEnd);
    file_.Complete();
    file_.Publish();
    return static_cast<int64_t>(file_.size());
  }

 private:
  static const std::filesystem::path& Prepared(const std::filesystem::path& target) {
    std::error_code error;
    std::filesystem::create_directories(target.parent_path(), error);
    if (error) base::ThrowFileError(target.parent_path(), "cannot be created", error.value());
    return target;
  }

  std::filesystem::path target_;
  base::OutputFile file_;
};

}  // namespace

void RequireDataName(std::string_view name) {
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '/'; };
  const bool plain = !name.empty() && name.front() != '/' && name.find("..") == std::string_view::npos &&
                     std::all_of(name.begin(), name.end(), [&](char c) { return is_plain(static_cast<unsigned char>(c)); });
  SKYQUILT_CHECK(plain, std::string(name));
}

int64_t ScriptBytes(std::string_view name, int64_t bytes) {
  return static_cast<int64_t>(kCall.size() + name.size() + kBetween.size() + kEnd.size()) + (bytes + 2) / 3 * 4;
}

std::filesystem::path ScriptFile(const std::filesystem::path& folder, std::string_view name) {
  RequireDataName(name);
  return folder / (std::string(name) + ".js");
}

std::string Base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t n = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8U | (k < n ? static_cast<uint8_t>(bytes[i + k]) : 0U);
    for (size_t k = 0; k < 4; ++k) text.push_back(k <= n ? kDigits[group >> (18U - 6U * k) & 63U] : '=');
  }
  return text;
}

int64_t WriteScript(const std::filesystem::path& folder, std::string_view name, std::string_view content) {
  ScriptFileWriter writer(folder, name);
  for (size_t at = 0; at < content.size(); at += kPieceBytes) writer.Add(content.substr(at, kPieceBytes));
  return writer.Finish();
}

int64_t WriteScriptOf(const std::filesystem::path& folder, std::string_view name, const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) base::ThrowFileError(file, "cannot be read", errno);
  ScriptFileWriter writer(folder, name);
  std::vector<char> piece(kPieceBytes);
  while (stream) {
    base::ThrowIfCancelled();
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    writer.Add({piece.data(), static_cast<size_t>(stream.gcount())});
  }
  if (stream.bad()) throw base::InputError(file, "cannot be read to its end", "Check the disk");
  return writer.Finish();
}

}  // namespace skyquilt::tour
