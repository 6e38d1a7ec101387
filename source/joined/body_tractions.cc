#include "body_tractions.h"

#include "discretization/cells.h"
#include "discretization/discretization.h"
#include "discretization/point_places.h"

namespace nsfd
{
  template <int dim>
  BodyTractions<dim>::BodyTractions(const Discretization<dim> &discretization,
                                    Block BodyClass::*const block)
  {
    const Bodies &bodies = discretization.bodies();
    const std::size_t n = discretization.points().n_points;
    first_.push_back(0);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      first_.push_back(first_.back() +
                       (bodies.classes[bodies.class_of[b]].*block).rows);
    values_.assign(first_.back() + dim, 0.);
    place_.assign(n, {{first_.back(), first_.back()}});
    for_all_places(bodies, n,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, const unsigned int side) {
                     if (acts_in(body))
                       place_[point][side] =
                           first_[body] + std::size_t(slot) * dim;
                   });
  }

  template class BodyTractions<2>;
  template class BodyTractions<3>;
} // namespace nsfd
