# Sourced by the scripts beside it: goes to the project's root, and what they share.
# shellcheck shell=bash
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit

# configure BUILD_FOLDER [CMAKE_ARGUMENT...]: with ccache where it is installed
configure() {
  local folder=$1
  shift
  if command -v ccache >/dev/null; then set -- -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"; fi
  cmake -S . -B "$folder" -G Ninja "$@"
}

# usage_unless_empty TEXT ARGUMENT...: for scripts that take no arguments
usage_unless_empty() {
  local text=$1
  shift
  if [[ $# -gt 0 ]]; then
    echo "$text"
    [[ $1 == --help ]] && exit 0 || exit 2
  fi
}
