// grouping/groups_file: vertex groups as a file, conventionally *.sheaf.
//   Form   sealed_file.h with kGroupsFileMagic, then the groups. Written once per vertex: the position of a retained
//          one, the parameters of a grouped one; everything else follows from these
//   Keeps  loading what was saved gives an equal value, if the parameters are not quantised
//   Trust  none: a file with any byte changed is refused by its checksum; one with a right checksum is checked field by
//          field and as a whole (findInconsistency) before it is returned: frames are orthonormal, members somewhere.
//          Whether it belongs to a mesh say the checksum of the mesh and the vertices that are in no group
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "grouping/vertex_groups.h"
#include "mesh/mesh.h"

namespace sheaf::grouping {

inline constexpr std::string_view kGroupsFileMagic = "SHEAFGRP";
inline constexpr std::uint32_t kGroupsFileVersion = 2;

struct GroupsFileOptions {
  /// 0 keeps s and t exactly; 1 to 24 quantises them to that many bits over the range of their group, which moves a
  /// grouped vertex by up to range / (2^bits - 1) / 2 along each axis.
  int parameter_bits = 0;
};

/// CRC-32 of the places of the vertices and of the triangles: what saved groups know their mesh by.
std::uint32_t meshChecksum(const mesh::Mesh& mesh);

/// The checksum of the mesh is that of the groups.
std::string encodeGroups(const VertexGroups& groups, const GroupsFileOptions& options = {});

/// name  for the message of the Error(kBadInput) that refuses damaged bytes; Error(kUnsupported) for another version
VertexGroups decodeGroups(std::string_view bytes, std::string_view name);

/// Throws Error(kBadInput) if the file cannot be written.
void saveGroups(const std::filesystem::path& path, const VertexGroups& groups, const GroupsFileOptions& options = {});
/// Throws as readFile() and decodeGroups() do.
VertexGroups loadGroups(const std::filesystem::path& path);
/// The same; Error(kBadInput) if they are not of this mesh.
VertexGroups loadGroups(const std::filesystem::path& path, const mesh::Mesh& mesh);

}  // namespace sheaf::grouping
