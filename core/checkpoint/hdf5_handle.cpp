#include "core/checkpoint/hdf5_handle.h"

#include <hdf5.h>

#include <type_traits>

#include "core/base/errors.h"

namespace skyquilt::checkpoint {
namespace {

static_assert(std::is_same_v<HdfId, hid_t> && std::is_same_v<HdfSize, hsize_t> && std::is_same_v<int, herr_t>);

std::recursive_mutex& LibraryMutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

herr_t KeepDescription(unsigned, const H5E_error2_t* error, void* text) {
  if (error->desc != nullptr && error->desc[0] != '\0') *static_cast<std::string*>(text) = error->desc;
  return 0;
}

// A 16-bit float type with the byte order of the 32-bit type `single`.
hid_t Float16Of(hid_t single, size_t exponent_bits, size_t bias) {
  const hid_t type = H5Tcopy(single);
  const size_t mantissa_bits = 15 - exponent_bits;
  SKYQUILT_CHECK(
      H5Tset_fields(type, 15, mantissa_bits, exponent_bits, 0, mantissa_bits) >= 0 && H5Tset_size(type, 2) >= 0 && H5Tset_ebias(type, bias) >= 0,
      HdfErrorText());
  return type;
}

}  // namespace

HdfLock::HdfLock() : lock_(LibraryMutex()) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string HdfErrorText() {
  std::string text = "no message from HDF5";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, KeepDescription, &text);
  return text;
}

size_t ElementBytes(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
      return 4;
    case ElementType::kUint8:
      return 1;
    case ElementType::kBfloat16:
    case ElementType::kFloat16:
      return 2;
    case ElementType::kFloat64:
    case ElementType::kInt64:
      break;
  }
  return 8;
}

const char* ElementName(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
      return "float32";
    case ElementType::kFloat64:
      return "float64";
    case ElementType::kUint8:
      return "uint8";
    case ElementType::kBfloat16:
      return "bfloat16";
    case ElementType::kFloat16:
      return "float16";
    case ElementType::kInt64:
      break;
  }
  return "int64";
}

namespace {

struct TypeIds {
  hid_t file = -1, memory = -1;
};

TypeIds IdsOf(ElementType type) {
  static const TypeIds kBfloat16 = {Float16Of(H5T_IEEE_F32LE, 8, 127), Float16Of(H5T_NATIVE_FLOAT, 8, 127)};
  static const TypeIds kFloat16 = {Float16Of(H5T_IEEE_F32LE, 5, 15), Float16Of(H5T_NATIVE_FLOAT, 5, 15)};
  switch (type) {
    case ElementType::kFloat32:
      return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT};
    case ElementType::kFloat64:
      return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
    case ElementType::kUint8:
      return {H5T_STD_U8LE, H5T_NATIVE_UINT8};
    case ElementType::kBfloat16:
      return kBfloat16;
    case ElementType::kFloat16:
      return kFloat16;
    case ElementType::kInt64:
      break;
  }
  return {H5T_STD_I64LE, H5T_NATIVE_INT64};
}

}  // namespace

hid_t FileType(ElementType type) {
  return IdsOf(type).file;
}

hid_t MemoryType(ElementType type) {
  return IdsOf(type).memory;
}

Handle FileAccess() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  SKYQUILT_CHECK(access.Valid() && H5Pset_libver_bounds(access.id(), H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0, HdfErrorText());
  SKYQUILT_CHECK(H5Pset_file_locking(access.id(), false, true) >= 0, HdfErrorText());
  SKYQUILT_CHECK(H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG) >= 0, HdfErrorText());
  return access;
}

Handle SimpleSpace(const std::vector<hsize_t>& shape) {
  Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  SKYQUILT_CHECK(space.Valid(), HdfErrorText());
  return space;
}

}  // namespace skyquilt::checkpoint
