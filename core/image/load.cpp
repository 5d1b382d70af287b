#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <streambuf>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/fill_alpha.h"
#include "core/image/image.h"
#include "core/image/jpeg_structure.h"
#include "core/image/pixel_format.h"

namespace skyquilt::image {
namespace {

using base::InputError;

constexpr const char* kFixDamaged = "Copy it again from the memory card, or remove it from the folder";

std::span<const uint8_t> AsBytes(std::string_view content) {
  return {reinterpret_cast<const uint8_t*>(content.data()), content.size()};
}

bool LooksLikeImage(std::string_view content) {
  using std::string_view_literals::operator""sv;
  return content.starts_with("\xFF\xD8\xFF"sv) || content.starts_with("\x89PNG"sv) || content.starts_with("II*\0"sv) ||
         content.starts_with("MM\0*"sv);
}

// Takes everything, so that the stream never fails: its state is shared by threads.
class Nowhere : public std::streambuf {
 protected:
  int overflow(int c) override { return c == traits_type::eof() ? 0 : c; }
  std::streamsize xsputn(const char* /*text*/, std::streamsize n) override { return n; }
};

struct Silence {
  std::mutex mutex;
  int users = 0;
  Nowhere nowhere;
  std::streambuf* kept = nullptr;
};

Silence& TheSilence() {
  static Silence silence;
  return silence;
}

// While one exists, std::cerr is silent: OpenCV prints there what it throws (and catches itself), several lines per damaged photo, which the errors
// of our loaders say in one. Any number may exist, in any threads. The program's own log does not go through std::cerr.
class QuietDecoder {
 public:
  QuietDecoder() {
    Silence& silence = TheSilence();
    const std::lock_guard lock(silence.mutex);
    if (silence.users++ > 0) return;
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    silence.kept = std::cerr.rdbuf(&silence.nowhere);
  }
  ~QuietDecoder() {
    Silence& silence = TheSilence();
    const std::lock_guard lock(silence.mutex);
    if (--silence.users == 0) std::cerr.rdbuf(silence.kept);
  }
  QuietDecoder(const QuietDecoder&) = delete;
  QuietDecoder& operator=(const QuietDecoder&) = delete;
};

// Decodes without conversion: bit depth and channels as in the file, BGR(A) order.
cv::Mat Decode(std::string_view content, const std::filesystem::path& file, int mode = cv::IMREAD_UNCHANGED) {
  if (content.empty()) throw InputError(file, "is empty", kFixDamaged);
  const JpegStructure jpeg = ParseJpeg(AsBytes(content), false);
  if (jpeg.is_jpeg && !jpeg.complete) throw InputError(file, "ends early (truncated JPEG)", kFixDamaged);
  if (jpeg.is_jpeg && jpeg.bits > 8) {
    throw InputError(file, "is a JPEG of " + std::to_string(jpeg.bits) + " bits, which no common program reads",
                     "Export it as TIFF or as 8-bit JPEG");
  }
  if (const PixelFormat format = PixelFormatOf(AsBytes(content)); format.bands > 4) {
    throw InputError(file, "has " + std::to_string(format.bands) + " bands, which are no picture by themselves",
                     "Give it to 'skyquilt prepare', which makes pictures of three bands (prepare.bands)");
  }
  cv::Mat pixels;
  try {
    const cv::Mat wrapped(1, static_cast<int>(std::min<size_t>(content.size(), INT32_MAX)), CV_8UC1, const_cast<char*>(content.data()));
    const QuietDecoder quiet;
    pixels = cv::imdecode(wrapped, mode);  // UNCHANGED does not apply the EXIF orientation either
  } catch (const cv::Exception& error) {
    throw InputError(file, "cannot be decoded (" + error.err + ")", kFixDamaged);
  }
  if (pixels.empty()) {
    if (LooksLikeImage(content)) throw InputError(file, "cannot be decoded (damaged or of an unsupported kind)", kFixDamaged);
    throw InputError(file, "is not an image", "Give JPEG, PNG or TIFF photos and keep other files out of the folder");
  }
  return pixels;
}

// The first 256 KiB, which contain the size of nearly all photos; empty if the file cannot be opened.
std::string ReadStart(const std::filesystem::path& file) {
  std::string content(256 * 1024, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (stream) stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return content;
}

Image8 ToRgb8(cv::Mat pixels, const std::filesystem::path& file) {
  if (pixels.depth() == CV_16U) {
    cv::Mat narrow;
    pixels.convertTo(narrow, CV_8U, 1.0 / 257.0);
    pixels = narrow;
  }
  if (pixels.depth() != CV_8U) throw InputError(file, "has pixels that are neither 8 nor 16 bit integers", "Export it as an 8-bit JPEG or PNG");
  int conversion = cv::COLOR_BGR2RGB;
  if (pixels.channels() == 1) {
    conversion = cv::COLOR_GRAY2RGB;
  } else if (pixels.channels() == 4) {
    conversion = cv::COLOR_BGRA2RGB;
  } else if (pixels.channels() != 3) {
    throw InputError(file, "has " + std::to_string(pixels.channels()) + " channels", "Export it as RGB");
  }
  Image8 image(pixels.cols, pixels.rows, 3);
  cv::Mat target(image.height, image.width, CV_8UC3, image.data.data());
  cv::cvtColor(pixels, target, conversion);
  return image;
}

}  // namespace

Image8 LoadRgb8(const std::filesystem::path& file) {
  return ToRgb8(Decode(base::ReadFile(file), file), file);
}

Image8 LoadRgb8Over(const std::filesystem::path& file, uint8_t background) {
  const cv::Mat pixels = Decode(base::ReadFile(file), file);
  if (pixels.channels() != 4 || (pixels.depth() != CV_8U && pixels.depth() != CV_16U)) return ToRgb8(pixels, file);
  const double largest = pixels.depth() == CV_8U ? 255.0 : 65535.0;
  Image8 image(pixels.cols, pixels.rows, 3);
  cv::Mat row;
  for (int y = 0; y < image.height; ++y) {
    pixels.row(y).convertTo(row, CV_64F, 1.0 / largest);
    const auto* bgra = row.ptr<cv::Vec4d>();
    uint8_t* out = image.At(0, y);
    for (int x = 0; x < image.width; ++x) {
      const double alpha = bgra[x][3];
      for (int c = 2; c >= 0; --c) *out++ = static_cast<uint8_t>(std::lround(255.0 * bgra[x][c] * alpha + background * (1.0 - alpha)));
    }
  }
  return image;
}

Image8 LoadReducedRgb8(const std::filesystem::path& file, int width) {
  const std::string content = base::ReadFile(file);
  const JpegStructure jpeg = ParseJpeg(AsBytes(content), false);
  int mode = cv::IMREAD_UNCHANGED;
  if (jpeg.is_jpeg && width > 0) {
    if (jpeg.width / 8 >= width) {
      mode = cv::IMREAD_REDUCED_COLOR_8;
    } else if (jpeg.width / 4 >= width) {
      mode = cv::IMREAD_REDUCED_COLOR_4;
    } else if (jpeg.width / 2 >= width) {
      mode = cv::IMREAD_REDUCED_COLOR_2;
    }
    if (mode != cv::IMREAD_UNCHANGED) mode |= cv::IMREAD_IGNORE_ORIENTATION;
  }
  return ToRgb8(Decode(content, file, mode), file);
}

Image8 DecodeRgb8(std::span<const uint8_t> bytes) {
  const std::filesystem::path name = "image in memory";
  return ToRgb8(Decode({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name), name);
}

void ReadImageSize(const std::filesystem::path& file, int* width, int* height) {
  // Not all of these can be decoded here.
  if (const PixelFormat format = ReadPixelFormat(file); format.kind == FileKind::kTiff && !IsPlain(format)) {
    *width = format.width;
    *height = format.height;
    if (*width <= 0 || *height <= 0) throw InputError(file, "has no image size in its header (ends early or damaged)", kFixDamaged);
    return;
  }
  std::string content = ReadStart(file);
  if (ParseJpeg(AsBytes(content), true).width == 0 && !content.starts_with("\x89PNG")) content = base::ReadFile(file);
  *width = 0;
  *height = 0;
  const JpegStructure jpeg = ParseJpeg(AsBytes(content), true);
  if (jpeg.is_jpeg) {
    *width = jpeg.width;
    *height = jpeg.height;
  } else if (content.starts_with("\x89PNG\r\n\x1A\n") && content.size() >= 24 && content.substr(12, 4) == "IHDR") {
    const auto big_endian = [&](size_t at) {
      uint32_t value = 0;
      for (size_t i = 0; i < 4; ++i) value = value << 8U | static_cast<uint8_t>(content[at + i]);
      return value > INT32_MAX ? 0 : static_cast<int>(value);
    };
    *width = big_endian(16);
    *height = big_endian(20);
  } else {
    const cv::Mat pixels = Decode(content, file);
    *width = pixels.cols;
    *height = pixels.rows;
  }
  if (*width <= 0 || *height <= 0) throw InputError(file, "has no image size in its header (ends early or damaged)", kFixDamaged);
}

Image8 LoadMask(const std::filesystem::path& file) {
  const cv::Mat pixels = Decode(base::ReadFile(file), file);
  if (pixels.depth() != CV_8U && pixels.depth() != CV_16U)
    throw InputError(file, "is a mask of an unsupported pixel type", "Save it as an 8-bit PNG");
  const int colours = pixels.channels() == 4 ? 3 : std::min(pixels.channels(), 3);
  const size_t pixel_bytes = pixels.elemSize();
  const size_t colour_bytes = pixels.elemSize1() * static_cast<size_t>(colours);
  Image8 mask(pixels.cols, pixels.rows, 1);
  for (int y = 0; y < mask.height; ++y) {
    const uint8_t* row = pixels.ptr<uint8_t>(y);
    uint8_t* out = mask.At(0, y);
    for (size_t x = 0; x < static_cast<size_t>(mask.width); ++x) {
      bool use = false;
      for (size_t b = 0; b < colour_bytes; ++b) use = use || row[x * pixel_bytes + b] != 0;
      out[x] = use ? 255 : 0;
    }
  }
  return mask;
}

Image8 LoadAlphaMask(const std::filesystem::path& file) {
  if (ReadPixelFormat(file).bands > 4) return {};
  const cv::Mat pixels = Decode(base::ReadFile(file), file);
  if (pixels.channels() != 4 || (pixels.depth() != CV_8U && pixels.depth() != CV_16U)) return {};
  cv::Mat alpha;
  cv::extractChannel(pixels, alpha, 3);
  const double half = pixels.depth() == CV_8U ? 127.5 : 32767.5;
  Image8 mask(alpha.cols, alpha.rows, 1);
  cv::Mat target(mask.height, mask.width, CV_8UC1, mask.data.data());
  cv::compare(alpha, half, target, cv::CMP_GT);
  return cv::countNonZero(target) == alpha.rows * alpha.cols ? Image8() : mask;
}

Image8 LoadLabels(const std::filesystem::path& file) {
  const cv::Mat pixels = Decode(base::ReadFile(file), file);
  if (pixels.type() != CV_8UC1) throw InputError(file, "is not an image of one channel with 8 bits", "Images of classes hold one number per pixel");
  Image8 labels(pixels.cols, pixels.rows, 1);
  cv::Mat target(labels.height, labels.width, CV_8UC1, labels.data.data());
  pixels.copyTo(target);
  return labels;
}

ImageF LoadFloatTiff(const std::filesystem::path& file) {
  const cv::Mat pixels = Decode(base::ReadFile(file), file);
  if (pixels.channels() != 1 || (pixels.depth() != CV_32F && pixels.depth() != CV_64F)) {
    throw InputError(file, "is not a one-channel floating-point TIFF", "Depth images hold metres as 32-bit floats");
  }
  ImageF image(pixels.cols, pixels.rows, 1);
  cv::Mat target(image.height, image.width, CV_32FC1, image.data.data());
  pixels.convertTo(target, CV_32F);
  return image;
}

}  // namespace skyquilt::image
