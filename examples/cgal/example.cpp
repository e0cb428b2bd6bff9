// From points to a surface through them.
#include <cmath>
#include <cstdio>

#include <rfsmooth/cgal/advancing_front.h>

int main() {
  rfsmooth::Positions points;  // on a sphere, along a spiral
  for (int i = 0; i < 2000; ++i) {
    const double z = (i + 0.5) / 1000 - 1, around = 2.399963 * i, r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(around), r * std::sin(around), z);
  }
  const auto mesh = rfsmooth::cgal::advancing_front(points, {}, 0, {});
  if (!mesh.ok()) return std::printf("%s\n", mesh.error().message.c_str()), 1;
  std::printf("%zu triangles\n", mesh.value().faces.size());
  return mesh.value().faces.size() == 3996 ? 0 : 1;  // 2 n - 4: closed
}
