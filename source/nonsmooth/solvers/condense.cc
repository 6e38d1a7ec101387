#include "condense.h"

#include "cohesive_laws/friction_weight.h"
#include "nonsmooth/springs.h"

#include <cmath>

extern "C" void dgesv_(const int *n, const int *columns, double *a,
                       const int *lda, int *pivots, double *b, const int *ldb,
                       int *info);

namespace nsfd
{
  namespace
  {
    /** A row that is eliminated: P_s = -(a + D U), or U given. */
    struct Row {
      std::size_t component;
      double compliance; ///< 1 / D; 0: U is given
      double rest;       ///< a / D, or -U_given
    };

    struct Parts {
      std::vector<std::size_t> contacts; ///< points
      std::vector<Row> rows;
    };

    /** Springs of a point, linear at its last velocity. */
    template <int dim>
    void add_springs(const OneStepProblem<dim> &problem, const std::size_t i,
                     const LocalSolution<dim> &solution, std::vector<Row> &rows)
    {
      const double wh = problem.weight[i] * problem.time_step;
      const Secant &secant = solution.frozen.secant;
      const auto normal = springs::normal_law<dim>(problem, i, secant.normal);
      const double U = solution.velocity[0], D = wh * normal.derivative(U);
      if (D > 0.)
        rows.push_back({i * dim, 1. / D, wh * normal.at(U) / D - U});
      const auto tangential =
          springs::tangential_spring<dim>(problem, secant.tangential);
      const double D_T = wh * tangential.stiffness * tangential.slope;
      for (unsigned int c = 1; c < dim && D_T > 0.; ++c)
        rows.push_back({i * dim + c, 1. / D_T,
                        springs::tangential_offset<dim>(problem, i, c) /
                            tangential.slope});
    }

    template <int dim>
    Parts split(const OneStepProblem<dim> &problem,
                const LawEvaluation<dim> &evaluation)
    {
      Parts parts;
      for (std::size_t i = 0; i < problem.n_points; ++i) {
        const auto &solution = evaluation.solutions[i];
        const bool given = problem.kind[i] == PointKind::prescribed;
        if (given || solution.frozen.is_rigid()) {
          for (unsigned int c = 0; c < dim; ++c)
            if (!given)
              parts.rows.push_back({i * dim + c, 0., 0.});
            else if (problem.mask[i] >> c & 1)
              parts.rows.push_back(
                  {i * dim + c, 0., -problem.given_velocity[i * dim + c]});
          continue;
        }
        add_springs<dim>(problem, i, solution, parts.rows);
        if (problem.contact[i])
          parts.contacts.push_back(i);
      }
      return parts;
    }

    /** mu kappa(beta), by the history of the point where nothing presses. */
    template <int dim>
    double friction(const OneStepProblem<dim> &problem, const std::size_t i,
                    const LocalSolution<dim> &solution)
    {
      if (solution.contact_impulse > 0.)
        return solution.frozen.threshold / solution.contact_impulse;
      const Interaction &law = problem.interactions[problem.interaction[i]];
      const Reach history{problem.opening_max[i],
                          problem.slip_max.empty() ? 0. : problem.slip_max[i]};
      return friction_of(problem, i) *
             kappa(beta_of(law, problem.kind[i], problem.opening_factor[i],
                           history),
                   law.friction_exponent);
    }

    /** W between components: a column is an application of W. */
    template <int dim>
    std::vector<double> dense_delassus(const DelassusOperator<dim> &delassus,
                                       const std::size_t n_components,
                                       const std::vector<std::size_t> &index)
    {
      const std::size_t n = index.size();
      std::vector<double> W(n * n), unit(n_components), U(n_components);
      for (std::size_t j = 0; j < n; ++j) {
        unit[index[j]] = 1.;
        delassus.apply_delassus(unit.data(), U.data());
        unit[index[j]] = 0.;
        for (std::size_t i = 0; i < n; ++i)
          W[j * n + i] = U[index[i]];
      }
      return W;
    }

    void set_matrix(const std::vector<double> &W, const std::size_t n,
                    ContactProblem &contact)
    {
      contact.row_start = {0};
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j)
          if (W[j * n + i] != 0. || i == j) {
            contact.column.push_back(int(j));
            contact.value.push_back(W[j * n + i]);
          }
        contact.row_start.push_back(int(contact.column.size()));
      }
    }
  } // namespace

  template <int dim>
  ContactProblem condense_contacts(const OneStepProblem<dim> &problem,
                                   const DelassusOperator<dim> &delassus,
                                   const LawEvaluation<dim> &evaluation,
                                   const std::size_t largest)
  {
    ContactProblem contact;
    contact.dimension = dim;
    const Parts parts = split<dim>(problem, evaluation);
    const std::size_t n_c = parts.contacts.size() * dim,
                      n_s = parts.rows.size(), n = n_c + n_s;
    if (n_c == 0 || n > largest || delassus.communicator().size() > 1)
      return contact;

    std::vector<std::size_t> index;
    for (const std::size_t i : parts.contacts)
      for (unsigned int c = 0; c < dim; ++c)
        index.push_back(i * dim + c);
    for (const Row &row : parts.rows)
      index.push_back(row.component);
    const std::vector<double> W =
        dense_delassus<dim>(delassus, problem.n_points * dim, index);

    // columns of -(U_free,s + a / D) and -W_sc, solved at once
    std::vector<double> S(n_s * n_s), B(n_s * (n_c + 1));
    double size = 0.;
    for (std::size_t k = 0; k < n_s; ++k)
      size = std::max(size, W[(n_c + k) * (n + 1)]);
    for (std::size_t k = 0; k < n_s; ++k) {
      for (std::size_t l = 0; l < n_s; ++l)
        S[l * n_s + k] = W[(n_c + l) * n + n_c + k];
      // joints around a corner hold one another: round-off of the block
      S[k * (n_s + 1)] += parts.rows[k].compliance + 1e-14 * size;
      B[k] = -(problem.free_velocity[parts.rows[k].component] +
               parts.rows[k].rest);
      for (std::size_t j = 0; j < n_c; ++j)
        B[(j + 1) * n_s + k] = -W[j * n + n_c + k];
    }
    if (n_s > 0) {
      const int rows = int(n_s), columns = int(n_c + 1);
      std::vector<int> pivots(n_s);
      int info = 0;
      dgesv_(&rows, &columns, S.data(), &rows, pivots.data(), B.data(), &rows,
             &info);
      if (info != 0)
        return contact;
    }

    std::vector<double> condensed(n_c * n_c);
    for (std::size_t j = 0; j < n_c; ++j)
      for (std::size_t i = 0; i < n_c; ++i) {
        double sum = W[j * n + i];
        for (std::size_t k = 0; k < n_s; ++k)
          sum += W[(n_c + k) * n + i] * B[(j + 1) * n_s + k];
        condensed[j * n_c + i] = sum;
      }
    set_matrix(condensed, n_c, contact);
    contact.q.resize(n_c);
    contact.solution.resize(n_c);
    for (std::size_t i = 0; i < n_c; ++i) {
      double sum = problem.free_velocity[index[i]];
      for (std::size_t k = 0; k < n_s; ++k)
        sum += W[(n_c + k) * n + i] * B[k];
      const std::size_t point = parts.contacts[i / dim];
      contact.q[i] = i % dim == 0 ? sum - problem.target[point]
                                  : sum + problem.sliding_offset[index[i]];
      contact.solution[i] = evaluation.solutions[point].impulse[i % dim];
    }
    // what springs carry at the same points is not contact
    for (std::size_t k = 0; k < n_s; ++k)
      for (std::size_t i = 0; i < n_c; ++i)
        if (index[i] == parts.rows[k].component) {
          const auto &solution = evaluation.solutions[index[i] / dim];
          contact.solution[i] +=
              (solution.velocity[index[i] % dim] + parts.rows[k].rest) /
              parts.rows[k].compliance;
        }
    for (const std::size_t i : parts.contacts)
      contact.friction.push_back(
          friction<dim>(problem, i, evaluation.solutions[i]));
    return contact;
  }

  template ContactProblem condense_contacts<2>(const OneStepProblem<2> &,
                                               const DelassusOperator<2> &,
                                               const LawEvaluation<2> &,
                                               std::size_t);
  template ContactProblem condense_contacts<3>(const OneStepProblem<3> &,
                                               const DelassusOperator<3> &,
                                               const LawEvaluation<3> &,
                                               std::size_t);
} // namespace nsfd
