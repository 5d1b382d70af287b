#include "buildings/fit/fit_parameters.h"

namespace skyquilt::buildings {

Parameters::Parameters(const Shape& shape) : lines_u_(static_cast<int>(shape.u.size())) {
  int next = 1 + static_cast<int>(shape.u.size() + shape.v.size());
  for (const Part& part : shape.parts) {
    eave_.push_back(next++);
    ridge_.push_back(IsPitched(part) ? next++ : eave_.back());
  }
  shape_size_ = next;
}

Eigen::VectorXd Parameters::Of(const Shape& shape) const {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(size());
  values[yaw()] = shape.yaw_rad;
  for (int i = 0; i < static_cast<int>(shape.u.size()); ++i) values[line(0, i)] = shape.u[static_cast<size_t>(i)];
  for (int i = 0; i < static_cast<int>(shape.v.size()); ++i) values[line(1, i)] = shape.v[static_cast<size_t>(i)];
  for (int p = 0; p < static_cast<int>(shape.parts.size()); ++p) {
    values[ridge(p)] = shape.parts[static_cast<size_t>(p)].ridge_z;
    values[eave(p)] = shape.parts[static_cast<size_t>(p)].eave_z;
  }
  return values;
}

void Parameters::Set(const Eigen::VectorXd& values, Shape* shape) const {
  shape->yaw_rad = values[yaw()];
  for (int i = 0; i < static_cast<int>(shape->u.size()); ++i) shape->u[static_cast<size_t>(i)] = values[line(0, i)];
  for (int i = 0; i < static_cast<int>(shape->v.size()); ++i) shape->v[static_cast<size_t>(i)] = values[line(1, i)];
  for (int p = 0; p < static_cast<int>(shape->parts.size()); ++p) {
    shape->parts[static_cast<size_t>(p)].eave_z = values[eave(p)];
    shape->parts[static_cast<size_t>(p)].ridge_z = values[ridge(p)];
  }
}

}  // namespace skyquilt::buildings
