// Denoise an array of coordinates in place.
#include <cmath>
#include <cstdio>
#include <vector>

#include <rfsmooth/denoise.h>

int main() {
  std::vector<double> xyz;  // n x 3: a rough sheet
  for (int i = 0; i < 2500; ++i)
    xyz.insert(xyz.end(), {double(i % 50), double(i / 50), 0.4 * std::sin(12.9898 * i)});
  const auto report = rfsmooth::denoise(xyz.data(), xyz.size() / 3, {}, {});
  if (!report.ok()) return std::printf("%s\n", report.error().message.c_str()), 1;
  std::printf("%zu of %zu points moved\n", report.value().moved, report.value().points);
  return report.value().moved > 2000 ? 0 : 1;
}
