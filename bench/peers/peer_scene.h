// bench/peers/peer_scene: the scene that both renderers are given, and the file that takes it from one to the other.
// Knows nothing of sheaf, so that the other renderer's program needs nothing of it.
//
// File: the line "sheaf-peer-scene 1\n", then PeerFrame, then for each mesh PeerMesh and its arrays: positions (3
// floats a vertex), normals (3 floats a vertex), indices (3 uint32 a triangle). Native byte order: it does not leave
// the machine.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace peers {

inline constexpr char kMagic[] = "sheaf-peer-scene 1\n";

struct PeerLight {
  std::array<float, 3> to_light_world;  // unit
  std::array<float, 3> radiance;        // linear
};

/// What all meshes of a picture share.
struct PeerFrame {
  std::uint32_t width = 1920;
  std::uint32_t height = 1080;
  std::uint32_t mesh_count = 0;
  std::uint32_t light_count = 0;  // at most 2
  std::array<PeerLight, 2> lights{};
  std::array<float, 3> ambient_sky{};     // linear, from +Y
  std::array<float, 3> ambient_ground{};  // linear, from -Y
  std::array<float, 3> background{};      // linear
};

/// One draw: an indexed mesh, counter-clockwise triangles seen from the front, back faces culled.
struct PeerMesh {
  std::array<float, 16> clip_from_object{};         // column-major; 0 <= z <= w, z = w at the near plane
  std::array<float, 9> world_from_object_normal{};  // column-major
  std::array<float, 3> base_color{};                // linear
  std::uint32_t vertex_count = 0;
  std::uint32_t triangle_count = 0;
};

struct PeerDraw {
  PeerMesh mesh;
  std::vector<float> positions;        // 3 a vertex
  std::vector<float> normals;          // 3 a vertex
  std::vector<std::uint32_t> indices;  // 3 a triangle
};

struct PeerScene {
  PeerFrame frame;
  std::vector<PeerDraw> draws;
};

static_assert(std::is_trivially_copyable_v<PeerFrame> && std::is_trivially_copyable_v<PeerMesh>);

template <typename T>
void writeArray(std::ostream& out, const T* values, std::size_t count) {
  out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}

template <typename T>
void readArray(std::istream& in, T* values, std::size_t count) {
  in.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}

/// Throws std::runtime_error if the file cannot be written.
inline void writePeerScene(const PeerScene& scene, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  writeArray(out, kMagic, sizeof kMagic - 1);
  writeArray(out, &scene.frame, 1);
  for (const PeerDraw& draw : scene.draws) {
    writeArray(out, &draw.mesh, 1);
    writeArray(out, draw.positions.data(), draw.positions.size());
    writeArray(out, draw.normals.data(), draw.normals.size());
    writeArray(out, draw.indices.data(), draw.indices.size());
  }
  if (!out.flush()) throw std::runtime_error(path + ": cannot be written");
}

/// Throws std::runtime_error if the file cannot be read or is of another kind.
inline PeerScene readPeerScene(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, sizeof kMagic - 1> magic{};
  readArray(in, magic.data(), magic.size());
  if (!in || std::memcmp(magic.data(), kMagic, magic.size()) != 0)
    throw std::runtime_error(path + ": is not a peer scene");
  PeerScene scene;
  readArray(in, &scene.frame, 1);
  for (std::uint32_t i = 0; in && i < scene.frame.mesh_count; ++i) {
    PeerDraw draw;
    readArray(in, &draw.mesh, 1);
    if (!in) break;
    draw.positions.resize(std::size_t{3} * draw.mesh.vertex_count);
    draw.normals.resize(draw.positions.size());
    draw.indices.resize(std::size_t{3} * draw.mesh.triangle_count);
    readArray(in, draw.positions.data(), draw.positions.size());
    readArray(in, draw.normals.data(), draw.normals.size());
    readArray(in, draw.indices.data(), draw.indices.size());
    scene.draws.push_back(std::move(draw));
  }
  if (!in) throw std::runtime_error(path + ": ends too early");
  return scene;
}

}  // namespace peers
