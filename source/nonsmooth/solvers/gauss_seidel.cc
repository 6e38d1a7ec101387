#include "nonsmooth/frictional_contact/contact_solver.h"
#include "nonsmooth/solver.h"

#include "core/cost.h"
#include "discretization/point_places.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** Words of 64 bits for the colours of a body: a face never needs more than
        its two bodies have faces. */
    template <int dim>
    unsigned int words_of_colours(const DelassusOperator<dim> &delassus)
    {
      std::vector<unsigned int> n_faces(delassus.bodies().size(), 0);
      unsigned int most = 0;
      for (const auto &face : delassus.points().faces)
        for (const int b : face.bodies)
          if (b >= 0)
            most = std::max(most, ++n_faces[b]);
      return unsigned(delassus.communicator().max(most)) * 2 / 64 + 1;
    }
  } // namespace

  /**
   * Jones-Plassmann: in each round a face without a colour whose key is the
   * largest among such faces of its two bodies takes the smallest colour that
   * its bodies have not used. Keys are the same on all ranks, so is the
   * colouring.
   */
  template <int dim>
  std::vector<std::vector<unsigned int>>
  colour_faces(const DelassusOperator<dim> &delassus)
  {
    const auto &points = delassus.points();
    const std::size_t n_bodies = delassus.bodies().size();
    std::vector<int> colour(points.faces.size(), -1);
    const unsigned int n_words = words_of_colours(delassus);
    std::vector<std::uint64_t> used(n_bodies * n_words, 0);
    // A body's largest open key, and per point of shared faces what the other
    // rank knows: key halves (exact as doubles) and used colours.
    std::array<std::vector<double>, 2> side;
    const unsigned int stride = 2 + 2 * n_words;
    for (auto &s : side)
      s.assign((points.n_points + 1) * stride, 0.);
    bool open = true;
    while (delassus.communicator().any(open)) {
      std::vector<std::uint64_t> top(n_bodies, 0);
      for (std::size_t f = 0; f < points.faces.size(); ++f)
        if (colour[f] < 0)
          for (const int b : points.faces[f].bodies)
            if (b >= 0)
              top[b] = std::max(top[b], points.faces[f].key);
      for (const auto &face : points.faces)
        for (unsigned int s = 0; s < 2; ++s)
          if (face.bodies[s] >= 0) {
            const int b = face.bodies[s];
            double *out = side[s].data() + std::size_t(face.first) * stride;
            out[0] = double(top[b] >> 32);
            out[1] = double(top[b] & 0xffffffffu);
            for (unsigned int w = 0; w < n_words; ++w) {
              const std::uint64_t word = used[std::size_t(b) * n_words + w];
              out[2 + 2 * w] = double(word >> 32);
              out[3 + 2 * w] = double(word & 0xffffffffu);
            }
          }
      delassus.exchange({{side[0].data(), side[1].data()}}, stride);
      const auto join = [](const double high, const double low) {
        return (std::uint64_t(high) << 32) | std::uint64_t(low);
      };
      open = false;
      std::vector<std::pair<std::size_t, int>> chosen;
      std::vector<std::uint64_t> taken(n_words);
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        if (colour[f] >= 0)
          continue;
        std::uint64_t limit = 0;
        std::fill(taken.begin(), taken.end(), 0);
        for (unsigned int s = 0; s < 2; ++s) {
          const double *in = side[s].data() + std::size_t(face.first) * stride;
          if (face.bodies[s] >= 0 || face.neighbor_rank >= 0) {
            limit = std::max(limit, join(in[0], in[1]));
            for (unsigned int w = 0; w < n_words; ++w)
              taken[w] |= join(in[2 + 2 * w], in[3 + 2 * w]);
          }
        }
        if (face.key < limit) {
          open = true;
          continue;
        }
        int mine = 0;
        while (taken[mine / 64] >> mine % 64 & 1u)
          ++mine;
        chosen.emplace_back(f, mine);
      }
      for (const auto &[f, mine] : chosen) {
        colour[f] = mine;
        for (const int b : points.faces[f].bodies)
          if (b >= 0)
            used[std::size_t(b) * n_words + mine / 64] |= std::uint64_t(1)
                                                          << mine % 64;
      }
    }
    const int n_colours =
        int(delassus.communicator().max(
            colour.empty() ? -1.
                           : *std::max_element(colour.begin(), colour.end()))) +
        1;
    std::vector<std::vector<unsigned int>> result(n_colours);
    for (std::size_t f = 0; f < colour.size(); ++f)
      result[colour[f]].push_back(unsigned(f));
    return result;
  }

  template <int dim>
  void gauss_seidel(const OneStepProblem<dim> &problem,
                    const DelassusOperator<dim> &delassus,
                    const std::vector<std::vector<unsigned int>> &colours,
                    const unsigned int count, std::vector<double> &impulse)
  {
    const auto &points = delassus.points();
    const auto &bodies = delassus.bodies();
    const auto &blocks = delassus.class_blocks();

    const Charge charge(Cost::sweeps);
    // where in its bodies a point sits
    const auto place = point_places(bodies, points.n_points);

    // Cartesian velocity at every point from each side
    std::array<std::vector<double>, 2> side;
    delassus.delassus_sides(impulse.data(), side);
    const auto add = [&](const std::size_t i, const double *change) {
      const double *Q = points.axes(i);
      for (unsigned int s = 0; s < 2; ++s) {
        const PointPlace mine = place[s][i];
        if (mine.body < 0)
          continue;
        const double sign = s == 1 ? 1. : -1.;
        double P[dim];
        for (unsigned int c = 0; c < dim; ++c) {
          P[c] = 0.;
          for (unsigned int k = 0; k < dim; ++k)
            P[c] += sign * Q[k * dim + c] * change[k];
        }
        const Block &W = blocks[bodies.class_of[mine.body]].delassus;
        const std::size_t first = bodies.first_slot[mine.body],
                          n = bodies.first_slot[mine.body + 1] - first;
        const auto add_at = [&](const std::size_t t, const std::size_t point,
                                const double other) {
          double *U = side[other > 0.].data() + point * dim;
          for (unsigned int d = 0; d < dim; ++d) {
            const double *column =
                &W.values[std::size_t(mine.slot * dim + d) * padded(W.rows)];
            for (unsigned int c = 0; c < dim; ++c)
              U[c] += other * column[t * dim + c] * P[d];
          }
        };
        for (std::size_t t = 0; t < n; ++t)
          add_at(t, bodies.slot_point[first + t], bodies.slot_sign[first + t]);
        for (const auto &[slot, point] : bodies.extra_points)
          if (slot >= first && slot < first + n)
            add_at(slot - first, point, 1.);
      }
    };

    unsigned int largest = 0;
    for (const auto &face : points.faces)
      largest = std::max(largest, face.count);
    largest = unsigned(delassus.communicator().max(largest));

    std::vector<Reach> reach(problem.n_points);
    for (std::size_t i = 0; i < problem.n_points; ++i)
      reach[i].opening = problem.opening_max[i];
    for (std::size_t i = 0; i < problem.slip_max.size(); ++i)
      reach[i].slip = problem.slip_max[i];
    const auto solve = [&](const std::size_t i) {
      const double *Q = points.axes(i);
      std::array<double, dim> local;
      for (unsigned int k = 0; k < dim; ++k) {
        local[k] = problem.free_velocity[i * dim + k];
        for (unsigned int c = 0; c < dim; ++c)
          local[k] +=
              Q[k * dim + c] * (side[1][i * dim + c] + side[0][i * dim + c]);
        local[k] -= (k == 0 ? problem.majorant_normal[i]
                            : problem.majorant_tangential[i]) *
                    impulse[i * dim + k];
      }
      const auto solution =
          solve_point<dim>(problem, i, local, problem.majorant_normal[i],
                           problem.majorant_tangential[i], reach[i]);
      reach[i] = solution.reach;
      double change[dim];
      bool changed = false;
      for (unsigned int k = 0; k < dim; ++k) {
        change[k] = solution.impulse[k] - impulse[i * dim + k];
        impulse[i * dim + k] = solution.impulse[k];
        changed = changed || change[k] != 0.;
      }
      if (changed)
        add(i, change);
    };
    // A rank updates the sides of its own bodies; the points of a shared face
    // are solved by both ranks with the same numbers, one after the other.
    for (unsigned int sweep = 0; sweep < count; ++sweep)
      for (const auto &faces : colours)
        for (unsigned int q = 0; q < largest; ++q) {
          for (const unsigned int f : faces)
            if (q < points.faces[f].count)
              solve(points.faces[f].first + q);
          delassus.exchange({{side[0].data(), side[1].data()}}, dim);
        }
  }

  namespace
  {
    /** Sweeps of the full law until the natural map is small. */
    template <int dim>
    class GaussSeidel final
        : public NonsmoothSolver<dim>,
          public AssembledMethod<ContactMethod::gauss_seidel>
    {
    public:
      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus, double,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        if (colours_.empty())
          colours_ = colour_faces(delassus);
        SolverReport report;
        evaluation.update(impulse);
        unsigned int batch = 5;
        while (evaluation.error > control.tolerance &&
               report.sweeps < 100 * control.iterations_or(200)) {
          gauss_seidel(problem, delassus, colours_, batch, impulse);
          report.sweeps += batch;
          batch = std::min(100u, batch * 2);
          evaluation.update(impulse);
          if (!(evaluation.error < std::numeric_limits<double>::infinity()))
            break;
        }
        report.residual = evaluation.error;
        report.converged = evaluation.error <= control.tolerance;
        return report;
      }

      const ContactSolver *contact_solver() const override { return this; }

    private:
      std::vector<std::vector<unsigned int>> colours_;
    };

    using GaussSeidel2 = GaussSeidel<2>;
    using GaussSeidel3 = GaussSeidel<3>;
    NSFD_REGISTER(SolverRegistry<2>, GaussSeidel2, "gauss seidel",
                  "nonlinear Gauss-Seidel, friction and damage in the local "
                  "solve; in a run over coloured faces");
    NSFD_REGISTER(SolverRegistry<3>, GaussSeidel3, "gauss seidel",
                  "nonlinear Gauss-Seidel, friction and damage in the local "
                  "solve; in a run over coloured faces");
  } // namespace

  template std::vector<std::vector<unsigned int>>
  colour_faces<2>(const DelassusOperator<2> &);
  template std::vector<std::vector<unsigned int>>
  colour_faces<3>(const DelassusOperator<3> &);
  template void gauss_seidel<2>(const OneStepProblem<2> &,
                                const DelassusOperator<2> &,
                                const std::vector<std::vector<unsigned int>> &,
                                unsigned int, std::vector<double> &);
  template void gauss_seidel<3>(const OneStepProblem<3> &,
                                const DelassusOperator<3> &,
                                const std::vector<std::vector<unsigned int>> &,
                                unsigned int, std::vector<double> &);
} // namespace nsfd
