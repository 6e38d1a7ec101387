#include "driven_motion.h"

#include "discretization/cells.h"
#include "discretization/node_coordinates.h"
#include "discretization/point_places.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    template <int dim>
    const BoundaryInput *boundary_of(const SceneInput &input,
                                     const Discretization<dim> &discretization,
                                     const std::size_t i)
    {
      const PointOrigin origin = discretization.origins()[i];
      return origin.kind == PointOrigin::Kind::motion
                 ? &input.boundaries[origin.block]
                 : nullptr;
    }
  } // namespace

  template <int dim>
  DrivenMotion<dim>::DrivenMotion(const SceneInput &input,
                                  const Discretization<dim> &discretization)
      : input_(input), discretization_(discretization)
  {
    if (input.time.scheme.at_nodes)
      return; // groups take each component once, where the points are
    const std::size_t n = discretization.points().n_points;
    const auto &bodies = discretization.bodies();
    const auto places = point_places(bodies, n);
    std::vector<double> coordinates;
    first_.assign(1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (boundary_of(input, discretization, i)) {
        const PointPlace place =
            places[0][i].body >= 0 ? places[0][i] : places[1][i];
        const BodyClass *body =
            place.body >= 0 ? &bodies.classes[bodies.class_of[place.body]]
                            : nullptr;
        if (body == nullptr || body->rigid)
          samples_.push_back({position_of(discretization.points(), i), 1.});
        else {
          if (coordinates.empty())
            coordinates = node_coordinates(discretization);
          const double *nodes =
              coordinates.data() + bodies.first_dof[place.body];
          for (unsigned int j = 0; j < body->n_dofs; j += dim) {
            const double share = body->trace(place.slot * dim, j);
            if (std::abs(share) < 1e-13)
              continue; // a node off the face
            Sample sample;
            sample.share = share;
            for (unsigned int c = 0; c < dim; ++c)
              sample.place[c] = nodes[j + c];
            const auto inside =
                sample.place +
                1e-11 * (discretization.cells().centre(unsigned(place.body)) -
                         sample.place);
            if (jumps_at(i, sample.place, inside))
              sample.place = inside;
            samples_.push_back(sample);
          }
        }
      }
      first_.push_back(samples_.size());
    }
    choose_rows();
  }

  /** A motion that jumps across the face between two cells is each one's own.
   */
  template <int dim>
  bool DrivenMotion<dim>::jumps_at(const std::size_t i,
                                   const dealii::Point<dim> &place,
                                   const dealii::Point<dim> &inside) const
  {
    const double end = input_.time.end;
    for (unsigned int c = 0; c < dim; ++c)
      for (const Expression *motion : {velocity(i, c), displacement(i, c)})
        for (const double t : {0., 0.3 * end, 0.7 * end, end}) {
          if (motion == nullptr)
            continue;
          const double here = motion->at(place, t),
                       there = motion->at(inside, t);
          if (std::abs(here - there) >
              1e-6 * std::max(std::abs(here), std::abs(there)))
            return true;
        }
    return false;
  }

  template <int dim>
  std::vector<std::size_t>
  DrivenMotion<dim>::dependent_rows(const Block &trace,
                                    const std::vector<Row> &rows)
  {
    const unsigned int n = trace.cols;
    struct Rest {
      std::size_t component;
      std::vector<double> x; ///< what is left of the row
      double before, now;    ///< its square
    };
    std::vector<Rest> left;
    for (const Row &row : rows) {
      Rest &rest = left.emplace_back(
          Rest{row.component, std::vector<double>(n), 0., 0.});
      for (unsigned int j = 0; j < n; ++j) {
        rest.x[j] = trace(row.trace, j);
        rest.before += rest.x[j] * rest.x[j];
      }
      rest.now = rest.before;
    }
    // to a relative length of 1e-8, round-off of as many subtractions
    const auto gone = [](const Rest &rest) {
      return rest.now <= 1e-16 * rest.before;
    };
    while (true) {
      const auto next = std::max_element(
          left.begin(), left.end(), [](const Rest &one, const Rest &other) {
            return one.now < other.now;
          });
      if (next == left.end() || gone(*next))
        break;
      std::vector<double> e = std::move(next->x);
      const double length = std::sqrt(next->now);
      left.erase(next);
      for (double &value : e)
        value /= length;
      for (Rest &rest : left) {
        double share = 0.;
        for (unsigned int j = 0; j < n; ++j)
          share += rest.x[j] * e[j];
        rest.now = 0.;
        for (unsigned int j = 0; j < n; ++j) {
          rest.x[j] -= share * e[j];
          rest.now += rest.x[j] * rest.x[j];
        }
      }
    }
    std::vector<std::size_t> components;
    for (const Rest &rest : left)
      components.push_back(rest.component);
    return components;
  }

  /**
   * Where two faces of a cell are driven, or a face has more points than nodes,
   * points ask twice for the motion of the same nodes: rows that depend on
   * others are left out, or W would be singular. The row that is farthest from
   * those chosen comes next (Gram-Schmidt with pivots): the first points of a
   * face alone would hold its far end by extrapolation.
   */
  template <int dim>
  void DrivenMotion<dim>::choose_rows()
  {
    const std::size_t n = discretization_.points().n_points;
    const auto &bodies = discretization_.bodies();
    chosen_.assign(n * dim, 1);
    std::vector<std::vector<Row>> rows(bodies.size());
    for_all_places(
        bodies, n,
        [&](const std::size_t body, const unsigned int slot,
            const std::size_t point, unsigned int) {
          for (unsigned int c = 0; c < dim; ++c)
            if (velocity(point, c) || displacement(point, c))
              rows[body].push_back({point * dim + c, slot * dim + c});
        });
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const BodyClass &body = bodies.classes[bodies.class_of[b]];
      if (!body.rigid) // else held evenly by all points, least impulses decide
        for (const std::size_t row : dependent_rows(body.trace, rows[b]))
          chosen_[row] = 0;
    }
  }

  template <int dim>
  const Expression *DrivenMotion<dim>::velocity(const std::size_t i,
                                                const unsigned int c) const
  {
    const auto *boundary = boundary_of(input_, discretization_, i);
    return boundary && boundary->velocity[c] ? &*boundary->velocity[c]
                                             : nullptr;
  }

  template <int dim>
  const Expression *DrivenMotion<dim>::displacement(const std::size_t i,
                                                    const unsigned int c) const
  {
    const auto *boundary = boundary_of(input_, discretization_, i);
    return boundary && boundary->displacement[c] ? &*boundary->displacement[c]
                                                 : nullptr;
  }

  template <int dim>
  bool DrivenMotion<dim>::drives(const std::size_t i,
                                 const unsigned int c) const
  {
    return (chosen_.empty() || chosen_[i * dim + c]) &&
           (velocity(i, c) || displacement(i, c));
  }

  template <int dim>
  double DrivenMotion<dim>::at(const Expression &motion, const std::size_t i,
                               const double t) const
  {
    if (motion.is_constant())
      return motion(0., 0., 0., t);
    if (first_.empty())
      return motion.at(position_of(discretization_.points(), i), t);
    double sum = 0.;
    for (std::size_t s = first_[i]; s < first_[i + 1]; ++s)
      sum += samples_[s].share * motion.at(samples_[s].place, t);
    return sum;
  }

  template <int dim>
  double DrivenMotion<dim>::velocity_at(const Expression &velocity,
                                        const std::size_t i, const double t,
                                        const LoadClock &clock) const
  {
    return clock.rests(discretization_.origins()[i].block, t)
               ? 0.
               : at(velocity, i, t);
  }

  template <int dim>
  double DrivenMotion<dim>::place_at(const Expression &displacement,
                                     const std::size_t i, const double t,
                                     const LoadClock &clock) const
  {
    return at(displacement, i, clock.at(discretization_.origins()[i].block, t));
  }

  template class DrivenMotion<2>;
  template class DrivenMotion<3>;
} // namespace nsfd
