#include "static_bonds.h"

#include "bond_release.h"

#include "joined/connected_cells.h"

#include <algorithm>
#include <utility>

namespace nsfd
{
  template <int dim>
  void StaticBonds<dim>::set()
  {
    if (bonded_.set_bonds(bonded_points(iterate_.at))) {
      changed_ = true;
      smallest_ = 0.;
    }
  }

  template <int dim>
  void StaticBonds<dim>::constrain()
  {
    supports_.prescribe_once(bonded_, discretization_.origins(),
                             std::exchange(changed_, false), problem_);
  }

  template <int dim>
  double StaticBonds<dim>::cells_of_smallest_body()
  {
    if (smallest_ > 0.)
      return smallest_;
    ConnectedCells<dim> bodies(discretization_, bonded_.communicator());
    bodies.connect([this](const typename InterfacePoints<dim>::Face &face) {
      return face.count > 0 &&
             iterate_.at.kind[face.first] == PointKind::bonded;
    });
    std::vector<double> cells(bodies.count(), 0.);
    for (const unsigned int body : bodies.numbers())
      ++cells[body];
    MPI_Allreduce(MPI_IN_PLACE, cells.data(), int(cells.size()), MPI_DOUBLE,
                  MPI_SUM, bonded_.communicator().mpi());
    smallest_ =
        cells.empty() ? 1. : *std::min_element(cells.begin(), cells.end());
    return smallest_;
  }

  template <int dim>
  void StaticBonds<dim>::start_from_rest(
      const double h, const std::vector<double> &loads,
      const std::vector<double> &impulse,
      const std::vector<double> &displacement, const double forces)
  {
    std::vector<double> momentum(loads.size());
    bonded_.apply(DelassusOperator<dim>::Operator::stiffness,
                  displacement.data(), momentum.data());
    for (std::size_t k = 0; k < loads.size(); ++k)
      momentum[k] = h * (loads[k] - momentum[k]);
    problem_.free_motion = FreeVelocity::unknown;
    nodes_.motion().start(momentum, impulse,
                          std::vector<double>(problem_.n_points * dim, 0.),
                          h * forces);
  }

  template <int dim>
  void StaticBonds<dim>::finish_from_rest(const double h,
                                          std::vector<double> &velocity,
                                          std::vector<double> &left)
  {
    NodeMotion &motion = nodes_.motion();
    velocity.assign(bonded_.bodies().n_dofs(), 0.);
    motion.add_to(velocity);
    left = motion.left_over();
    for (double &p : left)
      p /= h;
    motion.cancel();
  }

  template <int dim>
  void StaticBonds<dim>::set_tractions(State &state) const
  {
    set_bond_tractions(bulk_, state);
  }

  template <int dim>
  std::vector<double> StaticBonds<dim>::shares() const
  {
    State state = iterate_.at;
    for (std::size_t i = 0; i < state.kind.size(); ++i)
      if (has_let_go(i))
        state.kind[i] = PointKind::bonded;
    set_tractions(state);
    return bond_shares(problem_, bonded_, mean_, state);
  }

  template <int dim>
  bool StaticBonds<dim>::is_closed(const State &state,
                                   const std::size_t i) const
  {
    const auto &law = problem_.interactions[problem_.interaction[i]].law;
    return state.kind[i] == PointKind::cohesive && law && law->extrinsic() &&
           state.opening_max[i] <=
               (1. + 1e-9) * opening_at_release<dim>(problem_, i);
  }

  template <int dim>
  double StaticBonds<dim>::share_of(const std::vector<double> &force,
                                    const std::size_t i) const
  {
    const double *r = &force[i * dim];
    return effective_traction<dim>(problem_, i, -r[0], r + 1) /
           (problem_.weight[i] * point_strength<dim>(problem_, i));
  }

  template <int dim>
  bool StaticBonds<dim>::let_go()
  {
    constexpr double enough = 1. / 3.;
    set_tractions(iterate_.at);
    const auto points = points_at_share(problem_, bonded_, mean_, enough,
                                        iterate_.at, iterate_.at);
    for (const auto &[i, way] : points) {
      iterate_.activated[i] = LoadStepIterate<dim>::lets_go;
      iterate_.at.kind[i] = PointKind::cohesive;
      iterate_.at.opening_max[i] = opening_at_release<dim>(problem_, i);
    }
    return bonded_.communicator().any(!points.empty());
  }

  template <int dim>
  double StaticBonds<dim>::work_of_released(const std::vector<double> &forces,
                                            const State &next) const
  {
    const State &old = *iterate_.old;
    const auto &communicator = bonded_.communicator();
    bool any = false;
    for (std::size_t i = 0; i < problem_.n_owned; ++i)
      any = any || has_let_go(i);
    if (!communicator.any(any))
      return 0.;
    const std::size_t n = old.displacement.size();
    std::vector<double> f(n), of_points(n), r = old.point_force;
    r.resize(old.jump.size(), 0.);
    for (std::size_t i = 0; i < old.pressure.size(); ++i)
      r[i * dim] += problem_.weight[i] * old.pressure[i];
    bonded_.apply(DelassusOperator<dim>::Operator::stiffness,
                  old.displacement.data(), f.data());
    bonded_.generalised_impulse(r.data(), of_points.data());
    for (std::size_t k = 0; k < n; ++k)
      f[k] = (f[k] - forces[k] - of_points[k]) / 2. *
             (next.displacement[k] - old.displacement[k]);
    return communicator.sum(f);
  }

  template class StaticBonds<2>;
  template class StaticBonds<3>;
} // namespace nsfd
