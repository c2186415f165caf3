// tests/pipeline/random_view: cameras and placed instances of every kind.
#pragma once

#include <random>

#include "pipeline/cull.h"

namespace sheaf::pipeline {

struct RandomView {
  View view;
  scenes::Instance instance;
};

// A random perspective or parallel view of a randomly placed, sometimes mirrored instance.
inline RandomView randomView(std::mt19937& rng) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  DMat4 world_from_object(1.0);
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) world_from_object[c][r] = unit(rng) + (c == r ? 1.0 : 0.0);
  const DVec3 eye(3.0 * unit(rng), 3.0 * unit(rng), 3.0 * unit(rng));
  const DVec3 forward = glm::normalize(DVec3(unit(rng), unit(rng), unit(rng)));
  const DVec3 right = glm::normalize(glm::cross(forward, DVec3(0.0, 1.0, 0.001)));
  const DVec3 up = glm::cross(right, forward);
  DMat4 view_from_world(1.0);
  for (int c = 0; c < 3; ++c) {
    view_from_world[c][0] = right[c];
    view_from_world[c][1] = up[c];
    view_from_world[c][2] = -forward[c];
  }
  view_from_world[3] = DVec4(-glm::dot(right, eye), -glm::dot(up, eye), glm::dot(forward, eye), 1.0);
  const double near = 0.1;
  const double far = 8.0;
  DMat4 clip_from_view(0.0);
  DVec4 eye_world(eye, 1.0);
  if (unit(rng) < 0.0) {
    clip_from_view[0][0] = clip_from_view[1][1] = 1.3;
    clip_from_view[2][2] = near / (far - near);
    clip_from_view[3][2] = near * far / (far - near);
    clip_from_view[2][3] = -1.0;
  } else {
    clip_from_view[0][0] = clip_from_view[1][1] = 0.7;
    clip_from_view[2][2] = 1.0 / (far - near);
    clip_from_view[3][2] = far / (far - near);
    clip_from_view[3][3] = 1.0;
    eye_world = DVec4(-forward, 0.0);
  }
  return {{clip_from_view * view_from_world, eye_world, Viewport(64, 64)}, {0, 0, world_from_object}};
}

}  // namespace sheaf::pipeline
