#include "bonded.h"

#include "body_loops.h"

#include "nsfd/core/archive.h"

#include <stdexcept>

namespace nsfd
{
  template <int dim>
  BondedDelassus<dim>::BondedDelassus(const Communicator &communicator,
                                      const Bodies &bodies,
                                      const InterfacePoints<dim> &points)
      : DelassusOperator<dim>(communicator, bodies, points), bulk_(*this),
        bonded_(points.n_points, 0), penalised_(bonded_),
        shares_nodes_(points.faces.size(), 0), jump_(points.n_points * dim),
        traction_(points.n_points * dim), force_(bodies.n_dofs())
  {
    for (const auto &body : bodies.classes) {
      traction_transposed_.push_back(body.traction.transposed());
      viscous_transposed_.push_back(body.viscous_traction.transposed());
    }
  }

  template <int dim>
  bool BondedDelassus<dim>::set_bonds(const std::vector<std::uint8_t> &bonded)
  {
    if (!this->communicator_.any(bonded != bonded_))
      return false;
    bool impossible = false;
    for (std::size_t i = 0; i < bonded.size(); ++i)
      impossible |= bonded[i] && bulk_.bonds()[i].penalty == 0.;
    if (this->communicator_.any(impossible))
      throw std::runtime_error("two rigid bodies share a bonded face: join "
                               "them with the law `rigid`");
    bonded_ = penalised_ = bonded;
    bonds_changed();
    return true;
  }

  template <int dim>
  void BondedDelassus<dim>::serialize(Archive &archive)
  {
    DelassusOperator<dim>::serialize(archive);
    std::vector<std::uint8_t> bonded(bonded_);
    archive.points("bonded", bonded);
    if (archive.reads())
      set_bonds(bonded);
  }

  template <int dim>
  void BondedDelassus<dim>::apply(const Operator op, const double *x,
                                  double *y) const
  {
    DelassusOperator<dim>::apply(op, x, y);
    if (op == Operator::stiffness || op == Operator::damping)
      add_bonds(op == Operator::damping, x, y);
  }

  /** y += K_bonds x, or C_bonds x. */
  template <int dim>
  void BondedDelassus<dim>::add_bonds(const bool viscous, const double *x,
                                      double *y) const
  {
    const auto &points = this->points_;
    const auto &bonds = bulk_.bonds();
    const std::size_t n = points.n_points;
    this->relative_velocity(x, jump_.data());
    if (viscous)
      bulk_.evaluate_viscous(x, traction_.data());
    else
      bulk_.evaluate(x, traction_.data());
    const auto &transposed =
        viscous ? viscous_transposed_ : traction_transposed_;
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned int c = 0; c < dim; ++c) {
        double &u = jump_[i * dim + c], &t = traction_[i * dim + c];
        const double w = penalised_[i] ? points.weight[i] : 0.;
        t = w *
            (t + (viscous ? bonds[i].viscous_penalty : bonds[i].penalty) * u);
        u *= w;
      }
    this->generalised_impulse(traction_.data(), force_.data());
    for (std::size_t k = 0; k < force_.size(); ++k)
      y[k] += force_[k];
    // the tractions of the test functions, each body with its share
    this->to_cartesian(jump_.data());
    const auto &bodies = this->bodies_;
    const auto gather = [&](const unsigned int b, double *in,
                            const unsigned int stride) {
      const std::size_t first = bodies.first_slot[b],
                        n_slots = bodies.first_slot[b + 1] - first;
      for (std::size_t s = 0; s < n_slots; ++s) {
        const std::size_t p = bodies.slot_point[first + s];
        const bool second = bodies.slot_sign[first + s] > 0;
        const double share = p == n   ? 0.
                             : second ? -bonds[p].weight_2
                                      : bonds[p].weight_1;
        for (unsigned int c = 0; c < dim; ++c)
          in[(s * dim + c) * stride] = share * this->cartesian_[p * dim + c];
      }
    };
    for_all_bodies(
        bodies,
        [&](const std::size_t k) -> const Block & { return transposed[k]; },
        gather, dof_scatter<true>(bodies, y));
  }

  template class BondedDelassus<2>;
  template class BondedDelassus<3>;
} // namespace nsfd
