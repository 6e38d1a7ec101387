#include "body_matrix.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    template <typename Neighbor>
    bool comes_before(const Neighbor &a, const Neighbor &b)
    {
      return a.elsewhere != b.elsewhere ? b.elsewhere : a.first < b.first;
    }
  } // namespace

  template <int dim>
  BodyMatrix<dim>::BodyMatrix(const Bodies &bodies,
                              const InterfacePoints<dim> &points,
                              std::array<std::vector<PointTrace>, 2> traces,
                              std::vector<Bond> bonds,
                              const long long first_dof)
      : bodies_(bodies), points_(points), traces_(std::move(traces)),
        bonds_(std::move(bonds)), first_dof_(first_dof),
        neighbors_(bodies.size())
  {
    matrix_.first_row = first_dof;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      neighbors_[b].push_back(
          neighbor(first_dof + static_cast<long long>(bodies.first_dof[b]),
                   unsigned(bodies.first_dof[b + 1] - bodies.first_dof[b])));
    for (const auto &face : points.faces)
      for (unsigned int s = 0; s < 2; ++s) {
        const PointTrace &other = traces_[1 - s][face.first];
        if (face.bodies[s] >= 0 && other.first >= 0)
          neighbors_[face.bodies[s]].push_back(
              neighbor(other.first, other.n_dofs));
      }
    for (auto &list : neighbors_) {
      std::sort(list.begin(), list.end(), comes_before<Neighbor>);
      list.erase(std::unique(list.begin(), list.end(),
                             [](const auto &a, const auto &c) {
                               return a.first == c.first;
                             }),
                 list.end());
    }
    number_ghosts();
    build_pattern();
  }

  template <int dim>
  typename BodyMatrix<dim>::Neighbor
  BodyMatrix<dim>::neighbor(const long long first,
                            const unsigned int n_dofs) const
  {
    const bool here =
        first >= first_dof_ &&
        first < first_dof_ + static_cast<long long>(bodies_.n_dofs());
    return {!here, first, n_dofs, 0};
  }

  template <int dim>
  void BodyMatrix<dim>::number_ghosts()
  {
    for (const auto &list : neighbors_)
      for (const auto &neighbor : list)
        if (neighbor.elsewhere)
          for (unsigned int j = 0; j < neighbor.n_dofs; ++j)
            matrix_.ghosts.push_back(neighbor.first + j);
    auto &ghosts = matrix_.ghosts;
    std::sort(ghosts.begin(), ghosts.end());
    ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
  }

  template <int dim>
  void BodyMatrix<dim>::build_pattern()
  {
    const auto &ghosts = matrix_.ghosts;
    matrix_.start = {0};
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      unsigned int width = 0;
      for (auto &neighbor : neighbors_[b]) {
        neighbor.offset = width;
        width += neighbor.n_dofs;
      }
      for (std::size_t i = bodies_.first_dof[b]; i < bodies_.first_dof[b + 1];
           ++i) {
        for (const auto &neighbor : neighbors_[b]) {
          const long long first =
              neighbor.elsewhere
                  ? static_cast<long long>(bodies_.n_dofs()) +
                        (std::lower_bound(ghosts.begin(), ghosts.end(),
                                          neighbor.first) -
                         ghosts.begin())
                  : neighbor.first - first_dof_;
          for (unsigned int j = 0; j < neighbor.n_dofs; ++j)
            matrix_.column.push_back(int(first + j));
        }
        matrix_.start.push_back(int(matrix_.column.size()));
      }
    }
    matrix_.value.resize(matrix_.column.size());
  }

  /** First entry of the columns from @p first on in the first row of a body. */
  template <int dim>
  double *BodyMatrix<dim>::block(const unsigned int body, const long long first,
                                 std::size_t &stride)
  {
    const auto &list = neighbors_[body];
    const auto found = std::lower_bound(
        list.begin(), list.end(), neighbor(first, 0), comes_before<Neighbor>);
    const std::size_t row = bodies_.first_dof[body];
    stride = std::size_t(matrix_.start[row + 1] - matrix_.start[row]);
    return &matrix_.value[std::size_t(matrix_.start[row]) + found->offset];
  }

  /** A row of f t + g t_v of a side. */
  template <int dim>
  const double *BodyMatrix<dim>::step_traction(const PointTrace &trace,
                                               const unsigned int component,
                                               const StepShares &shares,
                                               std::vector<double> &work) const
  {
    const unsigned int n = trace.n_dofs;
    work.resize(n);
    for (unsigned int j = 0; j < n; ++j)
      work[j] = shares.stiffness * trace.traction[component * n + j];
    if (!trace.viscous_traction.empty())
      for (unsigned int j = 0; j < n; ++j)
        work[j] += shares.damping * trace.viscous_traction[component * n + j];
    return work.data();
  }

  template <int dim>
  void BodyMatrix<dim>::add_face(
      const typename InterfacePoints<dim>::Face &face, const unsigned int s,
      const unsigned int t, const StepShares &shares,
      const std::vector<std::uint8_t> &bonded, const double *stiffness)
  {
    if (face.bodies[s] < 0 || traces_[t][face.first].first < 0)
      return;
    std::size_t stride;
    double *out =
        block(unsigned(face.bodies[s]), traces_[t][face.first].first, stride);
    std::vector<double> row_traction, column_traction;
    for (unsigned int p = face.first; p < face.first + face.count; ++p) {
      const PointTrace &row = traces_[s][p], &column = traces_[t][p];
      const unsigned int n = row.n_dofs, m = column.n_dofs;
      for (unsigned int k = 0; k < dim; ++k) {
        // a' (alpha a + beta t) + t' (beta a) with the rows of either side
        double alpha = stiffness ? stiffness[p * dim + k] : 0.;
        double row_beta = 0., column_beta = 0.;
        if (bonded[p]) {
          const double f = points_.weight[p];
          const auto omega = [&](const unsigned int side) {
            return side == 0 ? bonds_[p].weight_1 : bonds_[p].weight_2;
          };
          alpha += f * (shares.stiffness * bonds_[p].penalty +
                        shares.damping * bonds_[p].viscous_penalty);
          row_beta = f * omega(s);
          column_beta = f * omega(t);
        }
        if (alpha == 0.)
          continue;
        const double *a = &row.jump[k * n], *c = &column.jump[k * m];
        if (!bonded[p]) {
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int j = 0; j < m; ++j)
              out[i * stride + j] += alpha * a[i] * c[j];
          continue;
        }
        const double *u = step_traction(row, k, shares, row_traction),
                     *v = step_traction(column, k, shares, column_traction);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < m; ++j)
            out[i * stride + j] += a[i] * (alpha * c[j] + column_beta * v[j]) +
                                   row_beta * u[i] * c[j];
      }
    }
  }

  template <int dim>
  const SparseRows &
  BodyMatrix<dim>::assemble(const StepShares &shares,
                            const std::vector<std::uint8_t> &bonded,
                            const double *stiffness)
  {
    std::fill(matrix_.value.begin(), matrix_.value.end(), 0.);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const BodyClass &body = bodies_.classes[bodies_.class_of[b]];
      std::size_t stride;
      double *out = block(
          unsigned(b),
          first_dof_ + static_cast<long long>(bodies_.first_dof[b]), stride);
      for (unsigned int i = 0; i < body.n_dofs; ++i)
        for (unsigned int j = 0; j < body.n_dofs; ++j)
          out[i * stride + j] = step_entry(body, shares, i, j);
    }
    for (const auto &face : points_.faces)
      for (unsigned int s = 0; s < 2; ++s)
        for (unsigned int t = 0; t < 2; ++t)
          add_face(face, s, t, shares, bonded, stiffness);
    return matrix_;
  }

  template class BodyMatrix<2>;
  template class BodyMatrix<3>;
} // namespace nsfd
