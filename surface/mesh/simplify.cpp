#include "surface/mesh/simplify.h"

#include "surface/mesh/edge_collapse.h"
#include "surface/mesh/mesh_tools.h"

namespace skyquilt::surface {

Mesh Simplify(const Mesh& mesh, double max_error_m, double* error_m) {
  if (error_m != nullptr) *error_m = 0.0;
  if (!(max_error_m > 0.0)) return Compacted(mesh, mesh.triangle);
  EdgeCollapse collapse(mesh);
  const double error = collapse.Run(max_error_m);
  if (error_m != nullptr) *error_m = error;
  return Compacted(mesh, collapse.Triangles());
}

}  // namespace skyquilt::surface
