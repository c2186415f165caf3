#include "scenes/gltf_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace sheaf::scenes {
namespace {

// Accessors without a buffer view are zeros: nothing but this bounds them.
constexpr std::size_t kMostZeros = std::size_t{1} << 24;

struct Strided {
  ByteSpan bytes;  ///< from the first element on; empty = all zeros
  std::size_t stride = 0;
  const unsigned char* at(std::size_t element) const { return bytes.data() + element * stride; }
};

const tinygltf::Accessor& accessorAt(const GltfDocument& document, int accessor) {
  const auto& all = document.model().accessors;
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= all.size())
    document.fail(fmt::format("accessor {} does not exist, there are {}", accessor, all.size()));
  return all[static_cast<std::size_t>(accessor)];
}

std::size_t componentSize(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

// Little-endian in the file on every machine.
std::uint32_t loadUnsigned(const unsigned char* p, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = (value << 8) | p[i];
  return value;
}

float loadComponent(const unsigned char* p, int component_type, bool normalized) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const auto value = static_cast<float>(static_cast<std::int8_t>(*p));
      return normalized ? std::max(value / 127.0F, -1.0F) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return normalized ? static_cast<float>(*p) / 255.0F : *p;
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const auto value = static_cast<float>(static_cast<std::int16_t>(loadUnsigned(p, 2)));
      return normalized ? std::max(value / 32767.0F, -1.0F) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const auto value = static_cast<float>(loadUnsigned(p, 2));
      return normalized ? value / 65535.0F : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
      const double value = loadUnsigned(p, 4);
      return static_cast<float>(normalized ? value / 4294967295.0 : value);
    }
    default:
      return std::bit_cast<float>(loadUnsigned(p, 4));
  }
}

// The elements of a view: `count` of `element_size` bytes from `offset` on.
Strided stridedRange(GltfDocument& document, int view, std::uint64_t offset, std::uint64_t count,
                     std::size_t element_size, std::string_view what) {
  const ByteSpan bytes = document.view(view);
  const std::size_t given = document.model().bufferViews[static_cast<std::size_t>(view)].byteStride;
  const std::size_t stride = given == 0 ? element_size : given;
  const bool fits = offset <= bytes.size() && element_size <= bytes.size() - offset && stride >= element_size &&
                    (count == 0 || count - 1 <= (bytes.size() - offset - element_size) / stride);
  if (count > 0 && !fits)
    document.fail(
        fmt::format("{}: {} elements of {} bytes from byte {} on, stride {}, reach past the {} bytes of buffer view {}",
                    what, count, element_size, offset, stride, bytes.size(), view));
  if (count == 0) return {};
  return {bytes.subspan(static_cast<std::size_t>(offset)), stride};
}

struct Layout {
  const tinygltf::Accessor& accessor;
  std::string what;
  std::size_t component_size;
  int components;
  std::size_t elementSize() const { return component_size * static_cast<std::size_t>(components); }
};

Layout layoutOf(const GltfDocument& document, int accessor) {
  const tinygltf::Accessor& a = accessorAt(document, accessor);
  const std::string what = fmt::format("accessor {}", accessor);
  const std::size_t size = componentSize(a.componentType);
  if (size == 0) document.fail(fmt::format("{}: unknown component type {}", what, a.componentType));
  const bool vector = a.type >= TINYGLTF_TYPE_VEC2 && a.type <= TINYGLTF_TYPE_VEC4;
  if (!vector && a.type != TINYGLTF_TYPE_SCALAR) document.fail(fmt::format("{}: neither scalar nor vector", what));
  if (a.count > UINT32_MAX - 1) document.fail(fmt::format("{}: {} elements are too many", what, a.count));
  return {a, what, size, vector ? a.type : 1};
}

Strided denseRange(GltfDocument& document, const Layout& layout) {
  const tinygltf::Accessor& a = layout.accessor;
  if (a.bufferView >= 0)
    return stridedRange(document, a.bufferView, a.byteOffset, a.count, layout.elementSize(), layout.what);
  if (a.count > kMostZeros)
    document.fail(fmt::format("{}: {} elements without a buffer view are too many", layout.what, a.count));
  return {};
}

// Calls use(element number, its bytes) for each sparse element.
template <typename Use>
void forEachSparse(GltfDocument& document, const Layout& layout, Use use) {
  const auto& sparse = layout.accessor.sparse;
  if (!sparse.isSparse) return;
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    document.fail(fmt::format("{}: negative numbers in its sparse part", layout.what));
  const auto count = static_cast<std::uint64_t>(sparse.count);
  const int type = sparse.indices.componentType;
  const bool unsigned_type = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (!unsigned_type) document.fail(fmt::format("{}: sparse indices of component type {}", layout.what, type));
  const Strided indices =
      stridedRange(document, sparse.indices.bufferView, static_cast<std::uint64_t>(sparse.indices.byteOffset), count,
                   componentSize(type), layout.what);
  const Strided values =
      stridedRange(document, sparse.values.bufferView, static_cast<std::uint64_t>(sparse.values.byteOffset), count,
                   layout.elementSize(), layout.what);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t element = loadUnsigned(indices.at(i), componentSize(type));
    if (element >= layout.accessor.count)
      document.fail(fmt::format("{}: sparse index {} of {} elements", layout.what, element, layout.accessor.count));
    use(element, values.at(i));
  }
}

}  // namespace

std::size_t accessorCount(const GltfDocument& document, int accessor) {
  return accessorAt(document, accessor).count;
}

std::vector<float> readAccessor(GltfDocument& document, int accessor, int components, int least_components,
                                std::span<const std::uint32_t> selection) {
  const Layout layout = layoutOf(document, accessor);
  if (layout.components > components || layout.components < least_components)
    document.fail(fmt::format("{}: {} components where {} are expected", layout.what, layout.components, components));
  const Strided dense = denseRange(document, layout);
  const std::size_t count = selection.empty() ? layout.accessor.count : selection.size();
  const auto width = static_cast<std::size_t>(components);
  const auto stored = static_cast<std::size_t>(layout.components);
  // What an element does not have is 1 (alpha).
  std::vector<float> out(count * width, stored < width ? 1.0F : 0.0F);
  const auto store = [&](std::size_t to, const unsigned char* from) {
    for (std::size_t c = 0; c < stored; ++c)
      out[to * width + c] =
          loadComponent(from + c * layout.component_size, layout.accessor.componentType, layout.accessor.normalized);
  };
  if (dense.bytes.empty()) {
    for (std::size_t i = 0; i < count; ++i)
      std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(i * width), stored, 0.0F);
  } else {
    for (std::size_t i = 0; i < count; ++i) store(i, dense.at(selection.empty() ? i : selection[i]));
  }
  forEachSparse(document, layout, [&](std::uint32_t element, const unsigned char* from) {
    if (selection.empty()) return store(element, from);
    const auto it = std::lower_bound(selection.begin(), selection.end(), element);
    if (it != selection.end() && *it == element) store(static_cast<std::size_t>(it - selection.begin()), from);
  });
  return out;
}

std::vector<std::uint32_t> readIndices(GltfDocument& document, int accessor) {
  const Layout layout = layoutOf(document, accessor);
  const int type = layout.accessor.componentType;
  const bool unsigned_type = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (!unsigned_type || layout.components != 1) document.fail(fmt::format("{}: not a type for indices", layout.what));
  const Strided dense = denseRange(document, layout);
  std::vector<std::uint32_t> out(layout.accessor.count, 0);
  if (!dense.bytes.empty())
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = loadUnsigned(dense.at(i), layout.component_size);
  forEachSparse(document, layout, [&](std::uint32_t element, const unsigned char* from) {
    out[element] = loadUnsigned(from, layout.component_size);
  });
  return out;
}

}  // namespace sheaf::scenes
