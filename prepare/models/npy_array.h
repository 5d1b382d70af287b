// Reads an array that NumPy saved (.npy), the little of the format that data sets need: two dimensions of floating point.
// Source: NumPy's description of the format, versions 1.0 to 3.0 (numpy.org/doc/stable/reference/generated/numpy.lib.format.html): the bytes
// "\x93NUMPY", major and minor version, the length of the header (2 bytes, from version 2 on 4; little-endian), the header, a Python dictionary with
// descr, fortran_order and shape, and then the numbers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::prepare::models {

struct NpyArray {
  size_t rows = 0, columns = 0;
  std::vector<double> values;  // row after row, all finite

  double At(size_t row, size_t column) const { return values[row * columns + column]; }
};

// Throws base::InputError that says what was found: not an .npy, an end before or after that of the array, numbers that are not little-endian floats
// of 4 or 8 bytes, columns that lie one after the other (fortran_order), another number of dimensions, NaN or infinity. `fix`: how to get a good
// file.
NpyArray ReadNpyArray(const std::filesystem::path& file, const std::string& fix);

}  // namespace skyquilt::prepare::models
