#include <hdf5.h>

#include <algorithm>
#include <functional>
#include <map>
#include <variant>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/checkpoint/archive.h"
#include "core/checkpoint/archive_array.h"
#include "core/checkpoint/hdf5_handle.h"
#include "core/checkpoint/user_block.h"

namespace skyquilt::checkpoint {
namespace {

using base::InputError;

constexpr const char* kFixVersion = "It comes from another version of the program; run the stage that writes it again with --restart";
constexpr const char* kFixDamaged = "Remove it and run the same command again, or restore a copy";

struct ArrayInfo {
  ElementType type = ElementType::kUint8;
  std::vector<int64_t> shape;
  size_t n_values = 0;
};

using Attribute = std::variant<std::string, double, int64_t>;

// C callbacks must not throw, so they only collect names.
herr_t CollectDatasets(hid_t, const char* name, const H5O_info_t* info, void* names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}
herr_t CollectAttributes(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

}  // namespace

struct ArchiveReader::Impl {
  std::filesystem::path path;
  std::string kind;
  int version = 0;
  uint64_t n_file_bytes = 0;
  Handle file;
  std::map<std::string, ArrayInfo> arrays;
  std::map<std::string, Attribute> attributes;

  ~Impl() {
    const HdfLock lock;
    file.Close();
  }

  [[noreturn]] void Damaged(const std::string& where) const {
    throw InputError(path, "is damaged: " + where + " (" + HdfErrorText() + ")", kFixDamaged);
  }

  void Open() {
    FileGuard guard;
    const std::string block = VerifiedUserBlock(path, &guard);
    n_file_bytes = guard.n_bytes;
    const HdfLock lock;
    const Handle access = FileAccess();
    file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
    if (!file.Valid()) Damaged("HDF5 cannot open it");
    ReadAttributes();
    ReadDirectory();
    if (block != UserBlockText(kind, version, guard))
      throw InputError(path, "is damaged: the description in its first bytes does not match its content", kFixDamaged);
  }

  void ReadAttributes() {
    std::vector<std::string> names;
    hsize_t position = 0;
    if (H5Aiterate2(file.id(), H5_INDEX_NAME, H5_ITER_INC, &position, CollectAttributes, &names) < 0) Damaged("its attributes cannot be listed");
    for (const std::string& name : names) attributes[name] = ReadAttribute(name);
    const auto kind_at = attributes.find("skyquilt.kind");
    const auto version_at = attributes.find("skyquilt.version");
    if (kind_at == attributes.end() || version_at == attributes.end() || !std::holds_alternative<std::string>(kind_at->second) ||
        !std::holds_alternative<int64_t>(version_at->second)) {
      throw InputError(path, "has no attributes with its kind and version", kFixDamaged);
    }
    kind = std::get<std::string>(kind_at->second);
    version = static_cast<int>(std::get<int64_t>(version_at->second));
    attributes.erase("skyquilt.kind");
    attributes.erase("skyquilt.version");
  }

  Attribute ReadAttribute(const std::string& name) const {
    const Handle attribute(H5Aopen(file.id(), name.c_str(), H5P_DEFAULT), H5Aclose);
    const Handle type(attribute.Valid() ? H5Aget_type(attribute.id()) : -1, H5Tclose);
    const Handle space(attribute.Valid() ? H5Aget_space(attribute.id()) : -1, H5Sclose);
    if (!type.Valid() || !space.Valid() || H5Sget_simple_extent_npoints(space.id()) != 1) Damaged("attribute " + name);
    const size_t n_bytes = H5Tget_size(type.id());
    const H5T_class_t type_class = H5Tget_class(type.id());
    if (type_class == H5T_STRING && n_bytes >= 1 && n_bytes <= n_file_bytes && H5Tis_variable_str(type.id()) == 0) {
      std::string text(n_bytes, '\0');
      if (H5Aread(attribute.id(), type.id(), text.data()) < 0) Damaged("attribute " + name);
      text.pop_back();
      return text;
    }
    if (type_class == H5T_FLOAT) {
      double value = 0.0;
      if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value) < 0) Damaged("attribute " + name);
      return value;
    }
    if (type_class == H5T_INTEGER) {
      int64_t value = 0;
      if (H5Aread(attribute.id(), H5T_NATIVE_INT64, &value) < 0) Damaged("attribute " + name);
      return value;
    }
    Damaged("attribute " + name + " has an unknown type");
  }

  void ReadDirectory() {
    std::vector<std::string> names;
    if (H5Ovisit(file.id(), H5_INDEX_NAME, H5_ITER_INC, CollectDatasets, &names) < 0) Damaged("its arrays cannot be listed");
    for (const std::string& name : names) arrays[name] = ReadInfo(name);
  }

  ArrayInfo ReadInfo(const std::string& name) const {
    const Handle dataset(H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(dataset.Valid() ? H5Dget_type(dataset.id()) : -1, H5Tclose);
    const Handle space(dataset.Valid() ? H5Dget_space(dataset.id()) : -1, H5Sclose);
    if (!type.Valid() || !space.Valid()) Damaged("array " + name);
    ArrayInfo info;
    bool known = false;
    for (const ElementType candidate :
         {ElementType::kFloat32, ElementType::kFloat64, ElementType::kUint8, ElementType::kInt64, ElementType::kBfloat16, ElementType::kFloat16}) {
      if (H5Tequal(type.id(), FileType(candidate)) > 0) {
        info.type = candidate;
        known = true;
      }
    }
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (!known || rank < 1) Damaged("array " + name + " has an unknown type or shape");
    std::vector<hsize_t> sizes(static_cast<size_t>(rank));
    if (H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr) != rank) Damaged("array " + name);
    info.n_values = 1;
    for (const hsize_t size : sizes) {
      // Nothing is compressed, so an array cannot be larger than its file. Check this before allocating memory.
      if (size != 0 && info.n_values > n_file_bytes / size) Damaged("array " + name + " has more values than the file has bytes");
      info.n_values *= size;
      info.shape.push_back(static_cast<int64_t>(size));
    }
    if (info.n_values * ElementBytes(info.type) > n_file_bytes) Damaged("array " + name + " is larger than the file");
    return info;
  }

  const ArrayInfo& Info(const std::string& name) const {
    const auto at = arrays.find(name);
    if (at == arrays.end()) throw InputError(path, "has no array '" + name + "'", kFixVersion);
    return at->second;
  }

  template <typename T>
  std::vector<T> Read(const std::string& name, ElementType type) const {
    const ArrayInfo& info = Info(name);
    if (info.type != type) {
      throw InputError(path, "has array '" + name + "' as " + ElementName(info.type) + " where " + ElementName(type) + " is expected", kFixVersion);
    }
    std::vector<T> values(info.n_values);
    if (values.empty()) return values;
    const HdfLock lock;
    const Handle dataset(H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.Valid() || H5Dread(dataset.id(), MemoryType(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) Damaged("array " + name);
    return values;
  }

  std::vector<float> ReadRows(const std::string& name, std::span<const int64_t> rows) const {
    const ArrayInfo& info = Info(name);
    if (info.type != ElementType::kFloat32) {
      throw InputError(path, "has array '" + name + "' as " + ElementName(info.type) + " where float32 is expected", kFixVersion);
    }
    const bool ascending = std::adjacent_find(rows.begin(), rows.end(), std::greater_equal<>()) == rows.end();
    SKYQUILT_CHECK(ascending && (rows.empty() || (rows.front() >= 0 && rows.back() < info.shape.front())), "rows of array '" + name + "'");
    if (rows.empty() || info.n_values == 0) return {};
    const auto each = static_cast<hsize_t>(info.n_values) / static_cast<hsize_t>(info.shape.front());
    std::vector<float> values(rows.size() * each);
    const HdfLock lock;
    const Handle dataset(H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(dataset.Valid() ? H5Dget_space(dataset.id()) : -1, H5Sclose);
    if (!space.Valid() || H5Sselect_none(space.id()) < 0) Damaged("array " + name);
    std::vector<hsize_t> start(info.shape.size(), 0), count(info.shape.begin(), info.shape.end());
    for (size_t i = 0; i < rows.size();) {
      size_t end = i + 1;
      while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
      start[0] = static_cast<hsize_t>(rows[i]);
      count[0] = static_cast<hsize_t>(end - i);
      if (H5Sselect_hyperslab(space.id(), H5S_SELECT_OR, start.data(), nullptr, count.data(), nullptr) < 0) Damaged("array " + name);
      i = end;
    }
    const auto n = static_cast<hsize_t>(values.size());
    const Handle memory(H5Screate_simple(1, &n, nullptr), H5Sclose);
    if (!memory.Valid() || H5Dread(dataset.id(), H5T_NATIVE_FLOAT, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) Damaged("array " + name);
    return values;
  }

  template <typename T>
  const T& Get(const std::string& name, const char* type_name) const {
    const auto at = attributes.find(name);
    if (at == attributes.end()) throw InputError(path, "has no attribute '" + name + "'", kFixVersion);
    const T* value = std::get_if<T>(&at->second);
    if (value == nullptr) throw InputError(path, "has attribute '" + name + "', but not as a " + type_name, kFixVersion);
    return *value;
  }
};

ArchiveReader::ArchiveReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  impl_->path = file;
  impl_->Open();
}
ArchiveReader::~ArchiveReader() = default;
ArchiveReader::ArchiveReader(ArchiveReader&&) noexcept = default;

const std::string& ArchiveReader::kind() const {
  return impl_->kind;
}
int ArchiveReader::version() const {
  return impl_->version;
}

void ArchiveReader::RequireVersion(int expected) const {
  if (impl_->version == expected) return;
  throw InputError(
      impl_->path,
      "is a " + impl_->kind + " file of version " + std::to_string(impl_->version) + ", but this program reads version " + std::to_string(expected),
      "Use the program version that wrote it, or run the stage that writes it again with --restart");
}

std::vector<std::string> ArchiveReader::Names() const {
  std::vector<std::string> names;
  for (const auto& [name, unused] : impl_->arrays) names.push_back(name);
  return names;
}
std::vector<std::string> ArchiveReader::AttributeNames() const {
  std::vector<std::string> names;
  for (const auto& [name, unused] : impl_->attributes) names.push_back(name);
  return names;
}
bool ArchiveReader::Has(const std::string& name) const {
  return impl_->arrays.contains(name);
}
bool ArchiveReader::HasAttribute(const std::string& name) const {
  return impl_->attributes.contains(name);
}
std::vector<int64_t> ArchiveReader::Shape(const std::string& name) const {
  return impl_->Info(name).shape;
}
std::string ArchiveReader::TypeName(const std::string& name) const {
  return ElementName(impl_->Info(name).type);
}

std::vector<float> ArchiveReader::Floats(const std::string& name) const {
  const ElementType stored = impl_->Info(name).type;
  if (IsShortFloat(stored)) return FloatsOf(impl_->Read<uint16_t>(name, stored), stored);
  return impl_->Read<float>(name, ElementType::kFloat32);
}
std::vector<float> ArchiveReader::FloatRows(const std::string& name, std::span<const int64_t> rows) const {
  return impl_->ReadRows(name, rows);
}
std::vector<float> ArchiveReader::PrunedFloats(const std::string& name) const {
  std::vector<float> kept = Floats(name);
  if (!Has(KeepBitsName(name))) return kept;
  const std::vector<uint8_t> keep = Bytes(KeepBitsName(name));
  const std::vector<int64_t> sizes = Ints(KeepSizesName(name));
  const bool plausible = sizes.size() == 2 && sizes[0] > 0 && sizes[1] >= 0 && sizes[1] % sizes[0] == 0 &&
                         static_cast<int64_t>(keep.size()) == (sizes[1] / sizes[0] + 7) / 8;
  if (!plausible || CountStored(keep, sizes[1] / sizes[0]) * sizes[0] != static_cast<int64_t>(kept.size())) {
    throw InputError(impl_->path, "array " + name + " does not match the list of its stored groups", kFixDamaged);
  }
  return Spread(kept, keep, sizes[0], sizes[1]);
}
std::vector<double> ArchiveReader::Doubles(const std::string& name) const {
  return impl_->Read<double>(name, ElementType::kFloat64);
}
std::vector<uint8_t> ArchiveReader::Bytes(const std::string& name) const {
  return impl_->Read<uint8_t>(name, ElementType::kUint8);
}
std::vector<int64_t> ArchiveReader::Ints(const std::string& name) const {
  return impl_->Read<int64_t>(name, ElementType::kInt64);
}
std::string ArchiveReader::StringAttribute(const std::string& name) const {
  return impl_->Get<std::string>(name, "text");
}
double ArchiveReader::DoubleAttribute(const std::string& name) const {
  return impl_->Get<double>(name, "number");
}
int64_t ArchiveReader::IntAttribute(const std::string& name) const {
  return impl_->Get<int64_t>(name, "whole number");
}

std::filesystem::path NewestUsable(const std::filesystem::path& file, const std::string& kind, std::string* why) {
  std::string reasons;
  const std::filesystem::path previous = file.string() + ".prev";
  for (const std::filesystem::path& candidate : {file, previous}) {
    try {
      const ArchiveReader reader(candidate);
      if (reader.kind() == kind) {
        if (candidate == previous) base::LogWarning("{}; using the previous file {} instead", reasons, previous.string());
        return candidate;
      }
      throw InputError(candidate, "is an archive of kind '" + reader.kind() + "' where '" + kind + "' is expected", "");
    } catch (const InputError& error) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  if (why != nullptr) *why = reasons;
  return {};
}

}  // namespace skyquilt::checkpoint
