// core/error: the one exception for bad input from outside. A caller's bug is an assert; an honest shortfall is a field
// of the result.
#pragma once

#include <stdexcept>
#include <string>

namespace sheaf {

/// What kind of refusal this is; the values are the exit codes of the command.
enum class ErrorCode {
  kUsage = 2,        ///< wrong options or arguments
  kBadInput = 3,     ///< a file that cannot be read, understood or written
  kUnsupported = 4,  ///< a valid file that asks for something sheaf does not do
  kInternal = 70,    ///< a bug of ours
};

/// One line of text: the file, the place in it, the reason. Example: `cube.obj:14: face refers to vertex 9, the mesh
/// has 8`.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace sheaf
