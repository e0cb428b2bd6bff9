/// Whole sensors and what they make of a room (room.h): spinning lasers, terrestrial scanners, depth cameras.
/// Lengths in metres.
///
/// A sensor is a table row (sensors()). A laser measures ranges along rays that go around z, a camera depths
/// along z. Of each range or depth:
///
///     length = truth + error
///     length = c / to a whole step( c / length + error of the disparity )     two eyes only
///     measured = to a whole step( length )
///
/// with c the disparity at one metre. Errors are normal, and may be shared by neighbouring rays. The noise of
/// a Kinect is that of Nguyen, Izadi and Lovell 2012 ("Modeling Kinect sensor noise for improved 3D
/// reconstruction and tracking").
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "clouds/scanner/room.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::clouds {

inline constexpr double kCameraField = 57;     ///< of every camera, across, degrees
inline constexpr int kDisparityColumns = 640;  ///< of the image in whose pixels disparities are told
inline constexpr double kBaseline = 0.075;     ///< between the two eyes of a camera, metres

/// What looks at the room. Zero is without.
struct Sensor {
  std::string_view name;
  std::string_view says;           ///< for tables and help
  bool camera = false;             ///< a pinhole that looks along z; else a laser that turns about z
  int columns = 0;                 ///< rays across: in `around`, or in kCameraField
  int rows = 0;                    ///< rings of a laser, rows of an image
  double lowest = 0, highest = 0;  ///< ring of a laser, degrees above the horizon; the others evenly between
  double around = 360;             ///< how far a laser turns, degrees
  double sigma = 0;                ///< standard deviation of ranges or depths, metres, ...
  double growth = 0;               ///< ... plus this times (depth - 0.4)^2, 1 / metres
  double disparity = 0;            ///< standard deviation of disparities, pixels
  int shared = 0;             ///< errors are sums over neighbouring rays with the binomial weights of this
                              ///< order across and down: a standard deviation of half its root, rays
  double step = 0;            ///< ranges or depths are whole multiples of this, metres
  double disparity_step = 0;  ///< disparities are whole multiples of this, pixels
  std::vector<double> levels = {1};  ///< the factors by which benchmarks make its noise larger
};

/// The sensors that benchmarks go through.
const std::vector<Sensor>& sensors();

/// By its name; null if there is none.
const Sensor* find_sensor(std::string_view name);

/// The same sensor with all its noise larger by a factor; steps stay.
Sensor scaled(Sensor sensor, double times);

/// The room that a sensor is in: the hall for lasers, the corner for cameras.
const Room& room_of(const Sensor& sensor);

/// rows x columns rays, the lowest ring or the top row first: unit vectors of a laser, z = 1 of a camera. The
/// same bits on every machine.
Positions rays(const Sensor& sensor);

/// Row by row what a sensor says and what is true, of the rays that met something.
struct Sight {
  Positions measured;
  Positions truth;  ///< on the room's surface
};

/// What a sensor sees of its room. Measures of less than 0.2 m and more than 50 m are none. Same seed, same
/// bytes on every machine. O(rays x (parts of the room + shared)).
Sight look(const Sensor& sensor, std::uint64_t seed);

}  // namespace rfsmooth::clouds
