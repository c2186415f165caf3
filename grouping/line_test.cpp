#include "grouping/line_test.h"

#include <cmath>

namespace sheaf::grouping {

LineTest::LineTest(std::span<const Vec3> positions, std::span<const std::uint32_t> in_use, double eps,
                   std::span<const Sym3> ellipsoids, bool segment_only)
    : eps_(eps), segment_only_(segment_only) {
  for (const std::uint32_t v : in_use) {
    position_.emplace_back(positions[v]);
    if (ellipsoids.empty()) continue;
    whiten_.push_back(whiteningOf(ellipsoids[v]));
    // The longest half-axis is at most the root of the trace.
    reach_.push_back(std::sqrt(ellipsoids[v].trace()) * 1.000001);
  }
}

LineTest::Whitening LineTest::whiteningOf(const Sym3& r) {
  // R = G G' (Cholesky), W = inverse(G).
  const double g_xx = std::sqrt(r.xx), g_yx = r.xy / g_xx, g_zx = r.xz / g_xx;
  const double g_yy = std::sqrt(r.yy - g_yx * g_yx), g_zy = (r.yz - g_zx * g_yx) / g_yy;
  const double g_zz = std::sqrt(r.zz - g_zx * g_zx - g_zy * g_zy);
  Whitening w;
  if (!(g_xx > 0.0 && g_yy > 0.0 && g_zz > 0.0)) return w;
  w.xx = 1.0 / g_xx;
  w.yy = 1.0 / g_yy;
  w.zz = 1.0 / g_zz;
  w.yx = -w.yy * g_yx * w.xx;
  w.zy = -w.zz * g_zy * w.yy;
  w.zx = -w.zz * (g_zx * w.xx + g_zy * w.yx);
  w.limit = 1.0;
  return w;
}

}  // namespace sheaf::grouping
