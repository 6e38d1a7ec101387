#include "substructures.h"

#include "core/gather.h"

#include <cmath>
#include <utility>

namespace nsfd
{
  template <int dim>
  FinestSpace<dim>::FinestSpace(const DelassusOperator<dim> &delassus,
                                const long long first_dof, FixedFaces faces)
      : delassus_(delassus), first_dof_(first_dof), faces_(std::move(faces))
  {
  }

  template <int dim>
  bool FinestSpace<dim>::may_pay(const long long unknowns) const
  {
    const auto &points = delassus_.points();
    unsigned long long seeing = 0;
    for (std::size_t f = 0; f < points.faces.size(); ++f)
      if (!faces_.joined[f] && !faces_.supports[f])
        seeing += points.faces[f].count;
    // a node of a plane is seen by four points, or by two in two dimensions
    return double(delassus_.communicator().sum_integer(seeing)) * dim <
           0.5 * double(unknowns);
  }

  template <int dim>
  void FinestSpace<dim>::find(ConformingSpace &nodes,
                              const std::vector<char> &joined)
  {
    is_known_ = true;
    if (!may_pay(nodes.space().n_global))
      return;
    joined_ = faces_.joined;
    for (std::size_t f = 0; f < joined_.size(); ++f)
      joined_[f] = joined_[f] && joined[f];
    nodes.conform(joined_);
    space_ = nodes.space();
    nodes.conform(joined);
    JoinedMatrix<dim> matrix(delassus_, first_dof_);
    matrix.set_space(space_, joined_);
    set_border(matrix);
  }

  /** What points see that are not of supports; @p matrix is that of the
      space. */
  template <int dim>
  void FinestSpace<dim>::set_border(const JoinedMatrix<dim> &matrix)
  {
    auto &values = matrix.shared_.values;
    std::fill(values.begin(), values.end(), 0.);
    const auto &sights = matrix.sights_;
    for (const std::size_t i : sights.points)
      for (std::size_t k = sights.first[i];
           !is_support(i) && k < sights.first[i + 1]; ++k)
        std::fill_n(values.begin() +
                        long(sights.entries[k].block) * matrix.size_,
                    matrix.size_, 1.);
    std::vector<double> own;
    matrix.return_ghosts(own);
    border_.clear();
    unsigned long long count = 0;
    for (const double seen : own) {
      border_.push_back(seen > 0.);
      count += seen > 0.;
    }
    count = delassus_.communicator().sum_integer(count);
    pays_ = count <= largest && double(count) < 0.2 * double(space_.n_global);
  }

  template <int dim>
  SparseRows FinestSpace<dim>::assemble(const StepShares &shares,
                                        const double *supports) const
  {
    JoinedMatrix<dim> matrix(delassus_, first_dof_);
    matrix.set_space(space_, joined_);
    matrix.set_step(shares);
    return matrix.assemble(supports);
  }

  namespace
  {
    /** But for the last digits. */
    bool same(const std::vector<double> &a, const std::vector<double> &b)
    {
      constexpr double round_off = 1e-14;
      return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                        [](const double x, const double y) {
                          return std::abs(x - y) <= round_off * std::abs(x);
                        });
    }
  } // namespace

  template <int dim>
  Substructures<dim>::Substructures(const FinestSpace<dim> &finest)
      : finest_(finest), dissection_(finest.delassus().communicator())
  {
  }

  template <int dim>
  bool Substructures<dim>::eliminate(const StepShares &shares,
                                     const double *springs)
  {
    constexpr std::size_t n = std::size_t(dim) * dim;
    const auto &points = finest_.delassus().points();
    const auto &communicator = finest_.delassus().communicator();
    std::vector<double> here;
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (springs && finest_.is_support(i))
        here.insert(here.end(), springs + i * n, springs + (i + 1) * n);
    if (!communicator.any(shares.stiffness != shares_.stiffness ||
                          shares.damping != shares_.damping ||
                          !same(here, of_supports_)))
      return true;
    std::vector<double> all;
    if (springs) {
      all.assign(points.n_points * n, 0.);
      for (std::size_t i = 0; i < points.n_points; ++i)
        if (finest_.is_support(i))
          std::copy_n(springs + i * n, n, &all[i * n]);
    }
    shares_ = {-1.};
    matrix_ = nullptr;
    const SparseRows rows =
        finest_.assemble(shares, springs ? all.data() : nullptr);
    if ((!is_analysed_ && !dissection_.analyse(rows, finest_.border())) ||
        !dissection_.eliminate(rows) || !eliminate_between_ranks())
      return false;
    is_analysed_ = true;
    shares_ = shares;
    of_supports_ = std::move(here);
    return true;
  }

  /** S from what the ranks have left. */
  template <int dim>
  bool Substructures<dim>::eliminate_between_ranks()
  {
    const auto &communicator = finest_.delassus().communicator();
    const auto &border = finest_.border();
    std::vector<char> seen;
    for (std::size_t k = 0; k < border.size(); ++k)
      if (dissection_.number()[k] >= 0)
        seen.push_back(border[k]);
    seen = gather_all(communicator, seen);
    const std::size_t n = seen.size();
    std::vector<double> all(n * n, 0.);
    dissection_.for_terms([&](const int r, const int c, const double value) {
      all[std::size_t(c) * n + std::size_t(r)] += value;
    });
    dissection_.forget_terms();
    return !communicator.any(!outer_.eliminate(std::move(all), seen, split_));
  }

  template <int dim>
  void Substructures<dim>::set_space(const CoarseSpace &space,
                                     const JoinedMatrix<dim> &matrix)
  {
    if (matrix_)
      return;
    matrix_ = &matrix;
    factor_.clear();
    // own unknowns of the finest space in the present one
    const CoarseSpace &finest = finest_.space();
    std::vector<long long> name(std::size_t(finest.n_own), -1);
    for (std::size_t i = 0; i < finest.number.size(); ++i) {
      const long long k = finest.number[i] - finest.first;
      if (k >= 0 && k < finest.n_own)
        name[std::size_t(k)] = space.number[i];
    }
    Dissection::Places places;
    std::vector<long long> common;
    for (std::size_t k = 0; k < name.size(); ++k)
      if (dissection_.number()[k] < 0)
        places.inner.push_back(int(name[k] - space.first));
      else
        common.push_back(name[k]);
    common = gather_all(finest_.delassus().communicator(), common);
    std::vector<long long> merged;
    for (const int k : outer_.kept())
      merged.push_back(common[std::size_t(k)]);
    std::sort(merged.begin(), merged.end());
    merged.erase(std::unique(merged.begin(), merged.end()), merged.end());
    const auto place = [&](const long long of) {
      const auto found = std::lower_bound(merged.begin(), merged.end(), of);
      return found != merged.end() && *found == of ? int(found - merged.begin())
                                                   : -1;
    };
    merged_.clear();
    for (const int k : outer_.kept())
      merged_.push_back(place(common[std::size_t(k)]));
    n_border_ = int(merged.size());
    // a vector has what is one in the space once: with the first of its parts
    std::vector<char> is_there(merged.size(), 0);
    for (std::size_t k = 0; k < common.size(); ++k) {
      const int one = place(common[k]);
      if (common[k] >= space.first && common[k] < space.first + space.n_own &&
          (one < 0 || !is_there[std::size_t(one)]))
        places.own.emplace_back(int(k), int(common[k] - space.first));
      if (one >= 0)
        is_there[std::size_t(one)] = 1;
    }
    place_.clear();
    const long long size = matrix.size_;
    for (int b = 0; b < matrix.n_own_; ++b)
      place_.push_back(place(space.first + b * size));
    for (const long long block : matrix.ghosts_)
      place_.push_back(place(block * size));
    dissection_.set_places(std::move(places));
  }

  /** S in the present space: lower triangle, or with the upper one. */
  template <int dim>
  std::vector<double> Substructures<dim>::condensed(const bool symmetric) const
  {
    const auto n = std::size_t(n_border());
    const std::size_t n_split = merged_.size();
    std::vector<double> A(n * n, 0.);
    for (std::size_t c = 0; c < n_split; ++c)
      for (std::size_t r = c; r < n_split; ++r) {
        const auto row = std::size_t(merged_[r]),
                   column = std::size_t(merged_[c]);
        const double value = split_[c * n_split + r];
        // an entry off the diagonal stands for two, which may meet on it
        A[std::min(row, column) * n + std::max(row, column)] +=
            row == column && r != c ? 2. * value : value;
      }
    if (!symmetric)
      for (std::size_t c = 1; c < n; ++c)
        for (std::size_t r = 0; r < c; ++r)
          A[c * n + r] = A[r * n + c];
    return A;
  }

  /** To the dense matrix @p A what points of this rank add. */
  template <int dim>
  void Substructures<dim>::add_springs(const double *springs,
                                       std::vector<double> &A) const
  {
    const auto n = std::size_t(n_border());
    const unsigned int size = matrix_->size_;
    for (const std::size_t i : matrix_->sights_.points)
      if (!finest_.is_support(i))
        matrix_->sights_.for_spring(
            i, springs + i * dim * dim, size,
            [&](const auto &row, const auto &column, const double *product) {
              const auto r = std::size_t(place_[std::size_t(row.block)]),
                         c = std::size_t(place_[std::size_t(column.block)]);
              for (unsigned int d = 0; d < dim; ++d)
                for (unsigned int k = 0; k < size; ++k)
                  for (unsigned int l = 0; l < size; ++l)
                    A[(c + l) * n + r + k] +=
                        row.own[d * size + k] * product[d * size + l];
            });
  }

  template <int dim>
  bool Substructures<dim>::factorise(const double *springs,
                                     const bool symmetric)
  {
    const auto &communicator = finest_.delassus().communicator();
    const auto n = std::size_t(n_border());
    std::vector<double> A = condensed(symmetric);
    if (springs && communicator.size() == 1)
      add_springs(springs, A);
    else if (springs) {
      std::vector<double> sums(A.size(), 0.);
      add_springs(springs, sums);
      MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE,
                    MPI_SUM, communicator.mpi());
      for (std::size_t k = 0; k < A.size(); ++k)
        A[k] += sums[k];
    }
    return !communicator.any(
        !factor_.factorise(std::move(A), int(n), symmetric));
  }

  template <int dim>
  void Substructures<dim>::solve(const double *b, double *x)
  {
    dissection_.forward(b, right_);
    outer_.forward(right_, kept_);
    right_.assign(std::size_t(n_border_), 0.);
    for (std::size_t k = 0; k < kept_.size(); ++k)
      right_[std::size_t(merged_[k])] += kept_[k];
    factor_.solve(right_.data());
    for (std::size_t k = 0; k < kept_.size(); ++k)
      kept_[k] = right_[std::size_t(merged_[k])];
    outer_.backward(kept_, solution_);
    dissection_.backward(solution_, x);
  }

  template <int dim>
  bool Substructures<dim>::factor(const StepShares &shares,
                                  const CoarseSpace &space,
                                  const JoinedMatrix<dim> &matrix,
                                  const double *springs, const bool symmetric,
                                  ConformingSolver &solver)
  {
    if (!eliminate(shares, springs))
      return false;
    set_space(space, matrix);
    if (!factorise(springs, symmetric))
      return false;
    solver.solve_with([this](const double *b, double *x) { solve(b, x); },
                      !symmetric, n_entries());
    return true;
  }

  template class FinestSpace<2>;
  template class FinestSpace<3>;
  template class Substructures<2>;
  template class Substructures<3>;
} // namespace nsfd
