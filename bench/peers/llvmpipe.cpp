// bench/peers/llvmpipe: draws a peer scene with Mesa's software rasterizer llvmpipe, off screen, and says how long it
// takes. Same work as sheaf's plain material: vertex transform, back faces culled, float-precise depth, normal made
// unit per pixel, directional Lambert lights and a hemisphere, sRGB-coded RGBA8.
//
//   peer_llvmpipe SCENE FRAMES THREADS PICTURE.png
//
// THREADS are llvmpipe's rasterizer threads; the program's own thread, which transforms the vertices, comes on top.
// Prints one line of JSON: median, minimum and maximum milliseconds a frame (draw to glFinish), the median with
// glReadPixels, and what GL calls itself.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "bench/peers/peer_scene.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace peers {
namespace {

constexpr int kWarmUpFrames = 3;

void require(bool ok, const std::string& what) {
  if (!ok) throw std::runtime_error(what);
}

void makeContextCurrent() {
  const auto get_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  require(get_display != nullptr, "EGL_EXT_platform_base is missing");
  const EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  require(eglInitialize(display, nullptr, nullptr), "eglInitialize failed");
  require(eglBindAPI(EGL_OPENGL_ES_API), "eglBindAPI failed");
  const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE,
                                      EGL_NONE};
  EGLConfig config = nullptr;
  EGLint config_count = 0;
  require(eglChooseConfig(display, config_attributes, &config, 1, &config_count) && config_count == 1,
          "no EGL configuration for OpenGL ES 3");
  const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
  require(context != EGL_NO_CONTEXT, "no OpenGL ES 3 context");
  require(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context), "eglMakeCurrent failed");
}

GLuint compile(GLenum kind, const char* text) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  char log[1024] = "";
  if (!ok) glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  require(ok, std::string("shader: ") + log);
  return shader;
}

constexpr char kVertexShader[] = R"(#version 300 es
uniform mat4 clip_from_object;
uniform mat3 world_from_object_normal;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out highp vec3 normal_world;
void main() {
  vec4 p = clip_from_object * vec4(position, 1.0);
  gl_Position = vec4(p.xy, p.w - 2.0 * p.z, p.w);  // z in [0, w], w nearest, to GL's [-w, w], -w nearest
  normal_world = world_from_object_normal * normal;
}
)";

// The sRGB code is made by the framebuffer; pow() here instead made no difference to the time that could be told from
// the noise.
constexpr char kFragmentShader[] = R"(#version 300 es
precision highp float;
uniform vec3 base_color;
uniform vec3 to_light_world[2];
uniform vec3 radiance[2];
uniform vec3 ambient_sky;
uniform vec3 ambient_ground;
in highp vec3 normal_world;
layout(location = 0) out vec4 color;
void main() {
  vec3 n = normalize(normal_world);
  vec3 light = mix(ambient_ground, ambient_sky, 0.5 + 0.5 * n.y);
  light += radiance[0] * max(dot(n, to_light_world[0]), 0.0);
  light += radiance[1] * max(dot(n, to_light_world[1]), 0.0);
  color = vec4(base_color * light, 1.0);
}
)";

GLuint linkProgram() {
  const GLuint program = glCreateProgram();
  glAttachShader(program, compile(GL_VERTEX_SHADER, kVertexShader));
  glAttachShader(program, compile(GL_FRAGMENT_SHADER, kFragmentShader));
  glLinkProgram(program);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  require(ok, "the shaders do not link");
  return program;
}

void makeTarget(const PeerFrame& frame) {
  const auto width = static_cast<GLsizei>(frame.width);
  const auto height = static_cast<GLsizei>(frame.height);
  GLuint buffers[2];
  glGenRenderbuffers(2, buffers);
  GLuint target = 0;
  glGenFramebuffers(1, &target);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_SRGB8_ALPHA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);
  require(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE, "the framebuffer is not complete");
  glViewport(0, 0, width, height);
}

GLuint upload(GLenum kind, const void* bytes, std::size_t size) {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(kind, buffer);
  glBufferData(kind, static_cast<GLsizeiptr>(size), bytes, GL_STATIC_DRAW);
  return buffer;
}

class Drawer {
 public:
  explicit Drawer(const PeerScene& scene) : scene_(scene), program_(linkProgram()) {
    makeTarget(scene.frame);
    for (const PeerDraw& draw : scene.draws) {
      GLuint array = 0;
      glGenVertexArrays(1, &array);
      glBindVertexArray(array);
      const std::vector<float>* attributes[] = {&draw.positions, &draw.normals};
      for (GLuint location = 0; location < 2; ++location) {
        upload(GL_ARRAY_BUFFER, attributes[location]->data(), attributes[location]->size() * sizeof(float));
        glVertexAttribPointer(location, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
        glEnableVertexAttribArray(location);
      }
      upload(GL_ELEMENT_ARRAY_BUFFER, draw.indices.data(), draw.indices.size() * sizeof(std::uint32_t));
      arrays_.push_back(array);
    }
    glUseProgram(program_);
    setFrameUniforms();
    clip_from_object_ = glGetUniformLocation(program_, "clip_from_object");
    world_from_object_normal_ = glGetUniformLocation(program_, "world_from_object_normal");
    base_color_ = glGetUniformLocation(program_, "base_color");
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    const auto& background = scene.frame.background;
    glClearColor(background[0], background[1], background[2], 1.0F);
  }

  void draw() const {
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      const PeerMesh& mesh = scene_.draws[i].mesh;
      glBindVertexArray(arrays_[i]);
      glUniformMatrix4fv(clip_from_object_, 1, GL_FALSE, mesh.clip_from_object.data());
      glUniformMatrix3fv(world_from_object_normal_, 1, GL_FALSE, mesh.world_from_object_normal.data());
      glUniform3fv(base_color_, 1, mesh.base_color.data());
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangle_count), GL_UNSIGNED_INT, nullptr);
    }
    glFinish();
  }

 private:
  void setFrameUniforms() const {
    const PeerFrame& frame = scene_.frame;
    std::array<float, 6> to_light{};  // a light that is not there stays black
    std::array<float, 6> radiance{};
    for (std::uint32_t i = 0; i < frame.light_count; ++i) {
      std::copy_n(frame.lights[i].to_light_world.data(), 3, &to_light[3 * i]);
      std::copy_n(frame.lights[i].radiance.data(), 3, &radiance[3 * i]);
    }
    glUniform3fv(glGetUniformLocation(program_, "to_light_world"), 2, to_light.data());
    glUniform3fv(glGetUniformLocation(program_, "radiance"), 2, radiance.data());
    glUniform3fv(glGetUniformLocation(program_, "ambient_sky"), 1, frame.ambient_sky.data());
    glUniform3fv(glGetUniformLocation(program_, "ambient_ground"), 1, frame.ambient_ground.data());
  }

  const PeerScene& scene_;
  GLuint program_;
  std::vector<GLuint> arrays_;
  GLint clip_from_object_ = -1;
  GLint world_from_object_normal_ = -1;
  GLint base_color_ = -1;
};

double nowMs() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

int run(const char* scene_path, int frames, const char* threads, const char* picture_path) {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  setenv("GALLIUM_DRIVER", "llvmpipe", 1);
  setenv("LP_NUM_THREADS", threads, 1);
  const PeerScene scene = readPeerScene(scene_path);
  require(scene.frame.light_count <= scene.frame.lights.size(), "too many lights");
  makeContextCurrent();
  const Drawer drawer(scene);
  const auto width = static_cast<int>(scene.frame.width);
  const auto height = static_cast<int>(scene.frame.height);
  std::vector<unsigned char> pixels(std::size_t{4} * scene.frame.width * scene.frame.height);

  std::vector<double> draw_ms;
  std::vector<double> read_ms;
  for (int i = 0; i < kWarmUpFrames + frames; ++i) {
    const double start = nowMs();
    drawer.draw();
    const double drawn = nowMs();
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    const double read = nowMs();
    if (i < kWarmUpFrames) continue;
    draw_ms.push_back(drawn - start);
    read_ms.push_back(read - start);
  }
  require(glGetError() == GL_NO_ERROR, "OpenGL reports an error");

  stbi_flip_vertically_on_write(1);
  require(stbi_write_png(picture_path, width, height, 4, pixels.data(), 4 * width) != 0,
          std::string(picture_path) + ": cannot be written");
  std::printf(
      "{\"median_ms\": %.3f, \"min_ms\": %.3f, \"max_ms\": %.3f, \"with_readback_ms\": %.3f, \"renderer\": \"%s\"}\n",
      median(draw_ms), *std::min_element(draw_ms.begin(), draw_ms.end()),
      *std::max_element(draw_ms.begin(), draw_ms.end()), median(read_ms),
      reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  return 0;
}

}  // namespace
}  // namespace peers

int main(int argc, char** argv) {
  const int frames = argc == 5 ? std::atoi(argv[2]) : 0;
  if (frames < 1) {
    std::fprintf(stderr, "usage: peer_llvmpipe SCENE FRAMES THREADS PICTURE.png\n");
    return 2;
  }
  try {
    return peers::run(argv[1], frames, argv[3], argv[4]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "peer_llvmpipe: %s\n", error.what());
    return 1;
  }
}
