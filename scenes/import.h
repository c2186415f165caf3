// scenes/import: what the importers of the file formats share. Internal to scenes; callers use loadScene().
//   In     the unpacked bytes of a file and its name for messages
//   Out    a Scene whose indices are all in range and whose triangles are all finite
//   Keeps  no count from a file sizes an allocation before it was held against the bytes that are there
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.h"
#include "scenes/scene.h"

namespace sheaf::scenes {

struct ImportSource {
  std::filesystem::path path;
  std::string name;   ///< how messages call the file
  std::string bytes;  ///< unpacked
};

// Each takes the bytes over, so that they can be freed as soon as they are parsed. All throw Error. z_up is none of
// their business: loadScene() turns the result.
Scene importGltf(ImportSource source);
Scene importObj(ImportSource source, const ImportOptions& options);
Scene importPly(ImportSource source, const ImportOptions& options);
Scene importStl(ImportSource source, const ImportOptions& options);
Scene importOff(ImportSource source, const ImportOptions& options);

/// Throws Error(kBadInput) "name: reason" with control characters made harmless, so that it stays one line.
[[noreturn]] void refuse(std::string_view name, std::string_view reason);
[[noreturn]] void refuseUnsupported(std::string_view name, std::string_view reason);

/// Text from a file for a message: control characters become '?', long text is cut.
std::string printable(std::string_view text);

/// Drops triangles with corners that are not finite, and says so in scene.warnings as "place: ...".
void dropBadTriangles(mesh::Mesh& mesh, std::string_view place, Scene& scene);

/// Makes the given normals unit length. False if a used one has no direction: then they are all to be made anew.
bool normalizeNormals(mesh::Mesh& mesh);

/// A material for surfaces whose format says nothing about looks. Double-sided, since these formats do not say which
/// side of a triangle is meant to be seen, and scans are open.
Material plainMaterial(bool has_vertex_colors);

/// A Scene of one mesh that is drawn once: bad triangles dropped, normals made where they are missing and wanted.
/// Throws Error(kBadInput) if no triangle is left, or none was there and it is to be drawn.
Scene sceneOfOneMesh(mesh::Mesh mesh, Material material, std::string_view name, const ImportOptions& options,
                     std::vector<std::string> warnings);

/// sRGB-coded [0, 1] to linear (IEC 61966-2-1).
float linearFromSrgb(float coded);
float linearFromSrgb8(std::uint8_t coded);

}  // namespace sheaf::scenes
