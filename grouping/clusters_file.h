// grouping/clusters_file: a hierarchy of face clusters as a file, conventionally *.sheaf.
//   Form   sealed_file.h with magic "SHEAFCLU". Numbers of faces and merges; for each node 2 * its merge + its side
//          there, 2^32 - 1 of a root; the merges' costs; a bit for each merge that has a shape; the shapes
//   Keeps  loading what was saved gives an equal value. Which mesh it belongs to is not in it: faces are numbers
//   Trust  none: a file with any byte changed is refused by its checksum, and one with a right checksum is checked
//          field by field before it is returned
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "grouping/face_clusters.h"

namespace sheaf::grouping {

inline constexpr std::uint32_t kClustersFileVersion = 1;

/// Asserts that every merge has a shape number, as clusterFaces() gives it.
std::string encodeClusters(const FaceClusters& clusters);

/// name  for the message of the Error(kBadInput) that refuses damaged bytes; Error(kUnsupported) for another version
FaceClusters decodeClusters(std::string_view bytes, std::string_view name);

/// Throws Error(kBadInput) if the file cannot be written.
void saveClusters(const std::filesystem::path& path, const FaceClusters& clusters);
/// Throws as readFile() and decodeClusters() do.
FaceClusters loadClusters(const std::filesystem::path& path);

}  // namespace sheaf::grouping
