#include "core/image/develop.h"

#include <libheif/heif.h>
#include <libraw/libraw.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "core/base/errors.h"
#include "core/base/memory_map.h"
#include "core/base/text.h"

namespace skyquilt::image {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFixCopy = "Copy it again from the camera, or export it as JPEG or TIFF";
constexpr int kLargest = 65'535;

bool HasOneOf(const std::string& file_name, const auto& extensions) {
  const std::string extension = base::LowerCase(fs::path(file_name).extension().string());
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

bool IsHeif(const std::string& file_name) {
  static constexpr std::array<std::string_view, 4> kHeif = {".heic", ".heif", ".hif", ".avif"};
  return HasOneOf(file_name, kHeif);
}

void RequireSize(const fs::path& file, int width, int height) {
  if (width <= 0 || height <= 0 || width > kLargest || height > kLargest) {
    throw base::InputError(file, "has a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels", kFixCopy);
  }
}

// The main picture of a HEIF file.
class HeifPhoto {
 public:
  explicit HeifPhoto(const fs::path& file) : file_(file), bytes_(file), context_(heif_context_alloc(), heif_context_free) {
    Check(heif_context_read_from_memory_without_copy(context_.get(), bytes_.bytes().data(), bytes_.bytes().size(), nullptr));
    heif_image_handle* handle = nullptr;
    Check(heif_context_get_primary_image_handle(context_.get(), &handle));
    handle_.reset(handle);
    width = heif_image_handle_get_ispe_width(handle);
    height = heif_image_handle_get_ispe_height(handle);
    RequireSize(file, width, height);
  }

  Image8 Decode() const {
    const std::unique_ptr<heif_decoding_options, decltype(&heif_decoding_options_free)> options(heif_decoding_options_alloc(),
                                                                                                heif_decoding_options_free);
    options->ignore_transformations = 1;
    options->convert_hdr_to_8bit = 1;
    heif_image* decoded = nullptr;
    Check(heif_decode_image(handle_.get(), &decoded, heif_colorspace_RGB, heif_chroma_interleaved_RGB, options.get()));
    const std::unique_ptr<heif_image, decltype(&heif_image_release)> picture(decoded, heif_image_release);
    const int decoded_width = heif_image_get_width(decoded, heif_channel_interleaved);
    const int decoded_height = heif_image_get_height(decoded, heif_channel_interleaved);
    int stride = 0;
    const uint8_t* rows = heif_image_get_plane_readonly(decoded, heif_channel_interleaved, &stride);
    if (rows == nullptr || decoded_width != width || decoded_height != height) {
      throw base::InputError(file_, "has a picture of another size than it says", kFixCopy);
    }
    Image8 image(width, height, 3);
    for (int y = 0; y < height; ++y) std::copy_n(rows + static_cast<ptrdiff_t>(stride) * y, static_cast<size_t>(3) * width, image.At(0, y));
    return image;
  }

  // From the TIFF header on; empty: none.
  std::string Exif() const {
    heif_item_id block = 0;
    if (heif_image_handle_get_list_of_metadata_block_IDs(handle_.get(), "Exif", &block, 1) < 1) return {};
    std::string exif(heif_image_handle_get_metadata_size(handle_.get(), block), '\0');
    Check(heif_image_handle_get_metadata(handle_.get(), block, exif.data()));
    // Four bytes say how many more come before the header.
    constexpr size_t kOffsetBytes = 4;
    if (exif.size() < kOffsetBytes) return {};
    size_t offset = 0;
    for (size_t i = 0; i < kOffsetBytes; ++i) offset = offset << 8U | static_cast<uint8_t>(exif[i]);
    return offset < exif.size() - kOffsetBytes ? exif.substr(kOffsetBytes + offset) : std::string();
  }

  int width = 0, height = 0;  // pixels, as stored

 private:
  void Check(const heif_error& error) const {
    if (error.code == heif_error_Ok) return;
    throw base::InputError(file_, std::string("cannot be read as HEIC (") + (error.message == nullptr ? "no reason" : error.message) + ")", kFixCopy);
  }

  fs::path file_;
  base::MemoryMap bytes_;
  std::unique_ptr<heif_context, decltype(&heif_context_free)> context_;
  struct ReleaseHandle {
    void operator()(heif_image_handle* handle) const { heif_image_handle_release(handle); }
  };
  std::unique_ptr<heif_image_handle, ReleaseHandle> handle_;
};

// A raw file, opened with the settings of all.
class RawPhoto {
 public:
  explicit RawPhoto(const fs::path& file) : file_(file), bytes_(file), raw_(std::make_unique<LibRaw>()) {
    libraw_output_params_t& params = raw_->imgdata.params;
    params.use_camera_wb = 1;
    params.no_auto_bright = 1;
    params.adjust_maximum_thr = 0.0F;  // white stays that of the sensor, whatever the photo shows
    params.user_flip = 0;
    params.output_color = 1;  // sRGB
    params.output_bps = 8;
    params.gamm[0] = 1.0 / 2.4;
    params.gamm[1] = 12.92;
    // LibRaw does not change the bytes.
    Check(raw_->open_buffer(const_cast<uint8_t*>(bytes_.bytes().data()), bytes_.bytes().size()));
  }

  void Size(int* width, int* height) {
    Check(raw_->adjust_sizes_info_only());
    *width = raw_->imgdata.sizes.iwidth;
    *height = raw_->imgdata.sizes.iheight;
    RequireSize(file_, *width, *height);
  }

  Image8 Decode() {
    Check(raw_->unpack());
    Check(raw_->dcraw_process());
    int status = LIBRAW_SUCCESS;
    const std::unique_ptr<libraw_processed_image_t, decltype(&LibRaw::dcraw_clear_mem)> picture(raw_->dcraw_make_mem_image(&status),
                                                                                                LibRaw::dcraw_clear_mem);
    Check(status);
    const bool usable = picture && picture->type == LIBRAW_IMAGE_BITMAP && picture->bits == 8 && (picture->colors == 3 || picture->colors == 1);
    if (!usable) throw base::InputError(file_, "is developed to a picture of another kind than RGB of 8 bits", kFixCopy);
    Image8 image(picture->width, picture->height, 3);
    const size_t n = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
    if (picture->colors == 3) {
      std::copy_n(picture->data, 3 * n, image.data.begin());
    } else {
      for (size_t i = 0; i < n; ++i) std::fill_n(image.data.begin() + static_cast<ptrdiff_t>(3 * i), 3, picture->data[i]);
    }
    return image;
  }

 private:
  void Check(int status) const {
    if (status == LIBRAW_SUCCESS) return;
    throw base::InputError(file_, std::string("cannot be read as a raw photo (") + libraw_strerror(status) + ")", kFixCopy);
  }

  fs::path file_;
  base::MemoryMap bytes_;
  std::unique_ptr<LibRaw> raw_;
};

void RequireContent(const fs::path& file) {
  std::error_code error;
  if (fs::file_size(file, error) == 0 && !error) throw base::InputError(file, "is empty", kFixCopy);
}

}  // namespace

bool NeedsDeveloping(const std::string& file_name) {
  static constexpr std::array<std::string_view, 12> kRaw = {".dng", ".cr2", ".cr3", ".nef", ".nrw", ".arw",
                                                            ".sr2", ".raf", ".orf", ".rw2", ".pef", ".srw"};
  return IsHeif(file_name) || HasOneOf(file_name, kRaw);
}

void ReadDevelopedSize(const fs::path& file, int* width, int* height) {
  RequireContent(file);
  if (!IsHeif(file.filename().string())) {
    RawPhoto(file).Size(width, height);
    return;
  }
  const HeifPhoto photo(file);
  *width = photo.width;
  *height = photo.height;
}

std::string ExifOfHeif(const fs::path& file) {
  return IsHeif(file.filename().string()) ? HeifPhoto(file).Exif() : std::string();
}

Image8 DevelopPhoto(const fs::path& file) {
  RequireContent(file);
  return IsHeif(file.filename().string()) ? HeifPhoto(file).Decode() : RawPhoto(file).Decode();
}

}  // namespace skyquilt::image
