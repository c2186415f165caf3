// grouping/clusters_file: a hierarchy of face clusters as a file, conventionally *.sheaf.
//   Form   sealed_file.h with kClustersFileMagic. Numbers of faces and merges; CRC-32 of the places of the faces'
//          corners; for each node 2 * its merge + its side there, 2^32 - 1 of a root; the merges' costs; a bit for each
//          merge that has a shape; the shapes
//   Keeps  loading what was saved gives an equal value
//   Trust  none: a file with any byte changed is refused by its checksum, one with a right checksum is checked field by
//          field before it is returned, and so is whether it belongs to the mesh: as many faces with the same corners,
//          in the same order, however the vertices are numbered
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "grouping/face_clusters.h"

namespace sheaf::grouping {

inline constexpr std::string_view kClustersFileMagic = "SHEAFCLU";
inline constexpr std::uint32_t kClustersFileVersion = 2;

/// mesh  that the clusters were made of. Asserts that every merge has a shape number, as clusterFaces() gives it.
std::string encodeClusters(const FaceClusters& clusters, const mesh::Mesh& mesh);

/// name  for the message of the Error(kBadInput) that refuses damaged bytes and clusters of another mesh;
///       Error(kUnsupported) for another version
FaceClusters decodeClusters(std::string_view bytes, const mesh::Mesh& mesh, std::string_view name);
/// The same without the mesh, which is not asked whether it has these faces and whether boxes are where it is: to look
/// at the hierarchy, not to use it.
FaceClusters decodeClusters(std::string_view bytes, std::string_view name);

/// Throws Error(kBadInput) if the file cannot be written.
void saveClusters(const std::filesystem::path& path, const FaceClusters& clusters, const mesh::Mesh& mesh);
/// Throws as readFile() and decodeClusters() do.
FaceClusters loadClusters(const std::filesystem::path& path, const mesh::Mesh& mesh);

}  // namespace sheaf::grouping
