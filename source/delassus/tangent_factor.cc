#include "tangent_factor.h"

#include "core/cost.h"
#include "core/pages_of_zeros.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Most of them are none. */
    void keep(const std::vector<double> &springs, std::vector<double> &kept)
    {
      kept = springs;
      release_pages_of_zeros(kept);
    }
  } // namespace

  template <int dim>
  void TangentFactor<dim>::set_space(const CoarseSpace &space)
  {
    space_ = &space;
    solver_.set_space(space);
    substructures_.space_changed();
    clear();
  }

  template <int dim>
  auto TangentFactor<dim>::fit(const JoinedMatrix<dim> &matrix,
                               const std::vector<double> &springs,
                               const unsigned int few) const -> Fit
  {
    // measured on a bar of hexes and a plate of grains that break
    constexpr double same = 0.8, soft = 0.3;
    // in one sum: how many points have changed, ranks have others, or no factor
    constexpr unsigned int bits = 16;
    constexpr unsigned long long other = 1ull << 32, missing = other << bits;
    const bool made = springs.size() == springs_.size();
    unsigned long long changed = 0;
    bool differ = !made;
    for (const std::size_t i : matrix.parting_points()) {
      if (!made)
        break;
      const std::size_t first = i * dim * dim;
      double size = 0., change = 0.;
      for (std::size_t k = first; k < first + dim * dim; ++k) {
        size = std::max({size, std::abs(springs[k]), std::abs(springs_[k])});
        change = std::max(change, std::abs(springs[k] - springs_[k]));
        differ = differ || springs[k] != springs_[k];
      }
      // beside what the bodies themselves resist with
      const double W = *delassus_.point_block(i);
      changed += change > same * size && change * W > soft;
    }
    const auto all = communicator_.sum_integer(changed + (differ ? other : 0) +
                                               (made ? 0 : missing));
    return all == 0                    ? Fit::exact
           : all >= missing            ? Fit::none
           : (all & (other - 1)) > few ? Fit::none
                                       : Fit::close;
  }

  template <int dim>
  bool TangentFactor<dim>::factor(const SparseRows &matrix,
                                  const std::vector<double> &springs)
  {
    clear();
    if (!solver_.try_to_prepare(matrix))
      return false;
    keep(springs, springs_);
    return true;
  }

  template <int dim>
  bool TangentFactor<dim>::factor_border(const JoinedMatrix<dim> &matrix,
                                         const StepShares &shares,
                                         const std::vector<double> &springs,
                                         const bool general)
  {
    clear();
    if (!substructures_.factor(shares, *space_, matrix, springs.data(),
                               !general, solver_))
      return false;
    keep(springs, springs_);
    is_general_ = general;
    return true;
  }

  template <int dim>
  bool TangentFactor<dim>::precondition(const JoinedMatrix<dim> &matrix,
                                        const std::vector<double> &springs,
                                        const bool general)
  {
    is_general_ = false;
    if (!jacobi_.prepare(matrix, &springs, general)) {
      springs_.clear();
      return false;
    }
    copy_of_points<dim * dim>(matrix.parting_points(), springs, springs_);
    copy_of_points<dim * dim>(matrix.parting_points(), springs, present_);
    is_general_ = general;
    solver_.iterate_with(
        [this, &matrix](const std::vector<double> &x, std::vector<double> &y) {
          matrix.apply_step(present_.data(), x, y);
        },
        [this](const std::vector<double> &r, std::vector<double> &z) {
          jacobi_.apply(r, z);
        },
        general);
    return true;
  }

  template <int dim>
  bool
  TangentFactor<dim>::precondition_by_cycles(JoinedMatrix<dim> &matrix,
                                             const std::vector<double> &springs)
  {
    clear();
    if (!cycles_.prepare(matrix, springs))
      return false;
    keep(springs, springs_);
    keep(springs, present_);
    wear_ = Wear();
    solver_.iterate_with(
        [this](const std::vector<double> &x, std::vector<double> &y) {
          cycles_.multiply(x, y);
        },
        [this](const std::vector<double> &r, std::vector<double> &z) {
          cycles_.apply(r, z);
        });
    return true;
  }

  template <int dim>
  bool TangentFactor<dim>::adjust_cycles(const JoinedMatrix<dim> &matrix,
                                         const std::vector<double> &springs)
  {
    const bool fits = springs.size() == springs_.size() && wear_.excess < worth;
    if (communicator_.any(!fits))
      return false;
    if (!communicator_.any(springs != present_))
      return true;
    present_ = springs;
    const Charge charge(Cost::preconditioner);
    return cycles_.adjust(matrix, springs);
  }

  template <int dim>
  void TangentFactor<dim>::note(const unsigned int iterations,
                                const double reduction)
  {
    const double digits = std::max(1., -std::log10(reduction));
    const double rate = iterations / digits;
    wear_.least = wear_.least > 0. ? std::min(wear_.least, rate) : rate;
    wear_.excess += iterations - wear_.least * digits;
  }

  template <int dim>
  const std::vector<double> &TangentFactor<dim>::factored() const
  {
    static const std::vector<double> none;
    return solver_.has_factor() ? springs_ : none;
  }

  template class TangentFactor<2>;
  template class TangentFactor<3>;
} // namespace nsfd
