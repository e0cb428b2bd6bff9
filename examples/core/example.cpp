// Denoise an array of coordinates in place.
#include <cstdio>
#include <random>
#include <vector>

#include <rfsmooth/denoise.h>

int main() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.3);
  std::vector<double> xyz;  // n x 3: a sheet with noise
  for (int i = 0; i < 2500; ++i) xyz.insert(xyz.end(), {double(i % 50), double(i / 50), noise(random)});
  const auto report = rfsmooth::denoise(xyz.data(), xyz.size() / 3, {}, {});
  if (!report.ok()) return std::printf("%s\n", report.error().message.c_str()), 1;
  std::printf("%zu of %zu points moved\n", report.value().moved, report.value().points);
  return report.value().moved > 2000 ? 0 : 1;
}
