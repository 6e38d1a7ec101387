#include "joined_delassus.h"

#include "joined_bodies.h"
#include "linear_algebra/factor_limits.h"

#include "core/cost.h"
#include "nsfd/core/archive.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** Preconditioned by the factor of A = M_hat + H^T D^-1 H (Woodbury). */
    template <int dim>
    class Bonded final : public JoinedBodies<dim>
    {
    public:
      Bonded(const Communicator &communicator, const Bodies &bodies,
             const InterfacePoints<dim> &points,
             const std::vector<double> &coordinates, FixedFaces faces,
             const long long largest_factor)
          : JoinedBodies<dim>(communicator, bodies, points, coordinates,
                              std::move(faces), largest_factor),
            joined_(communicator, largest_factor)
      {
        joined_.set_space(this->conforming_->space());
      }

      void reinit(double time_step, double theta) override;
      void prepare_preconditioner(const std::vector<double> &D) override;
      void precondition(const double *r, double *z) const override;
      void serialize(Archive &archive) override;

    private:
      void bonds_changed() override;
      double least_compliance(std::size_t row, double W) const;
      void set_diagonal();
      void prepare_joined();

      mutable ConformingSolver joined_; ///< of A
      bool joined_valid_ = false;
      /// the system was factored as a dense one: W may be condensed later,
      /// within the iterations of a system prepared without
      bool dense_system_ = false;
      std::vector<double> D_;         ///< of the system to precondition
      std::vector<double> inverse_D_; ///< of the one that was factored
      std::vector<double> diagonal_;  ///< of W, from above
      /// applications after which a new factor is cheaper than going on
      static constexpr unsigned int patience = 12;
      mutable unsigned int n_applied_ = 0; ///< since the last system
    };

    template <int dim>
    void Bonded<dim>::bonds_changed()
    {
      JoinedBodies<dim>::bonds_changed();
      joined_valid_ = false;
      joined_.set_space(this->conforming_->space());
    }

    template <int dim>
    void Bonded<dim>::reinit(const double time_step, const double theta)
    {
      if (time_step != this->time_step_ || theta != this->theta_)
        joined_valid_ = false;
      JoinedBodies<dim>::reinit(time_step, theta);
    }

    template <int dim>
    void Bonded<dim>::serialize(Archive &archive)
    {
      JoinedBodies<dim>::serialize(archive);
      bool joined = joined_valid_;
      unsigned int n_applied = n_applied_;
      archive.numbers("solver", joined, n_applied);
      archive.points("D", D_);
      archive.points("springs", inverse_D_);
      if (!archive.reads())
        return;
      joined_valid_ = false;
      if (joined) {
        set_diagonal();
        prepare_joined();
      }
      n_applied_ = n_applied;
    }

    template <int dim>
    double Bonded<dim>::least_compliance(const std::size_t row,
                                         const double W) const
    {
      return this->least_compliance_.empty() ? 1e-2 * W
                                             : this->least_compliance_[row];
    }

    template <int dim>
    void Bonded<dim>::prepare_preconditioner(const std::vector<double> &D)
    {
      const Charge charge(Cost::preconditioner);
      dense_system_ = this->condense() && this->condensed_.can_factor();
      if (dense_system_) {
        this->condensed_.factor(D);
        return;
      }
      // all ranks take the same way: a factor is made by all of them
      if (!this->communicator_.any(!joined_valid_ || D != D_))
        return;
      D_ = D;
      // an old factor is a good preconditioner until iterations say otherwise
      const unsigned int applied = std::exchange(n_applied_, 0);
      if (joined_valid_ && applied <= patience)
        return;
      set_diagonal();
      inverse_D_.assign(D.size(), 0.);
      for (std::size_t row = 0; row < D.size(); ++row)
        if (D[row] >= 0. && !this->bonded_[row / dim])
          inverse_D_[row] =
              1. / std::max(D[row], least_compliance(row, diagonal_[row]));
      prepare_joined();
    }

    template <int dim>
    void Bonded<dim>::set_diagonal()
    {
      diagonal_.assign(this->bonded_.size() * dim, 0.);
      for (std::size_t k = 0; k < diagonal_.size(); ++k)
        diagonal_[k] = this->point_block(k / dim)[k % dim * (dim + 1)];
    }

    template <int dim>
    void Bonded<dim>::prepare_joined()
    {
      std::vector<double> springs(inverse_D_.size() * dim, 0.);
      for (std::size_t k = 0; k < inverse_D_.size(); ++k)
        springs[k * dim + k % dim] = inverse_D_[k];
      joined_.prepare(this->assemble(springs));
      ++this->counters_.global_factorisations;
      joined_valid_ = true;
    }

    template <int dim>
    void Bonded<dim>::precondition(const double *r, double *z) const
    {
      const Charge charge(Cost::precondition);
      if (dense_system_) {
        this->condensed_.solve(r, z);
        return;
      }
      ++n_applied_;
      const std::size_t n = inverse_D_.size();
      std::vector<double> springs(n);
      for (std::size_t k = 0; k < n; ++k)
        springs[k] = D_[k] >= 0. ? inverse_D_[k] * r[k] : 0.;
      this->respond(joined_, springs.data(), z);
      // a principal part of the inverse where the factor knows the row, and the
      // bound of the diagonal where it does not: positive definite together
      for (std::size_t k = 0; k < n; ++k)
        if (D_[k] < 0.)
          z[k] = 0.;
        else if (inverse_D_[k] > 0.)
          z[k] = inverse_D_[k] * (r[k] - z[k]);
        else
          z[k] = r[k] / (diagonal_[k] + D_[k]);
    }
  } // namespace

  template <int dim>
  JoinedDelassus<dim>::JoinedDelassus(const Communicator &communicator,
                                      const Bodies &bodies,
                                      const InterfacePoints<dim> &points)
      : DelassusOperator<dim>(communicator, bodies, points),
        bonded_(points.n_points, 0), shares_nodes_(points.faces.size(), 0)
  {
  }

  template <int dim>
  bool JoinedDelassus<dim>::set_bonds(const std::vector<std::uint8_t> &bonded)
  {
    if (!this->communicator_.any(bonded != bonded_))
      return false;
    bonded_ = bonded;
    bonds_changed();
    return true;
  }

  template <int dim>
  void JoinedDelassus<dim>::serialize(Archive &archive)
  {
    DelassusOperator<dim>::serialize(archive);
    std::vector<std::uint8_t> bonded(bonded_);
    archive.points("bonded", bonded);
    if (archive.reads())
      set_bonds(bonded);
  }

  template <int dim>
  std::unique_ptr<JoinedDelassus<dim>>
  make_joined_delassus(const Communicator &communicator, const Bodies &bodies,
                       const InterfacePoints<dim> &points,
                       const std::string &solver,
                       const std::vector<double> &coordinates, FixedFaces faces)
  {
    constexpr long long any = std::numeric_limits<long long>::max();
    return std::make_unique<Bonded<dim>>(
        communicator, bodies, points, coordinates, std::move(faces),
        solver == "direct" ? any
        : solver == "cg"   ? 0
                           : largest_joined_factor<dim>);
  }

  template class JoinedDelassus<2>;
  template class JoinedDelassus<3>;
  template std::unique_ptr<JoinedDelassus<2>>
  make_joined_delassus<2>(const Communicator &, const Bodies &,
                          const InterfacePoints<2> &, const std::string &,
                          const std::vector<double> &, FixedFaces);
  template std::unique_ptr<JoinedDelassus<3>>
  make_joined_delassus<3>(const Communicator &, const Bodies &,
                          const InterfacePoints<3> &, const std::string &,
                          const std::vector<double> &, FixedFaces);
} // namespace nsfd
