// grouping/groups_file: vertex groups as a file, conventionally *.sheaf.
//   Form   magic "SHEAFGRP", version, size, CRC-32 of all other bytes, then the groups; little-endian. Written once per
//          vertex: the position of a retained one, the parameters of a grouped one; everything else follows from these
//   Keeps  loading what was saved gives an equal value, if the parameters are not quantised
//   Trust  none: a file with any byte changed is refused by its checksum; one with a right checksum is checked field by
//          field and as a whole (findInconsistency) before it is returned
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "grouping/vertex_groups.h"

namespace sheaf::grouping {

inline constexpr std::uint32_t kGroupsFileVersion = 1;

struct GroupsFileOptions {
  /// 0 keeps s and t exactly; 1 to 24 quantises them to that many bits over the range of their group, which moves a
  /// grouped vertex by up to range / (2^bits - 1) / 2 along each axis.
  int parameter_bits = 0;
};

std::string encodeGroups(const VertexGroups& groups, const GroupsFileOptions& options = {});

/// name  for the message of the Error(kBadInput) that refuses damaged bytes; Error(kUnsupported) for another version
VertexGroups decodeGroups(std::string_view bytes, std::string_view name);

/// Throws Error(kBadInput) if the file cannot be written.
void saveGroups(const std::filesystem::path& path, const VertexGroups& groups, const GroupsFileOptions& options = {});
/// Throws as readFile() and decodeGroups() do.
VertexGroups loadGroups(const std::filesystem::path& path);

}  // namespace sheaf::grouping
