#include "block_problem.h"

#include "contact_cone.h"
#include "nonsmooth/natural_map.h"

namespace nsfd::stored
{
  namespace
  {
    /** Columns of the blocks of one row of contacts, the diagonal one too. */
    template <int d>
    void find_blocks(const ContactProblem &stored, const int i,
                     std::vector<int> &mark, std::vector<int> &column)
    {
      const std::size_t first = column.size();
      const auto add = [&](const int j) {
        if (mark[j] != i) {
          mark[j] = i;
          column.push_back(j);
        }
      };
      add(i);
      for (int k = stored.row_start[d * i]; k < stored.row_start[d * (i + 1)];
           ++k)
        add(stored.column[k] / d);
      std::sort(column.begin() + first, column.end());
    }

    double mean_diagonal(const ContactProblem &stored)
    {
      double sum = 0., largest = 0.;
      for (std::size_t i = 0; i < stored.n_rows(); ++i)
        for (int k = stored.row_start[i]; k < stored.row_start[i + 1]; ++k) {
          largest = std::max(largest, std::abs(stored.value[k]));
          if (stored.column[k] == int(i))
            sum += stored.value[k];
        }
      const double mean = sum / std::max<std::size_t>(stored.n_rows(), 1);
      return mean > 0. ? mean : largest > 0. ? largest : 1.;
    }
  } // namespace

  template <int d>
  BlockProblem<d>::BlockProblem(const ContactProblem &stored)
      : n(int(stored.n_contacts())), q(stored.q), mu(stored.friction)
  {
    const double w = mean_diagonal(stored);
    double s = 0.;
    for (const double value : q)
      s = std::max(s, std::abs(value));
    if (s == 0.)
      s = 1.;
    unit = 1. / w;
    impulse_unit = s / w;
    for (double &value : q) {
      value /= s;
      q_norm += value * value;
    }
    q_norm = std::sqrt(q_norm);

    start.reserve(n + 1);
    start.push_back(0);
    std::vector<int> mark(n, -1), place(n);
    column.reserve(stored.value.size() / area + n);
    block.reserve(stored.value.size() + std::size_t(area) * n);
    for (int i = 0; i < n; ++i) {
      find_blocks<d>(stored, i, mark, column);
      block.resize(area * column.size());
      for (std::size_t b = start[i]; b < column.size(); ++b) {
        place[column[b]] = int(b);
        if (column[b] == i)
          diagonal.push_back(int(b));
      }
      for (int c = 0; c < d; ++c) {
        const int row = d * i + c;
        for (int k = stored.row_start[row]; k < stored.row_start[row + 1];
             ++k) {
          const int j = stored.column[k];
          block[std::size_t(area) * place[j / d] + d * c + j % d] =
              stored.value[k] / w;
        }
      }
      start.push_back(int(column.size()));
    }
  }

  template <int d>
  void BlockProblem<d>::multiply(const double *x, double *y) const
  {
    const double *a = block.data();
    for (int i = 0; i < n; ++i) {
      double sum[d] = {};
      for (int k = start[i]; k < start[i + 1]; ++k, a += area) {
        const double *v = x + d * column[k];
        for (int c = 0; c < d; ++c)
          for (int e = 0; e < d; ++e)
            sum[c] += a[d * c + e] * v[e];
      }
      for (int c = 0; c < d; ++c)
        y[d * i + c] = sum[c];
    }
  }

  template <int d>
  void BlockProblem<d>::velocity(const double *r, double *u) const
  {
    multiply(r, u);
    for (std::size_t i = 0; i < q.size(); ++i)
      u[i] += q[i];
  }

  template <int d>
  double BlockProblem<d>::error(const double *r, const double *u) const
  {
    double sum = 0., impulses = 0., velocities = 0.;
    for (int i = 0; i < n; ++i) {
      double scaled[d];
      for (int c = 0; c < d; ++c) {
        scaled[c] = unit * r[d * i + c];
        impulses += scaled[c] * scaled[c];
        velocities += u[d * i + c] * u[d * i + c];
      }
      sum += squared_natural_map<d>(scaled, u + d * i, mu[i]);
    }
    const double scale =
        std::max({q_norm, std::sqrt(impulses), std::sqrt(velocities)});
    return relative_natural_map(std::sqrt(sum), scale > 0. ? scale : 1.);
  }

  template struct BlockProblem<2>;
  template struct BlockProblem<3>;
} // namespace nsfd::stored
