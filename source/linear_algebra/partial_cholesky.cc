#include "partial_cholesky.h"

#include "lapack.h"
#include "start_cholmod.h"

#include <algorithm>
#include <new>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    constexpr double one = 1., minus_one = -1., zero = 0.;
    constexpr int next = 1;

    struct Analysis {
      cholmod_common common;
      cholmod_factor *factor = nullptr;

      Analysis() { start_cholmod(common); }
      Analysis(const Analysis &) = delete;
      ~Analysis()
      {
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
      }

      /** Of a lower triangle by columns, in @p order or one that is found. */
      void run(std::vector<int> &start, std::vector<int> &row, int *order)
      {
        cholmod_sparse A{};
        A.nrow = A.ncol = start.size() - 1;
        A.nzmax = row.size();
        A.p = start.data();
        A.i = row.data();
        A.stype = -1;
        A.itype = CHOLMOD_INT;
        A.xtype = CHOLMOD_PATTERN;
        A.dtype = CHOLMOD_DOUBLE;
        A.sorted = A.packed = 1;
        cholmod_free_factor(&factor, &common);
        common.nmethods = order ? 1 : 0;
        common.method[0].ordering = CHOLMOD_GIVEN;
        factor = cholmod_analyze_p(&A, order, nullptr, 0, &common);
        if (!factor)
          throw std::bad_alloc();
      }
    };

    /** Lower triangle by columns of what is below @p n. */
    void take_lower(const SparseRows &rows, const int n,
                    std::vector<int> &start, std::vector<int> &row)
    {
      start.assign(1, 0);
      row.clear();
      for (int i = 0; i < rows.n_rows(); ++i) {
        for (int k = rows.start[i]; k < rows.start[i + 1]; ++k)
          if (rows.column[k] >= i && rows.column[k] < n)
            row.push_back(rows.column[k]);
        std::sort(row.begin() + start.back(), row.end());
        start.push_back(int(row.size()));
      }
    }
  } // namespace

  void PartialCholesky::analyse(const SparseRows &rows, const int n_boundary)
  {
    n_inner_ = rows.n_rows();
    n_boundary_ = n_boundary;
    const int n = n_inner_ + n_boundary;
    fronts_.clear();
    values_.clear();
    local_.assign(std::size_t(n), 0);
    unknown_.resize(std::size_t(n));
    place_.resize(std::size_t(n));
    if (n_inner_ == 0)
      return;
    Analysis analysis;
    std::vector<int> start, row;
    take_lower(rows, n, start, row);
    for (int k = n_inner_; k < n; ++k) {
      row.push_back(k);
      start.push_back(int(row.size()));
    }
    // an order of all, so that what is next to the boundary is not cut off from
    // it, but the boundary at its end
    analysis.run(start, row, nullptr);
    const int *all = static_cast<const int *>(analysis.factor->Perm);
    std::vector<int> order(all, all + n);
    std::stable_partition(order.begin(), order.end(),
                          [&](const int i) { return i < n_inner_; });
    analysis.run(start, row, order.data());
    const cholmod_factor &L = *analysis.factor;
    const int *permutation = static_cast<const int *>(L.Perm),
              *super = static_cast<const int *>(L.super),
              *pi = static_cast<const int *>(L.pi),
              *s = static_cast<const int *>(L.s);
    for (int k = 0; k < n; ++k) {
      unknown_[std::size_t(k)] = permutation[k];
      place_[std::size_t(permutation[k])] = k;
    }
    const auto of_boundary = [&](const int place) {
      return permutation[place] >= n_inner_;
    };
    std::vector<int> front_of(std::size_t(n), -1);
    std::size_t n_values = 0;
    for (std::size_t k = 0; k < L.nsuper; ++k) {
      Front front;
      front.first = super[k];
      while (front.first + front.n_columns < super[k + 1] &&
             !of_boundary(front.first + front.n_columns))
        front_of[std::size_t(front.first + front.n_columns++)] =
            int(fronts_.size());
      if (front.n_columns == 0)
        continue;
      front.rows.assign(s + pi[k], s + pi[k + 1]);
      // ancestors of the boundary are of the boundary
      front.n_inner = int(
          std::partition_point(front.rows.begin(), front.rows.end(),
                               [&](const int r) { return !of_boundary(r); }) -
          front.rows.begin());
      front.values = n_values;
      n_values += front.rows.size() * std::size_t(front.n_columns);
      fronts_.push_back(std::move(front));
    }
    for (Front &front : fronts_)
      if (front.n_columns < front.n_inner)
        front.parent =
            front_of[std::size_t(front.rows[std::size_t(front.n_columns)])];
    values_.resize(n_values);
    n_stack_ = 0;
    for_fronts([this](const Front &front, const std::size_t,
                      const std::size_t top, const auto &) {
      const auto n_outer = std::size_t(size(front) - front.n_inner);
      n_stack_ =
          std::max(n_stack_, top + update_size(front) + n_outer * n_outer);
    });
  }

  /** What the matrix has in the columns of @p front. */
  void PartialCholesky::assemble(const SparseRows &rows, const Front &front,
                                 double *L)
  {
    const int n = size(front);
    for (int r = 0; r < n; ++r)
      local_[std::size_t(front.rows[std::size_t(r)])] = r;
    std::fill_n(L, std::size_t(n) * std::size_t(front.n_columns), 0.);
    for (int c = 0; c < front.n_columns; ++c) {
      const int i = unknown_[std::size_t(front.first + c)];
      for (int k = rows.start[i]; k < rows.start[i + 1]; ++k) {
        const int place = place_[std::size_t(rows.column[k])];
        if (place >= front.first + c)
          L[std::size_t(c) * std::size_t(n) +
            std::size_t(local_[std::size_t(place)])] += rows.value[k];
      }
    }
  }

  /** Of @p update the columns that are not of the boundary. */
  void PartialCholesky::add_update(const Front &child, const double *update,
                                   const Front &front, double *L, double *left)
  {
    const int n = size(front), n_left = n - front.n_columns,
              m = size(child) - child.n_columns;
    const int *rows = child.rows.data() + child.n_columns;
    for (int c = 0; c < child.n_inner - child.n_columns; ++c) {
      const int column = local_[std::size_t(rows[c])];
      const double *from = update + std::size_t(c) * std::size_t(m);
      double *to = column < front.n_columns
                       ? L + std::size_t(column) * std::size_t(n)
                       : left +
                             std::size_t(column - front.n_columns) *
                                 std::size_t(n_left) -
                             front.n_columns;
      for (int r = c; r < m; ++r)
        to[local_[std::size_t(rows[r])]] += from[r];
    }
  }

  /** What @p front, with its factor @p L, leaves for the boundary. */
  void PartialCholesky::add_to_boundary(const Front &front, const double *L,
                                        double *part,
                                        std::vector<double> &boundary) const
  {
    const int n = size(front), k = front.n_columns, m = n - front.n_inner;
    dsyrk_("L", "N", &m, &k, &minus_one, L + front.n_inner, &n, &zero, part,
           &m);
    const auto place = [&](const int r) {
      return unknown_[std::size_t(front.rows[std::size_t(front.n_inner + r)])] -
             n_inner_;
    };
    for (int c = 0; c < m; ++c)
      for (int r = c; r < m; ++r) {
        const int row = place(r), column = place(c);
        boundary[std::size_t(std::min(row, column)) * std::size_t(n_boundary_) +
                 std::size_t(std::max(row, column))] +=
            part[std::size_t(c) * std::size_t(m) + std::size_t(r)];
      }
  }

  /** Entries of the update that the parent of @p front takes. */
  std::size_t PartialCholesky::update_size(const Front &front) const
  {
    return std::size_t(size(front) - front.n_columns) *
           std::size_t(front.n_inner - front.n_columns);
  }

  /**
   * Updates lie one on the other, and a parent finds those of its children on
   * top: the order of CHOLMOD is a postorder. @p visit (front, place of what
   * it leaves, those of its children).
   */
  template <typename Visit>
  void PartialCholesky::for_fronts(const Visit &visit) const
  {
    struct Update {
      int front;
      std::size_t begin;
    };
    std::vector<Update> stack, children;
    std::size_t top = 0;
    for (int f = 0; f < int(fronts_.size()); ++f) {
      const Front &front = fronts_[std::size_t(f)];
      children.clear();
      while (!stack.empty() &&
             fronts_[std::size_t(stack.back().front)].parent == f) {
        children.push_back(stack.back());
        stack.pop_back();
      }
      const std::size_t begin = children.empty() ? top : children.back().begin;
      visit(front, begin, top, children);
      top = begin;
      if (front.parent >= 0) {
        stack.push_back({f, begin});
        top += update_size(front);
      }
    }
    if (!stack.empty())
      throw std::logic_error("the order of elimination is no postorder");
  }

  bool PartialCholesky::factorise(const SparseRows &rows,
                                  std::vector<double> &boundary)
  {
    boundary.resize(std::size_t(n_boundary_) * std::size_t(n_boundary_), 0.);
    std::vector<double> stack(n_stack_);
    bool is_positive = true;
    for_fronts([&](const Front &front, const std::size_t begin,
                   const std::size_t top, const auto &children) {
      if (!is_positive)
        return;
      const int n = size(front), k = front.n_columns, n_left = n - k,
                n_inner = front.n_inner - k, n_outer = n_left - n_inner;
      double *L = &values_[front.values];
      double *left = stack.data() + top;
      const std::size_t n_update = update_size(front);
      const bool is_leaf = children.empty();
      if (!is_leaf)
        std::fill_n(left, n_update, 0.);
      assemble(rows, front, L);
      for (const auto &child : children)
        add_update(fronts_[std::size_t(child.front)],
                   stack.data() + child.begin, front, L, left);
      int info = 0;
      dpotrf_("L", &k, L, &n, &info);
      is_positive = info == 0;
      if (!is_positive || n_left == 0)
        return;
      dtrsm_("R", "L", "T", "N", &n_left, &k, &one, L, &n, L + k, &n);
      const double *of_children = is_leaf ? &zero : &one;
      if (n_inner > 0)
        dsyrk_("L", "N", &n_inner, &k, &minus_one, L + k, &n, of_children, left,
               &n_left);
      if (n_inner > 0 && n_outer > 0)
        dgemm_("N", "T", &n_outer, &n_inner, &k, &minus_one, L + front.n_inner,
               &n, L + k, &n, of_children, left + n_inner, &n_left);
      if (n_outer > 0)
        add_to_boundary(front, L, left + n_update, boundary);
      if (begin < top)
        std::copy_n(left, n_update, stack.data() + begin);
    });
    return is_positive;
  }

  void PartialCholesky::forward(std::vector<double> &x)
  {
    ordered_.assign(unknown_.size(), 0.);
    for (int i = 0; i < n_inner_; ++i)
      ordered_[std::size_t(place_[std::size_t(i)])] = x[std::size_t(i)];
    for (const Front &front : fronts_) {
      const int n = size(front), k = front.n_columns, n_left = n - k;
      const double *L = &values_[front.values];
      double *own = &ordered_[std::size_t(front.first)];
      dtrsv_("L", "N", "N", &k, L, &n, own, &next);
      if (n_left == 0)
        continue;
      part_.resize(std::size_t(n_left));
      dgemv_("N", &n_left, &k, &minus_one, L + k, &n, own, &next, &zero,
             part_.data(), &next);
      for (int r = 0; r < n_left; ++r)
        ordered_[std::size_t(front.rows[std::size_t(k + r)])] +=
            part_[std::size_t(r)];
    }
    for (std::size_t k = 0; k < unknown_.size(); ++k)
      x[std::size_t(unknown_[k])] = ordered_[k];
  }

  void PartialCholesky::backward(std::vector<double> &x)
  {
    for (std::size_t k = 0; k < unknown_.size(); ++k)
      ordered_[k] = x[std::size_t(unknown_[k])];
    for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
      const int n = size(*front), k = front->n_columns, n_left = n - k;
      const double *L = &values_[front->values];
      double *own = &ordered_[std::size_t(front->first)];
      if (n_left > 0) {
        part_.resize(std::size_t(n_left));
        for (int r = 0; r < n_left; ++r)
          part_[std::size_t(r)] =
              ordered_[std::size_t(front->rows[std::size_t(k + r)])];
        dgemv_("T", &n_left, &k, &minus_one, L + k, &n, part_.data(), &next,
               &one, own, &next);
      }
      dtrsv_("L", "T", "N", &k, L, &n, own, &next);
    }
    for (int i = 0; i < n_inner_; ++i)
      x[std::size_t(i)] = ordered_[std::size_t(place_[std::size_t(i)])];
  }
} // namespace nsfd
