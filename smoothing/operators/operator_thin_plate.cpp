#include "base/parallel.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

void apply_thin_plate(const Adjacency& rows, const Operator& op, const Positions& x, Positions& y,
                      Positions& scratch, const Context& context) {
  apply(rows, op, x, scratch, context);
  apply(rows, op, scratch, y, context);
}

double thin_plate_energy(const Adjacency& rows, const Operator& op, const Positions& x,
                         const Context& context) {
  Positions first;
  apply(rows, op, x, first, context);
  return sum_over(context, x.size(), 0.0, [&](std::size_t i) { return op.mass[i] * first[i].squaredNorm(); });
}

}  // namespace rfsmooth::smoothing
