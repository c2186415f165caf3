// scenes/asset_folder: the files that a scene file refers to. A scene file comes from anywhere, so that it must not
// reach what lies outside its own folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scenes/scene.h"

namespace sheaf::scenes {

class AssetFolder {
 public:
  /// scene_file  whose folder it is
  explicit AssetFolder(const std::filesystem::path& scene_file);

  /// The bytes of a file at or below the folder. Throws Error(kBadInput) "reference: reason" for absolute paths, URIs
  /// with a scheme, paths that lead out of the folder (symbolic links followed), and what is no readable plain file.
  /// reference  a relative path; `\` and `/` both separate
  std::string read(std::string_view reference) const;

 private:
  std::filesystem::path folder_;
};

/// The bytes that %XX stand for; a % without two hexadecimal digits stays as it is.
std::string percentDecoded(std::string_view text);

/// Decodes PNG or JPEG. Throws Error(kBadInput) "name: reason". At most 16384 pixels a side.
Image8 decodeImage(std::string_view bytes, std::string_view name);

}  // namespace sheaf::scenes
