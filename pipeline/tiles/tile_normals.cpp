#include "pipeline/tiles/tile_normals.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "base/fail.h"
#include "pipeline/normals/normals_by_part.h"
#include "rfs_mesh/normals/sides.h"

namespace rfsmooth::pipeline::tiles {

namespace {

using Eigen::Vector3d;
using nlohmann::ordered_json;

/// Sums over the points p of a piece, around the middle of the cloud's box, and their normals n.
struct Piece {
  Vector3d at = Vector3d::Zero(), normal = Vector3d::Zero();
  double points = 0, square = 0;  // of |p|^2
  double outward = 0;             // of p . n
  double vote = 0;                // of the cosines of n to the viewpoint; 0 without one

  void add(const Vector3d& p, const Vector3d& n) {
    at += p;
    normal += n;
    points += 1;
    square += p.squaredNorm();
    outward += p.dot(n);
  }
  /// With the normals of `other`, reversed if `sign` is -1.
  void add(const Piece& other, double sign) {
    at += other.at;
    normal += sign * other.normal;
    points += other.points;
    square += other.square;
    outward += sign * other.outward;
    vote += sign * other.vote;
  }
  bool wrong_side() const {
    const Vector3d centre = at / points;
    const double volume = outward - centre.dot(normal),
                 extent = std::sqrt(std::max(0.0, square / points - centre.squaredNorm()));
    return rfs_mesh::on_wrong_side(vote, volume, extent * points, normal);
  }
};

ordered_json json_of_piece(const Piece& p) {
  return {p.at[0],     p.at[1],  p.at[2],  p.normal[0], p.normal[1],
          p.normal[2], p.points, p.square, p.outward,   p.vote};
}

Piece piece_of(const ordered_json& json) {
  const auto n = json.get<std::array<double, 10>>();
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6], n[7], n[8], n[9]};
}

/// What write_normals returned. \throw Failure if the tile was run without normals.
ordered_json read_normals(const Job& job, std::size_t tile) {
  ordered_json cost = read_cost(job, tile);  // of which it is a part
  if (!cost.contains("pieces"))
    fail(ErrorCode::input_unreadable, "{}: tells nothing of normals", job.cost(tile).string());
  return cost;
}

using Links = std::map<std::pair<Index, Index>, rfs_mesh::SideLink>;

/// What the points around a tile say of its pieces and those of their own tiles. `first`: the number of each
/// tile's first piece.
void link_pieces(const Job& job, std::size_t tile, const ordered_json& met, const std::vector<Index>& first,
                 Links& links, const Context& context) {
  ReaderOf<NormalRecord> here(job.around(tile), context);
  for (const ordered_json& of_tile : met) {
    const std::size_t other = of_tile.at(0);
    ReaderOf<NormalRecord> there(job.normals(other), context);
    for (std::uint64_t left = of_tile.at(1); left > 0; --left, here.next()) {
      const NormalRecord* const a = here.peek();
      const NormalRecord* b = there.peek();
      for (; a != nullptr && b != nullptr && b->row < a->row; b = there.peek()) there.next();
      if (a == nullptr || b == nullptr || a->row != b->row)
        fail(ErrorCode::internal, "normals of a tile and of one beside it are of other points");
      const Index p = first[tile] + Index(a->piece), q = first[other] + Index(b->piece);
      rfs_mesh::SideLink& link = links.try_emplace({p, q}, rfs_mesh::SideLink{p, q, 0, 0}).first->second;
      link.agreement += float(a->x * b->x + a->y * b->y + a->z * b->z);
      link.count += 1;
    }
  }
}

}  // namespace

ordered_json write_normals(const Job& job, std::size_t tile, const Gathered& points,
                           const NormalsOptions& options, double reach, const Context& context) {
  const auto& [own, around, xyz] = points;
  const std::size_t n = xyz.size() / 3;
  std::vector<double> normals(3 * n);
  std::vector<Index> part, number(n, kNone);  // of a part: its piece
  if (!own.empty()) normals_by_part(xyz.data(), n, options, context, normals.data(), part);
  const Vector3d middle = 0.5 * (job.box.low + job.box.high);
  const Eigen::AlignedBox3d box(job.tiles[tile].box.low, job.tiles[tile].box.high);
  std::vector<Piece> pieces;
  const auto record = [&](std::size_t i, std::uint64_t row) {
    Index& piece = number[part[i]];
    if (piece == kNone) {
      piece = Index(pieces.size());
      pieces.emplace_back();
    }
    const double* const normal = &normals[3 * i];
    return NormalRecord{row, normal[0], normal[1], normal[2], piece};
  };
  WriterOf<NormalRecord> inside(job.normals(tile), context), outside(job.around(tile), context);
  for (std::size_t i = 0; i < own.size(); ++i) {
    const NormalRecord r = record(i, own[i].row);
    const Vector3d p(&xyz[3 * i]), normal(r.x, r.y, r.z);
    Piece& piece = pieces[r.piece];
    piece.add(p - middle, normal);
    if (options.viewpoint) piece.vote += normal.dot((*options.viewpoint - p).normalized());
    inside.add(r);
  }
  std::vector<std::pair<std::size_t, std::uint64_t>> met;  // tiles, and how many of their points
  for (std::size_t k = 0; k < around.size(); ++k) {
    const std::size_t i = own.size() + k;
    if (own.empty() || box.squaredExteriorDistance(Vector3d(&xyz[3 * i])) > reach * reach) continue;
    outside.add(record(i, around[k].row));
    if (met.empty() || met.back().first != around[k].tile) met.emplace_back(around[k].tile, 0);
    ++met.back().second;
  }
  inside.commit();
  outside.commit();
  ordered_json all = ordered_json::array();
  for (const Piece& piece : pieces) all.push_back(json_of_piece(piece));
  return {{"met", met}, {"pieces", all}};
}

bool complete_normals(const Job& job, std::size_t tile, const Context& context) {
  const auto there = complete_records<NormalRecord>(job.normals(tile), context);
  return there && *there == job.tiles[tile].points &&
         complete_records<NormalRecord>(job.around(tile), context).has_value();
}

std::vector<std::vector<char>> find_sides(const Job& job, const Context& context) {
  std::vector<Piece> pieces;
  std::vector<Index> first;
  std::vector<ordered_json> met;
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    const ordered_json of_tile = read_normals(job, t);
    first.push_back(Index(pieces.size()));
    met.push_back(of_tile.at("met"));
    for (const ordered_json& piece : of_tile.at("pieces")) pieces.push_back(piece_of(piece));
  }
  Links between;
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    context.check_stop();
    link_pieces(job, t, met[t], first, between, context);
  }
  std::vector<rfs_mesh::SideLink> links;
  for (const auto& [of, link] : between) links.push_back(link);
  std::vector<double> votes;
  for (const Piece& piece : pieces) votes.push_back(piece.vote);
  const rfs_mesh::Regions regions = rfs_mesh::grow_regions(pieces.size(), std::move(links), votes, context);
  std::vector<Piece> sums(pieces.size());
  std::vector<std::size_t> count(pieces.size(), 0);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    sums[regions.of_point[p]].add(pieces[p], regions.turned[p] != 0 ? -1 : 1);
    ++count[regions.of_point[p]];
  }
  std::vector<std::vector<char>> reversed(job.tiles.size());
  for (std::size_t t = 0; t < job.tiles.size(); ++t)
    for (std::size_t p = first[t]; p < (t + 1 < first.size() ? first[t + 1] : pieces.size()); ++p) {
      const Index region = regions.of_point[p];
      const bool turned = regions.turned[p] != 0;
      reversed[t].push_back(count[region] > 1 && turned != sums[region].wrong_side() ? 1 : 0);
    }
  return reversed;
}

}  // namespace rfsmooth::pipeline::tiles
