#include "core/checkpoint/guarded_driver.h"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>

#include "core/base/errors.h"

namespace skyquilt::checkpoint {
namespace {

// The driver's data in the access property list; HDF5 copies it as bytes.
struct DriverInfo {
  WriteOutcome* outcome = nullptr;
};

struct GuardedFile {
  H5FD_t base{};  // must be first: HDF5 has a pointer to it
  WriteOutcome* outcome = nullptr;
  int descriptor = -1;
  haddr_t end_of_allocation = 0;
};
static_assert(std::is_standard_layout_v<GuardedFile> && offsetof(GuardedFile, base) == 0);

GuardedFile* Ours(H5FD_t* file) {
  return reinterpret_cast<GuardedFile*>(file);
}
const GuardedFile* Ours(const H5FD_t* file) {
  return reinterpret_cast<const GuardedFile*>(file);
}

void Remember(WriteOutcome* outcome, int error) {
  if (outcome->error == 0) outcome->error = error != 0 ? error : EIO;
}

H5FD_t* Open(const char* name, unsigned flags, hid_t access, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  auto file = std::unique_ptr<GuardedFile>(new (std::nothrow) GuardedFile);
  if (!file) return nullptr;
  file->outcome = info->outcome;
  file->descriptor = open(name, mode | O_CLOEXEC, 0666);
  if (file->descriptor < 0) {
    // HDF5 first tests whether the file exists; only a failure to create it is an error.
    if ((flags & H5F_ACC_CREAT) != 0) Remember(file->outcome, errno);
    return nullptr;
  }
  return &file.release()->base;
}

herr_t Close(H5FD_t* base) {
  const std::unique_ptr<GuardedFile> file(Ours(base));
  if (close(file->descriptor) != 0) Remember(file->outcome, errno);
  return 0;
}

herr_t Query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA |
             H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  }
  return 0;
}

haddr_t EndOfAllocation(const H5FD_t* base, H5FD_mem_t) {
  return Ours(base)->end_of_allocation;
}

herr_t SetEndOfAllocation(H5FD_t* base, H5FD_mem_t, haddr_t address) {
  Ours(base)->end_of_allocation = address;
  return 0;
}

haddr_t EndOfFile(const H5FD_t* base, H5FD_mem_t) {
  const off_t end = lseek(Ours(base)->descriptor, 0, SEEK_END);
  const haddr_t present = end > 0 ? static_cast<haddr_t>(end) : 0;
  // After an error, report the length that HDF5 expects.
  return Ours(base)->outcome->error == 0 ? present : std::max(present, Ours(base)->end_of_allocation);
}

herr_t Read(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, size_t n_bytes, void* buffer) {
  auto* out = static_cast<char*>(buffer);
  while (n_bytes > 0) {
    const ssize_t n = pread(Ours(base)->descriptor, out, n_bytes, static_cast<off_t>(address));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return -1;
    if (n == 0) {
      std::memset(out, 0, n_bytes);  // allocated, not yet written
      return 0;
    }
    out += n;
    address += static_cast<haddr_t>(n);
    n_bytes -= static_cast<size_t>(n);
  }
  return 0;
}

herr_t Write(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, size_t n_bytes, const void* buffer) {
  const auto* in = static_cast<const char*>(buffer);
  while (n_bytes > 0 && Ours(base)->outcome->error == 0) {
    const ssize_t n = pwrite(Ours(base)->descriptor, in, n_bytes, static_cast<off_t>(address));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      Remember(Ours(base)->outcome, n < 0 ? errno : ENOSPC);
      break;
    }
    in += n;
    address += static_cast<haddr_t>(n);
    n_bytes -= static_cast<size_t>(n);
  }
  return 0;
}

herr_t Truncate(H5FD_t* base, hid_t, hbool_t) {
  GuardedFile* file = Ours(base);
  if (file->outcome->error == 0 && ftruncate(file->descriptor, static_cast<off_t>(file->end_of_allocation)) != 0) Remember(file->outcome, errno);
  return 0;
}

H5FD_class_t DriverClass() {
  H5FD_class_t driver{};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  driver.value = 600;  // outside the range the HDF Group assigns
#endif
  driver.name = "skyquilt_guarded";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = Open;
  driver.close = Close;
  driver.query = Query;
  driver.get_eoa = EndOfAllocation;
  driver.set_eoa = SetEndOfAllocation;
  driver.get_eof = EndOfFile;
  driver.read = Read;
  driver.write = Write;
  driver.truncate = Truncate;
  const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(map), std::end(map), driver.fl_map);
  return driver;
}

}  // namespace

void UseGuardedDriver(const Handle& file_access, WriteOutcome* outcome) {
  static const H5FD_class_t driver_class = DriverClass();
  static const hid_t driver = H5FDregister(&driver_class);
  const DriverInfo info{outcome};
  SKYQUILT_CHECK(driver >= 0 && H5Pset_driver(file_access.id(), driver, &info) >= 0, HdfErrorText());
}

}  // namespace skyquilt::checkpoint
