#pragma once

#include "mesh/body_table.h"
#include "nsfd/core/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace nsfd
{
  /**
   * Where nodes are within a step: those of rigid bodies turn about their
   * centres, all others move on straight lines. A chord leaves its arc by
   * 3 % of the radius if the body turns by half a radian.
   */
  template <int dim>
  class TurningBodies
  {
  public:
    /** @p from and @p to as State::rigid; what @p is_round of a body says is
        where it is, however it turns. */
    template <typename IsRound>
    TurningBodies(const BodyTable &table, const std::vector<double> &from,
                  const std::vector<double> &to, const IsRound &is_round)
        : table_(table), turns_(table.n_rigid)
    {
      using namespace space;
      for (unsigned int body = 0; body < table.bodies.size(); ++body) {
        if (!table.is_rigid(body))
          continue;
        const auto r = std::size_t(table.bodies[body].rigid);
        const double *a = from.data() + 13 * r, *b = to.data() + 13 * r;
        Turn &turn = turns_[r];
        std::copy_n(a, 3, turn.from.begin());
        std::copy_n(b, 3, turn.to.begin());
        if (is_round(body))
          continue;
        // the shorter way round: a step turns by less than half of it
        Quaternion q =
            product({b[6], b[7], b[8], b[9]}, {a[6], -a[7], -a[8], -a[9]});
        if (q[0] < 0.)
          q = {-q[0], -q[1], -q[2], -q[3]};
        const Vec3 axis = {q[1], q[2], q[3]};
        const double sine = norm(axis);
        turn.angle = 2. * std::atan2(sine, q[0]);
        if (sine > 0.)
          turn.axis = (1. / sine) * axis;
        largest_ = std::max(largest_, turn.angle);
      }
    }

    /** Equal parts of the step in which nothing turns by more than half a
        radian. */
    std::size_t n_parts() const
    {
      return std::max<std::size_t>(1, std::size_t(std::ceil(2. * largest_)));
    }

    /** From @p x to @p y in the whole step, after @p share of it. */
    template <typename Vector>
    Vector place(const unsigned int body, const Vector &x, const Vector &y,
                 const double share) const
    {
      using namespace space;
      Vector result(x);
      if (!table_.is_rigid(body)) {
        for (int d = 0; d < dim; ++d)
          result[d] += share * (y[d] - x[d]);
        return result;
      }
      const Turn &turn = turns_[std::size_t(table_.bodies[body].rigid)];
      Vec3 arm{};
      for (int d = 0; d < dim; ++d)
        arm[d] = x[d] - turn.from[d];
      const double half = 0.5 * share * turn.angle;
      const Vec3 axis = std::sin(half) * turn.axis;
      arm = rotation({std::cos(half), axis[0], axis[1], axis[2]}) * arm;
      for (int d = 0; d < dim; ++d)
        result[d] = turn.from[d] + share * (turn.to[d] - turn.from[d]) + arm[d];
      return result;
    }

  private:
    struct Turn {
      Vec3 from{}, to{}, axis{}; ///< centres
      double angle = 0.;
    };
    const BodyTable &table_;
    std::vector<Turn> turns_;
    double largest_ = 0.;
  };
} // namespace nsfd
