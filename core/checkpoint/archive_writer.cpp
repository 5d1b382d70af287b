#include <hdf5.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <list>
#include <map>
#include <numeric>
#include <set>
#include <variant>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/checkpoint/archive.h"
#include "core/checkpoint/archive_array.h"
#include "core/checkpoint/guarded_driver.h"
#include "core/checkpoint/hdf5_handle.h"
#include "core/checkpoint/user_block.h"

namespace skyquilt::checkpoint {
namespace {

using base::InputError;

constexpr std::chrono::hours kAbandonedAfter{1};
constexpr size_t kMaxChunkBytes = size_t{1} << 20U;
constexpr const char* kFixDisk = "Free disk space or choose an output folder that can be written, then run the same command again";

using Attribute = std::variant<std::string, double, int64_t>;

[[noreturn]] void Fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file, what + " (" + HdfErrorText() + ")", kFixDisk);
}

// Halves the slowest dimensions until a chunk holds at most kMaxChunkBytes.
std::vector<hsize_t> ChunkShape(const Array& array) {
  std::vector<hsize_t> chunk = array.shape;
  const auto bytes = [&] {
    size_t n = ElementBytes(array.type);
    for (const hsize_t size : chunk) n *= size;
    return n;
  };
  for (hsize_t& size : chunk) {
    while (size > 1 && bytes() > kMaxChunkBytes) size = (size + 1) / 2;
  }
  return chunk;
}

void WriteArray(hid_t file, const std::string& name, const Array& array, const void* data, const std::filesystem::path& path) {
  const Handle space = SimpleSpace(array.shape);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  SKYQUILT_CHECK(creation.Valid() && H5Pset_obj_track_times(creation.id(), false) >= 0, HdfErrorText());
  if (array.n_bytes > 0) {
    const std::vector<hsize_t> chunk = ChunkShape(array);
    SKYQUILT_CHECK(H5Pset_chunk(creation.id(), static_cast<int>(chunk.size()), chunk.data()) >= 0, HdfErrorText());
    SKYQUILT_CHECK(H5Pset_fletcher32(creation.id()) >= 0, HdfErrorText());
    // Every chunk is written completely, so it need not be filled first.
    SKYQUILT_CHECK(H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER) >= 0, HdfErrorText());
  }
  Handle dataset(H5Dcreate2(file, name.c_str(), FileType(array.type), space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Dclose);
  if (!dataset.Valid()) Fail(path, "cannot be written at array " + name);
  if (array.n_bytes > 0 && H5Dwrite(dataset.id(), MemoryType(array.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    Fail(path, "cannot be written at array " + name);
  }
  if (!dataset.Close()) Fail(path, "cannot be written at array " + name);
}

void WriteAttribute(hid_t file, const std::string& name, const Attribute& value, const std::filesystem::path& path) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  Handle string_type;
  hid_t type = H5T_IEEE_F64LE;
  hid_t memory_type = H5T_NATIVE_DOUBLE;
  const void* data = nullptr;
  if (const auto* text = std::get_if<std::string>(&value)) {
    // Store the terminating zero too, because HDF5 has no empty strings.
    string_type = Handle(H5Tcopy(H5T_C_S1), H5Tclose);
    SKYQUILT_CHECK(H5Tset_size(string_type.id(), text->size() + 1) >= 0 && H5Tset_cset(string_type.id(), H5T_CSET_UTF8) >= 0, HdfErrorText());
    type = memory_type = string_type.id();
    data = text->c_str();
  } else if (const auto* number = std::get_if<double>(&value)) {
    data = number;
  } else {
    type = H5T_STD_I64LE;
    memory_type = H5T_NATIVE_INT64;
    data = &std::get<int64_t>(value);
  }
  Handle attribute(H5Acreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute.Valid() || H5Awrite(attribute.id(), memory_type, data) < 0 || !attribute.Close())
    Fail(path, "cannot be written at attribute " + name);
}

// Creates the groups explicitly, with a property list that keeps the current time out of the file.
void WriteGroups(hid_t file, const std::set<std::string>& groups, const std::filesystem::path& path) {
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  SKYQUILT_CHECK(creation.Valid() && H5Pset_obj_track_times(creation.id(), false) >= 0, HdfErrorText());
  for (const std::string& name : groups) {
    const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose);
    if (!group.Valid()) Fail(path, "cannot be written at group " + name);
  }
}

// "a/b/c" has the groups "a" and "a/b".
std::set<std::string> GroupsOf(const std::string& name) {
  std::set<std::string> groups;
  for (size_t at = name.find('/'); at != std::string::npos; at = name.find('/', at + 1)) groups.insert(name.substr(0, at));
  return groups;
}

// Removes the temporary file if it still exists. Empties it first: after a failed write HDF5 may still have it open, which would keep the disk space
// in use.
struct RemoveOnExit {
  std::filesystem::path file;
  ~RemoveOnExit() {
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) std::filesystem::resize_file(file, 0, ignored);
    std::filesystem::remove(file, ignored);
  }
};

// Unique per process: another one may write the same file at the same time, for instance a rank on a host that lost its connection after its job was
// started again.
std::filesystem::path TemporaryOf(const std::filesystem::path& file) {
  return file.string() + ".tmp." + base::HostName() + "." + std::to_string(getpid());
}

// Removes temporary files of killed writers: their process on this host no longer exists, or the file is older than any write takes.
void RemoveAbandoned(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const std::string start = file.filename().string() + ".tmp.";
  const std::string here = start + base::HostName() + ".";
  std::error_code ignored;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(start)) continue;
    const long pid = name.starts_with(here) ? std::strtol(name.c_str() + here.size(), nullptr, 10) : 0;
    const bool dead = pid > 0 && pid != getpid() && kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH;
    const bool old = std::filesystem::file_time_type::clock::now() - entry.last_write_time(ignored) > kAbandonedAfter;
    if (dead || old) std::filesystem::remove(entry.path(), ignored);
  }
}

// Gives the old file a second name before the rename, so that a complete file exists even if the process is killed in between.
void ReplaceKeepingPrevious(const std::filesystem::path& temporary, const std::filesystem::path& file) {
  const std::filesystem::path previous = file.string() + ".prev";
  std::filesystem::path new_previous = temporary;
  new_previous += ".prev";
  std::error_code ignored;
  std::filesystem::remove(new_previous, ignored);
  if (!std::filesystem::exists(file)) {
    base::Rename(temporary, file);
  } else if (link(file.c_str(), new_previous.c_str()) == 0) {
    base::Rename(temporary, file);
    base::Rename(new_previous, previous);
  } else {  // no hard links on this file system
    base::Rename(file, previous);
    base::Rename(temporary, file);
  }
  base::SyncPath(file.has_parent_path() ? file.parent_path() : ".");
}

}  // namespace

struct ArchiveWriter::Impl {
  std::string kind;
  int version = 0;
  std::map<std::string, Array> arrays;
  std::map<std::string, Attribute> attributes;
  mutable Copies copies;
  std::list<std::variant<std::vector<uint8_t>, std::vector<int64_t>, std::vector<float>>> owned;

  void Put(const std::string& name, ElementType type, const void* data, size_t n, const std::vector<int64_t>& shape) {
    SKYQUILT_CHECK(!name.empty() && name.front() != '/' && name.back() != '/' && name.find("//") == std::string::npos, "array name '" + name + "'");
    SKYQUILT_CHECK(!arrays.contains(name), "two arrays have the name " + name);
    for (const auto& [other, unused] : arrays) {
      const bool clash = GroupsOf(other).contains(name) || GroupsOf(name).contains(other);
      SKYQUILT_CHECK(!clash, std::string("array ").append(name).append(" clashes with array ").append(other));
    }
    Array array;
    array.type = type;
    array.data = data;
    array.n_bytes = n * ElementBytes(type);
    size_t n_shape = 1;
    for (const int64_t size : shape) {
      SKYQUILT_CHECK(size >= 0, "array " + name + " has a negative size");
      array.shape.push_back(static_cast<hsize_t>(size));
      n_shape *= static_cast<size_t>(size);
    }
    if (shape.empty()) array.shape = {n};
    SKYQUILT_CHECK(shape.empty() || n_shape == n,
                   "array " + name + " has " + std::to_string(n) + " values for a shape of " + std::to_string(n_shape));
    arrays[name] = std::move(array);
  }

  void SetAttribute(const std::string& name, Attribute value) {
    SKYQUILT_CHECK(!name.empty() && name.rfind("skyquilt.", 0) != 0, "attribute name '" + name + "'");
    attributes[name] = std::move(value);
  }

  void Write(const std::filesystem::path& path) const {
    const HdfLock lock;
    WriteOutcome outcome;
    try {
      WriteAll(path, &outcome);
    } catch (const InputError&) {
      // The system's error number is more precise than HDF5's message.
      if (outcome.error == 0) throw;
    }
    if (outcome.error != 0) base::ThrowFileError(path, "cannot be written", outcome.error);
  }

  void WriteAll(const std::filesystem::path& path, WriteOutcome* outcome) const {
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    SKYQUILT_CHECK(creation.Valid() && H5Pset_userblock(creation.id(), kUserBlockBytes) >= 0, HdfErrorText());
    SKYQUILT_CHECK(H5Pset_obj_track_times(creation.id(), false) >= 0, HdfErrorText());
    const Handle access = FileAccess();
    UseGuardedDriver(access, outcome);
    Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose);
    if (!file.Valid()) Fail(path, "cannot be created");
    WriteAttribute(file.id(), "skyquilt.kind", kind, path);
    WriteAttribute(file.id(), "skyquilt.version", static_cast<int64_t>(version), path);
    for (const auto& [name, value] : attributes) WriteAttribute(file.id(), name, value, path);
    std::set<std::string> groups;
    for (const auto& [name, unused] : arrays) groups.merge(GroupsOf(name));
    WriteGroups(file.id(), groups, path);
    for (const auto& [name, array] : arrays) {
      WriteArray(file.id(), name, array, copies.Data(array), path);
      if (outcome->error != 0) break;
    }
    if (!file.Close()) Fail(path, "cannot be written");
  }

  // Reopens the file with ArchiveReader and compares every byte with the original values.
  void Verify(const std::filesystem::path& path) const {
    const ArchiveReader reader(path);
    bool same = reader.kind() == kind && reader.version() == version && reader.Names().size() == arrays.size() &&
                reader.AttributeNames().size() == attributes.size();
    for (const auto& [name, array] : arrays) {
      if (!same) break;
      const std::vector<int64_t> shape = reader.Shape(name);
      same = reader.TypeName(name) == ElementName(array.type) && std::equal(shape.begin(), shape.end(), array.shape.begin(), array.shape.end(),
                                                                            [](int64_t a, hsize_t b) { return static_cast<hsize_t>(a) == b; });
      if (!same) break;
      same = array.n_bytes == 0 || std::memcmp(AsStored(reader, name, array.type).data(), copies.Data(array), array.n_bytes) == 0;
    }
    if (!same) throw InputError(path, "has other content than was written", "Check the disk, then run the same command again");
  }
};

ArchiveWriter::ArchiveWriter(const std::string& kind, int version) : impl_(std::make_unique<Impl>()) {
  SKYQUILT_CHECK(!kind.empty() && kind.size() < 64 && kind.find('\n') == std::string::npos, "archive kind '" + kind + "'");
  impl_->kind = kind;
  impl_->version = version;
}
ArchiveWriter::~ArchiveWriter() = default;
ArchiveWriter::ArchiveWriter(ArchiveWriter&&) noexcept = default;

void ArchiveWriter::Put(const std::string& name, std::span<const float> values, const std::vector<int64_t>& shape) {
  impl_->Put(name, ElementType::kFloat32, values.data(), values.size(), shape);
}
void ArchiveWriter::Put(const std::string& name, std::span<const double> values, const std::vector<int64_t>& shape) {
  impl_->Put(name, ElementType::kFloat64, values.data(), values.size(), shape);
}
void ArchiveWriter::Put(const std::string& name, std::span<const uint8_t> values, const std::vector<int64_t>& shape) {
  impl_->Put(name, ElementType::kUint8, values.data(), values.size(), shape);
}
void ArchiveWriter::Put(const std::string& name, std::span<const int64_t> values, const std::vector<int64_t>& shape) {
  impl_->Put(name, ElementType::kInt64, values.data(), values.size(), shape);
}
void ArchiveWriter::PutOwned(const std::string& name, std::vector<uint8_t> values) {
  Put(name, std::get<std::vector<uint8_t>>(impl_->owned.emplace_back(std::move(values))));
}
void ArchiveWriter::PutOwned(const std::string& name, std::vector<int64_t> values) {
  Put(name, std::get<std::vector<int64_t>>(impl_->owned.emplace_back(std::move(values))));
}
void ArchiveWriter::PutOwned(const std::string& name, std::vector<float> values) {
  Put(name, std::get<std::vector<float>>(impl_->owned.emplace_back(std::move(values))));
}
void ArchiveWriter::PutCopy(const std::string& name, const std::filesystem::path& file, const std::string& array, Precision precision) {
  const ArchiveReader& reader = impl_->copies.Reader(file);
  const std::vector<int64_t> shape = reader.Shape(array);
  const auto n = static_cast<size_t>(std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>()));
  impl_->Put(name, StoredAs(ElementOf(reader.TypeName(array)), precision), nullptr, n, shape);
  impl_->arrays.at(name).copied_from = file;
  impl_->arrays.at(name).copied_array = array;
}
void ArchiveWriter::PutPruned(const std::string& name, const std::filesystem::path& file, const std::string& array, std::vector<uint8_t> keep,
                              int64_t group, Precision precision) {
  const ArchiveReader& reader = impl_->copies.Reader(file);
  const std::vector<int64_t> shape = reader.Shape(array);
  const ElementType type = ElementOf(reader.TypeName(array));
  SKYQUILT_CHECK(shape.size() == 1 && (type == ElementType::kFloat32 || IsShortFloat(type)),
                 "array " + array + " is not a one-dimensional array of floats");
  const int64_t total = shape[0];
  SKYQUILT_CHECK(group > 0 && total % group == 0 && static_cast<int64_t>(keep.size()) == (total / group + 7) / 8,
                 "array " + array + " of " + std::to_string(total) + " floats cannot be divided into groups of " + std::to_string(group));
  const auto& bits = std::get<std::vector<uint8_t>>(impl_->owned.emplace_back(std::move(keep)));
  impl_->Put(name, StoredAs(type, precision), nullptr, static_cast<size_t>(CountStored(bits, total / group) * group), {});
  Array& kept = impl_->arrays.at(name);
  kept.copied_from = file;
  kept.copied_array = array;
  kept.keep = bits;
  kept.group = group;
  Put(KeepBitsName(name), bits);
  PutOwned(KeepSizesName(name), std::vector<int64_t>{group, total});
}
void ArchiveWriter::SetAttribute(const std::string& name, const std::string& value) {
  impl_->SetAttribute(name, value);
}
void ArchiveWriter::SetAttribute(const std::string& name, double value) {
  impl_->SetAttribute(name, value);
}
void ArchiveWriter::SetAttribute(const std::string& name, int64_t value) {
  impl_->SetAttribute(name, value);
}

void ArchiveWriter::Commit(const std::filesystem::path& file) const {
  RemoveAbandoned(file);
  const RemoveOnExit temporary{TemporaryOf(file)};
  impl_->Write(temporary.file);
  WriteUserBlock(temporary.file, UserBlockText(impl_->kind, impl_->version, MeasureFile(temporary.file)));
  base::SyncPath(temporary.file);
  impl_->Verify(temporary.file);
  ReplaceKeepingPrevious(temporary.file, file);
}

}  // namespace skyquilt::checkpoint
