// scenes/gltf_data: the numbers of glTF accessors, with every range checked. Internal to the importer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/gltf_document.h"

namespace sheaf::scenes {

/// The number of elements of an accessor. Throws Error if there is no such accessor.
std::size_t accessorCount(const GltfDocument& document, int accessor);

/// Elements of `components` numbers each, interleaved: normalised integers in [0, 1] or [-1, 1], others as they are.
/// components        1 to 4
/// least_components  an element may have fewer numbers than `components`, but not fewer than this; 1 stands for those
///                   that it lacks
/// selection         which elements, ascending; empty = all
/// Throws Error for what does not fit: type, range, sparse indices.
std::vector<float> readAccessor(GltfDocument& document, int accessor, int components, int least_components,
                                std::span<const std::uint32_t> selection);

/// The whole accessor as indices: scalars of unsigned bytes, shorts or ints.
std::vector<std::uint32_t> readIndices(GltfDocument& document, int accessor);

}  // namespace sheaf::scenes
