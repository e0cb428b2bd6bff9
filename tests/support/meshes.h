/// Meshes every test may use: closed, open, regular, irregular, and broken ones.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::support {

/// Subdivided icosahedron of radius 1: 10 * 4^levels + 2 vertices, outward faces.
Mesh icosphere(int levels);

/// Torus around z: major 1, minor radius `minor`; around x along vertices. Outward faces.
Mesh torus(int around, int along, double minor);

/// Six vertices, eight equilateral faces, right angles between opposite ones. Outward.
Mesh octahedron();

/// A cube of side 2 around the origin, every side split into cells x cells squares of two triangles. Outward.
Mesh cube(int cells);

/// A machined part: an L-shaped angle with a slot through its foot, in unit squares of two triangles, with
/// edges that bend inward and outward. Closed, outward.
Mesh bracket();

/// Open, curved, with a boundary of right-angled corners: z = (x^2 + y^2) / 8 over a square of side 2 * half,
/// all faces up.
Mesh bowl(int half);

/// A one-sided strip of 2 * around vertices; faces agree but at one place.
Mesh moebius(int around);

/// A sphere with a fin: one edge has a third face, whose own two edges have one.
Mesh finned_sphere(int levels);

/// columns x rows vertices at spacing 1 in the plane z = 0, one diagonal per cell; `equilateral` shears it
/// into equilateral triangles.
Mesh grid(int columns, int rows, bool equilateral = false);

/// Open cylinder around z of radius 1 with `around` vertices per ring and `rings` rings `step` apart.
Mesh cylinder(int around, int rings, double step);

/// A sphere of radius 1 whose lower half is sampled twice as finely (longitude circles, closed by poles).
Mesh two_density_sphere(int around);

/// Three pages of two triangles each on one common edge, and a bow tie of two triangles at a vertex.
Mesh non_manifold_fan();

/// A flat patch with a zero-area face, a needle, coincident vertices, a loose edge and an isolated vertex.
Mesh degenerate_triangles();

/// Every fixture above, small.
std::vector<Mesh> all_small();

/// Adds Gaussian noise of standard deviation sigma per coordinate, the same for the same seed.
void add_noise(Mesh& mesh, double sigma, unsigned seed);

/// The mesh with vertex i at place[i].
Mesh permuted(const Mesh& mesh, const std::vector<Index>& place);

/// Sum of the triangles' areas.
double area(const Mesh& mesh);

/// Enclosed volume of a closed, oriented mesh (divergence theorem).
double enclosed_volume(const Mesh& mesh);

/// Mean length of the edges.
double mean_edge(const Mesh& mesh);

/// Root mean square of |x_i - y_i|.
double rms_distance(const Positions& x, const Positions& y);

/// Root mean square of | |x_i| - 1 |.
double rms_off_unit_sphere(const Positions& x);

}  // namespace rfsmooth::support
