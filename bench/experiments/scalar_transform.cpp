// scalar_transform FILE.sheaf none|grouped FORM: transforms the vertices of a groups file once, by scalar_kernels.h,
// for callgrind to count. FORM is a number, see ScalarForm.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <vector>

#include "bench/experiments/scalar_mesh.h"
#include "grouping/groups_file.h"

/// What callgrind is told to count: --toggle-collect=countedTransform.
extern "C" [[gnu::noinline]] void countedTransform(sheaf::experiments::ScalarTransform transform,
                                                   const sheaf::experiments::ScalarMesh& mesh, const float* matrix,
                                                   float* out) {
  transform(mesh, matrix, out);
}

int main(int argc, char** argv) {
  using namespace sheaf;
  using namespace sheaf::experiments;
  if (argc != 4) {
    std::fprintf(stderr, "usage: scalar_transform FILE.sheaf none|grouped FORM\n");
    return 2;
  }
  try {
    const grouping::VertexGroups groups = grouping::loadGroups(argv[1]);
    const ScalarArrays arrays = std::strcmp(argv[2], "none") == 0 ? ungroupedArrays(groups) : groupedArrays(groups);
    const int form = std::atoi(argv[3]) % kScalarForms;
    const Mat4 matrix = scalarMatrix(static_cast<ScalarForm>(form));
    std::vector<float> out(4 * arrays.vertexCount());
    countedTransform(sse2::kTransforms[form], arrays.view(), &matrix[0][0], out.data());
    std::printf("%g\n", static_cast<double>(out[0]));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "scalar_transform: %s\n", e.what());
    return 1;
  }
}
