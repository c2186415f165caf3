// cli/saved_file: files that sheaf itself has saved: what kind one is, and what `sheaf info` says about it.
#pragma once

#include <string>

namespace sheaf::cli {

enum class SavedKind { kVertexGroups, kFaceClusters };

/// By its name or its first bytes. False for a file that cannot be read, too, and for a pipe.
bool isSavedFile(const std::string& path);

/// By its first bytes. Throws Error(kBadInput) if it cannot be read, is of neither kind or is no regular file: bytes
/// that were read from a pipe would be missing when it is read for what it holds.
SavedKind savedKindOf(const std::string& path);

/// Throws Error(kUsage), which says how to use it, for a saved file given as the scene.
void refuseAsScene(const std::string& input);

/// Kind, version, size and content, as a table or as JSON. Throws Error: kBadInput if the file is not whole and sound,
/// kUnsupported for another version.
std::string savedFileText(const std::string& path);
std::string savedFileJson(const std::string& path);

}  // namespace sheaf::cli
