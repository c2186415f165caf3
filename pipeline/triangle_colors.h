// pipeline/triangle_colors: pictures whose colours say which part of a surface a triangle belongs to: a face cluster, a
// vertex group, a patch.
//   Method The scene is drawn white (whitenSurfaces), with ids. Then every pixel takes the colour of the triangle that
//          is seen there (colorPixels). So colours end exactly where triangles do, light and shade stay, and what was
//          drawn is what would have been drawn without them: no vertex is there twice.
//   Keeps  neighbours in different colours, as grouping::colorParts() does, also where one mesh ends and another begins
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/task_pool.h"
#include "mesh/mesh.h"
#include "pipeline/prepare.h"
#include "pipeline/renderer.h"
#include "scenes/scene.h"

namespace sheaf::pipeline {

/// Of a triangle that is in no part: it stays white.
inline constexpr std::uint8_t kUncolored = 0xFF;

/// By instance, then by triangle of its mesh: a scenes::partColor(), or kUncolored. Instances beyond the last keep
/// their own colours.
using TriangleColors = std::vector<std::vector<std::uint8_t>>;

/// The surfaces of all instances as one (mesh::surfaceOf() of scenes::joinedMesh()): who is whose neighbour.
struct SceneSurface {
  mesh::Mesh joined;
  std::vector<std::size_t> face_count;  ///< by instance
};

/// Takes what colours surfaces: materials become white and lit, textures and vertex colours go. Flat ones stay flat.
void whitenSurfaces(scenes::Scene& scene);

/// By instance.
std::vector<std::size_t> faceCountsOf(const scenes::Scene& scene);

/// To be had before prepareScene() takes the meshes. Joins every instance: a mesh that is there a thousand times costs
/// the time and memory of a thousand meshes. Throws Error(kUnsupported) as scenes::joinedMesh() does.
SceneSurface surfaceOf(const scenes::Scene& scene);

/// Of parts of scenes::joinedMesh(scene), such as face clusters.
/// part_of_face   per triangle of all instances, one instance after the other; grouping::kNoIndex: in none
/// color_of_part  #P, below scenes::kPartColors
/// face_count     by instance
TriangleColors colorsByPart(std::span<const std::uint32_t> part_of_face, std::span<const std::uint32_t> color_of_part,
                            std::span<const std::size_t> face_count);

/// #F, the group that at least two corners of a triangle are in, kNoIndex if there is none.
std::vector<std::uint32_t> groupOfFace(const grouping::VertexGroups& groups, std::span<const mesh::Triangle> triangles);

/// Each instance has patches of its own.
/// surface  of the scene that `scene` was prepared from
TriangleColors colorsByPatch(const PreparedScene& scene, const SceneSurface& surface);

/// A triangle belongs to the plane or line that at least two of its corners are drawn by. Others, and all of a scene
/// that was prepared without groups, are in none. Each instance has groups of its own.
TriangleColors colorsByGroup(const PreparedScene& scene, const SceneSurface& surface);

/// frame  drawn with want_linear and want_ids; color is brought up to date if it is there
void colorPixels(const TriangleColors& colors, Frame& frame, TaskPool& pool);

}  // namespace sheaf::pipeline
