#include "joined_bodies.h"
#include "joined_motion.h"
#include "node_values.h"

#include "linear_algebra/factor_limits.h"
#include "sparse_assembly.h"

#include "core/cost.h"
#include "core/gather.h"
#include "nsfd/core/archive.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** Of this rank, among those of all. Collective. */
    long long first_unknown(const Communicator &communicator,
                            const Bodies &bodies)
    {
      const long long mine = static_cast<long long>(bodies.n_dofs());
      long long sum = 0;
      MPI_Scan(&mine, &sum, 1, MPI_LONG_LONG, MPI_SUM, communicator.mpi());
      return sum - mine;
    }
  } // namespace

  template <int dim>
  JoinedBodies<dim>::JoinedBodies(const Communicator &communicator,
                                  const Bodies &bodies,
                                  const InterfacePoints<dim> &points,
                                  const std::vector<double> &coordinates,
                                  FixedFaces faces,
                                  const long long largest_factor)
      : JoinedDelassus<dim>(communicator, bodies, points),
        finest_(*this, first_unknown(communicator, bodies), std::move(faces)),
        substructures_(finest_), factor_(communicator, largest_factor),
        jacobi_(communicator),
        tangent_(*this, finest_, communicator, largest_factor)
  {
    matrix_ = std::make_unique<JoinedMatrix<dim>>(*this, finest_.first_dof());
    const SparseAssembly<dim> nodes(communicator, bodies, points, coordinates);
    conforming_ = std::make_unique<ConformingSpace>(
        communicator, dim, nodes.unknowns(), nodes.node_pairs(),
        nodes.node_ties());
    this->motion_ = std::make_unique<JoinedMotion<dim>>(*this);
    JoinedBodies::bonds_changed();
  }

  template <int dim>
  std::vector<std::uint8_t>
  JoinedBodies<dim>::once_per_node(const std::vector<std::uint8_t> &masks)
  {
    struct Claim {
      long long node;
      std::uint64_t key; ///< of the face
      unsigned int number, point, mask;
      int rank;
      bool operator<(const Claim &other) const
      {
        return std::tie(node, key, number) <
               std::tie(other.node, other.key, other.number);
      }
    };
    std::vector<Claim> claims;
    const auto &matrix = this->matrix();
    for (std::size_t i = 0; i < masks.size(); ++i) {
      const long long node = masks[i] ? matrix.node_of_point(i) : -1;
      if (node < 0)
        continue;
      const auto &face = this->points_.faces[this->points_.face_of[i]];
      claims.push_back({node, face.key, unsigned(i) - face.first, unsigned(i),
                        masks[i], this->communicator_.rank()});
    }
    claims = gather_all(this->communicator_, claims);
    std::sort(claims.begin(), claims.end());
    std::vector<std::uint8_t> result = masks;
    unsigned int said = 0;
    for (std::size_t k = 0; k < claims.size(); ++k) {
      if (k == 0 || claims[k].node != claims[k - 1].node)
        said = 0;
      if (claims[k].rank == this->communicator_.rank())
        result[claims[k].point] &= std::uint8_t(~said);
      said |= claims[k].mask;
    }
    return result;
  }

  namespace
  {
    /** Faces that are bonded all over, node to node. */
    template <int dim>
    std::vector<char> joined_by(const std::vector<std::uint8_t> &bonded,
                                const InterfacePoints<dim> &points,
                                const ConformingSpace &space)
    {
      std::vector<char> joined(points.faces.size(), 0);
      for (std::size_t f = 0; f < joined.size(); ++f) {
        const auto &face = points.faces[f];
        const auto first = bonded.begin() + face.first;
        joined[f] = space.is_complete(f) &&
                    std::all_of(first, first + face.count,
                                [](const std::uint8_t b) { return b; });
      }
      return joined;
    }
  } // namespace

  template <int dim>
  std::vector<char>
  JoinedBodies<dim>::sharing(const std::vector<std::uint8_t> &bonded)
  {
    return conforming_->without_contradiction(
        joined_by(bonded, this->points_, *conforming_));
  }

  template <int dim>
  std::vector<char>
  JoinedBodies<dim>::opens_with(const std::vector<std::uint8_t> &bonded)
  {
    return conforming_->jumping(joined_by(bonded, this->points_, *conforming_));
  }

  template <int dim>
  void JoinedBodies<dim>::bonds_changed()
  {
    valid_ = false;
    means_ = Means::unknown;
    this->shares_nodes_ = sharing(this->bonded_);
    conforming_->conform(this->shares_nodes_);
    const CoarseSpace &nodes = conforming_->space();
    const bool bonds =
        std::any_of(this->bonded_.begin(), this->bonded_.end(),
                    [](const std::uint8_t bond) { return bond; });
    if (!finest_.is_known() && this->communicator_.any(bonds) &&
        nodes.ties.empty() && !tangent_.is_too_large(nodes))
      finest_.find(*conforming_, this->shares_nodes_);
    placed_ = false;
    substructures_.space_changed();
    jacobi_.clear();
    factor_.set_space(nodes);
    tangent_.set_space(nodes);
    // of several unknowns that are one node, the first
    representative_ = std::vector<int>(std::size_t(nodes.n_own), -1);
    for (std::size_t i = 0; i < nodes.number.size(); ++i) {
      const long long mine = nodes.number[i] - nodes.first;
      if (mine >= 0 && mine < nodes.n_own && representative_[mine] < 0)
        representative_[mine] = int(i);
    }
  }

  /**
   * In the present space. It is made where it is asked for first: before the
   * bonds of a scene are known, and in a run of equilibria for the bodies of
   * its motions, no one does.
   */
  template <int dim>
  JoinedMatrix<dim> &JoinedBodies<dim>::matrix() const
  {
    if (!placed_)
      matrix_->set_space(conforming_->space(), this->shares_nodes_);
    placed_ = true;
    return *matrix_;
  }

  /** M_hat + H^T T H in the space, @p springs the blocks T; none if empty. */
  template <int dim>
  const SparseRows &
  JoinedBodies<dim>::assemble(const std::vector<double> &springs) const
  {
    matrix().set_step(this->shares(this->time_step_, this->theta_));
    return matrix().assemble(springs.empty() ? nullptr : springs.data());
  }

  template <int dim>
  bool JoinedBodies<dim>::join_motion(std::vector<double> &x)
  {
    const bool rests =
        std::all_of(x.begin(), x.end(), [](const double v) { return v == 0.; });
    if (!this->communicator_.any(!rests))
      return false;
    ConformingSolver mass(this->communicator_,
                          std::numeric_limits<long long>::max());
    mass.set_space(conforming_->space());
    matrix().set_step({0., 0.});
    mass.prepare(matrix().assemble(nullptr));
    std::vector<double> momentum(x.size()), joined(x.size());
    DelassusOperator<dim>::apply(Operator::mass, x.data(), momentum.data());
    mass.solve(momentum.data(), joined.data(), tight);
    double size = 0., change = 0.;
    for (std::size_t k = 0; k < x.size(); ++k) {
      size = std::max(size, std::abs(x[k]));
      change = std::max(change, std::abs(joined[k] - x[k]));
    }
    // what has no jump but for round-off keeps its bits
    if (!(this->communicator_.max(change) >
          1e-12 * this->communicator_.max(size)))
      return false;
    x = std::move(joined);
    return true;
  }

  template <int dim>
  void JoinedBodies<dim>::reinit(const double time_step, const double theta)
  {
    if (time_step != this->time_step_ || theta != this->theta_ ||
        means_ == Means::factors_once) {
      valid_ = false;
      means_ = Means::unknown;
      tangent_.clear();
      jacobi_.clear();
    }
    // a step that was resumed has none of the step before: what is counted,
    // and with that when W is condensed, would differ
    last_.rows.clear();
    this->motion_->cancel();
    DelassusOperator<dim>::reinit(time_step, theta);
  }

  /** Factor M_hat if the step or the bonds have changed. */
  template <int dim>
  void JoinedBodies<dim>::update() const
  {
    if (valid_)
      return;
    const Charge charge(Cost::preconditioner);
    if (means() == Means::iterations) {
      jacobi_.clear();
      jacobi_.prepare(matrix(), nullptr);
      factor_.iterate_with(
          [this](const std::vector<double> &x, std::vector<double> &y) {
            matrix().set_step(this->shares(this->time_step_, this->theta_));
            matrix().apply_step(nullptr, x, y);
          },
          [this](const std::vector<double> &r, std::vector<double> &z) {
            jacobi_.apply(r, z);
          });
    } else {
      if (means() != Means::substructures)
        factor_.prepare(assemble({}));
      else if (!substructures_.factor(
                   this->shares(this->time_step_, this->theta_),
                   conforming_->space(), matrix(), nullptr, true, factor_))
        throw std::runtime_error("the matrix of the joined bodies is not "
                                 "positive definite to machine precision, or "
                                 "too large for the memory");
      ++this->counters_.global_factorisations;
    }
    valid_ = true;
    n_solves_ = 0;
    last_.rows.clear();
    condensed_.clear();
  }

  /** From rows_ to columns_. */
  template <int dim>
  krylov::Outcome JoinedBodies<dim>::solve(ConformingSolver &solver,
                                           const Goal &goal) const
  {
    const bool rests = std::all_of(rows_.begin(), rows_.end(),
                                   [](const double r) { return r == 0.; });
    if (!this->communicator_.any(!rests)) {
      columns_.assign(rows_.size(), 0.);
      return {0, true};
    }
    const auto outcome = solver.solve_own(rows_, columns_, goal);
    this->counters_.inner_iterations += outcome.iterations;
    ++this->counters_.global_solves;
    return outcome;
  }

  /** M_hat^{-1} of rows_; a step asks twice for that of its impulses. */
  template <int dim>
  void JoinedBodies<dim>::answer(const double tolerance) const
  {
    update();
    if (!this->communicator_.any(rows_ != last_.rows)) {
      columns_ = last_.columns;
      return;
    }
    ++n_solves_;
    if (!solve(factor_, tolerance).converged && means() == Means::iterations) {
      means_ = Means::factors_once;
      valid_ = false;
      return answer(tolerance);
    }
    if (tolerance > tight)
      last_.rows.clear();
    else
      last_ = {rows_, columns_};
  }

  template <int dim>
  void JoinedBodies<dim>::apply(const Operator op, const double *x,
                                double *y) const
  {
    if (op == Operator::inverse) {
      update();
      ++n_solves_;
      const auto outcome = factor_.solve(x, y, tight);
      this->counters_.inner_iterations += outcome.iterations;
      ++this->counters_.global_solves;
      if (outcome.converged || means() != Means::iterations)
        return;
      means_ = Means::factors_once;
      valid_ = false;
      return apply(op, x, y);
    }
    take(representative_, x, rows_);
    matrix().apply(op, rows_, columns_);
    spread(representative_, columns_, this->bodies_.n_dofs(), y);
  }

  template <int dim>
  std::vector<char> JoinedBodies<dim>::parting() const
  {
    std::vector<char> result(this->points_.n_points, 0);
    for (const std::size_t i : matrix().parting_points())
      result[i] = 1;
    return result;
  }

  template <int dim>
  void JoinedBodies<dim>::jumps(const double *velocity, double *result) const
  {
    take(representative_, velocity, rows_);
    matrix().velocity(rows_, result);
  }

  template <int dim>
  void JoinedBodies<dim>::apply_delassus(const double *impulse,
                                         double *velocity) const
  {
    const Charge charge(Cost::delassus);
    ++this->counters_.delassus;
    if (condense()) {
      condensed_.apply(impulse, velocity);
      return;
    }
    matrix().impulse(impulse, rows_);
    answer();
    matrix().velocity(columns_, velocity);
  }

  /** U = H x of the answer x to H^T P. */
  template <int dim>
  bool JoinedBodies<dim>::respond(ConformingSolver &solver,
                                  const double *impulse, double *velocity,
                                  const double tolerance) const
  {
    matrix().impulse(impulse, rows_);
    const bool solved = solve(solver, tolerance).converged;
    matrix().velocity(columns_, velocity);
    return solved;
  }

  template <int dim>
  void JoinedBodies<dim>::add_velocity_change(const double *impulse,
                                              double *velocity) const
  {
    matrix().impulse(impulse, rows_);
    answer();
    factor_.add(columns_, velocity);
  }

  /**
   * W of the rows as a dense matrix, on one rank: once as many systems have
   * been solved as its columns cost, and if it fits.
   */
  template <int dim>
  bool JoinedBodies<dim>::condense() const
  {
    if (this->communicator_.size() > 1)
      return false;
    update();
    if (!condensed_.empty())
      return true;
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < this->bonded_.size() * dim; ++k)
      if (!this->bonded_[k / dim])
        rows.push_back(k);
    // Many columns at once cost a quarter of as many single ones; a product
    // by the factor reads it twice.
    const double by_factor =
        2. * factor_.n_factor_entries() + 10. * double(rows.size());
    if (rows.empty() || rows.size() > CondensedDelassus::largest ||
        ((rows.size() > 64 || means() == Means::iterations) &&
         (4 * n_solves_ < rows.size() ||
          double(rows.size()) * double(rows.size()) > by_factor)))
      return false;
    const std::size_t n = this->bodies_.n_dofs(), m = rows.size();
    constexpr std::size_t batch = 64; // columns fill the caches
    std::vector<double> B(n * batch), X(n * batch),
        impulse(this->bonded_.size() * dim, 0.), velocity(impulse.size());
    condensed_.reset(impulse.size(), rows);
    for (std::size_t first = 0; first < m; first += batch) {
      const std::size_t count = std::min(batch, m - first);
      for (std::size_t c = 0; c < count; ++c) {
        impulse[rows[first + c]] = 1.;
        this->generalised_impulse(impulse.data(), &B[c * n]);
        impulse[rows[first + c]] = 0.;
      }
      factor_.solve_columns(B.data(), X.data(), n, count, tight);
      for (std::size_t c = 0; c < count; ++c) {
        this->relative_velocity(&X[c * n], velocity.data());
        condensed_.set_column(first + c, velocity.data());
      }
    }
    this->counters_.global_solves += m;
    return true;
  }

  /**
   * Factors are made again; whether W was condensed depends on how many
   * systems had been solved, and how good an old factor is on its springs.
   */
  template <int dim>
  void JoinedBodies<dim>::serialize(Archive &archive)
  {
    JoinedDelassus<dim>::serialize(archive);
    bool factored = valid_, condensed = !condensed_.empty(),
         general = tangent_.is_general();
    auto means = unsigned(means_);
    std::size_t n_solves = n_solves_;
    archive.numbers("bodies", factored, condensed, general, means, n_solves);
    archive.points("tangents", tangent_.springs());
    auto wear = tangent_.wear();
    if (tangent_.has_cycles())
      archive.numbers("cycles", wear.least, wear.excess);
    if (!archive.reads())
      return;
    valid_ = false;
    means_ = Means(means);
    condensed_.clear();
    if (factored)
      update();
    if (condensed) {
      n_solves_ = CondensedDelassus::largest; // enough for any
      condense();
    }
    if (!tangent_.springs().empty())
      factor_tangent(std::vector<double>(tangent_.springs()), general);
    tangent_.wear() = wear;
    n_solves_ = n_solves;
  }

  template class JoinedBodies<2>;
  template class JoinedBodies<3>;
} // namespace nsfd
