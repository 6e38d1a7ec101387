#pragma once

#include "make_scene.h"
#include "simulation/adaptive_mesh.h"

#include "nsfd/adaptivity/indicator.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd
{
  namespace test
  {
    /** Wants small cells here and there, elsewhere in every round. */
    class Chance final : public Indicator
    {
    public:
      explicit Chance(SectionReader &) {}

      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        ++round;
        const auto &bodies = view.bodies();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const auto &x = bodies[b].centre;
          // siblings want the same
          const double place =
              std::floor(x[0]) + 7. * std::floor(x[1]) + 31. * std::floor(x[2]);
          const double wave = std::sin(12.9898 * place + 78.233 * round);
          size[b] = std::ldexp(bodies[b].largest, -int(2.999 * std::abs(wave)));
        }
      }

      static inline unsigned int round = 0;
    };
    inline double wave(const double phase)
    {
      return std::sin(78.233 * phase + 0.4);
    }

    /** A model whose mesh changes, with a state that knows no symmetry. */
    template <int dim>
    class Changing
    {
    public:
      explicit Changing(const std::string &text)
          : input(make_input(text)), communicator(MPI_COMM_WORLD)
      {
        const auto problems = model.build(*input, communicator);
        if (!problems.empty())
          throw std::invalid_argument(problems.front());
        model.delassus->reinit(model.control->step(), input->time.bulk_theta());
        adaptive =
            std::make_unique<AdaptiveMesh<dim>>(*input, communicator, model);
        state = model.stepper->initial_state();
        const auto gap = state.jump;
        // nearly linear, or no cell would be allowed to grow
        state.velocity = model.discretization->interpolate(
            [](const dealii::Point<dim> &x, unsigned int, double *v) {
              for (unsigned int d = 0; d < dim; ++d)
                v[d] = 1. + 0.3 * x[0] - 0.2 * double(d) * x[1];
            });
        for (std::size_t i = 0; i < state.displacement.size(); ++i) {
          state.displacement[i] =
              0.01 * state.velocity[i] + 1e-5 * wave(double(i));
          state.velocity[i] += 1e-3 * wave(1000. + double(i));
        }
        set_jumps(gap);
        state.largest_energy = 1.;
      }

      void set_jumps(const std::vector<double> &gap)
      {
        model.delassus->relative_velocity(state.displacement.data(),
                                          state.jump.data());
        model.delassus->relative_velocity(state.velocity.data(),
                                          state.relative_velocity.data());
        for (std::size_t k = 0; k < gap.size(); ++k)
          state.jump[k] += gap[k];
        model.stepper->complete(state);
      }

      /** Some points soften, some are broken. */
      void damage()
      {
        const auto &problem = model.stepper->problem();
        for (std::size_t i = 0; i < state.beta.size(); ++i) {
          const auto &law = problem.interactions[problem.interaction[i]].law;
          const double chance = wave(3000. + 1.7 * double(i));
          if (!law || chance < 0.6)
            continue;
          const bool breaks = chance > 0.9;
          state.opening_max[i] =
              breaks ? law->final_opening()
                     : law->elastic_limit() +
                           0.5 * chance *
                               (std::min(law->final_opening(), 10.) -
                                law->elastic_limit());
          state.beta[i] = breaks ? 0. : law->beta(state.opening_max[i]);
          state.kind[i] = breaks ? PointKind::free : PointKind::cohesive;
          state.two_sided[i] = 0;
        }
        model.stepper->complete(state);
      }

      /** Linear, then angular momentum, and a scale for them. */
      std::vector<double> momenta()
      {
        std::vector<double> Mv(state.velocity.size()), result;
        model.delassus->apply(DelassusOperator<dim>::Operator::mass,
                              state.velocity.data(), Mv.data());
        const unsigned int n = dim == 2 ? 3 : 6;
        for (unsigned int k = 0; k < n; ++k) {
          const auto motion = model.discretization->interpolate(
              [&](const dealii::Point<dim> &x, unsigned int, double *v) {
                for (unsigned int c = 0; c < dim; ++c)
                  v[c] = k == c ? 1. : 0.;
                if (k >= dim) {
                  const unsigned int a = (k - dim + 1) % dim,
                                     b = dim == 2 ? 0 : (k - dim + 2) % dim;
                  v[a] = -x[b];
                  v[b] = x[a];
                }
              });
          result.push_back(
              communicator.dot(motion.data(), Mv.data(), Mv.size()));
        }
        double scale = 0.;
        for (const double value : Mv)
          scale += std::abs(value);
        result.push_back(scale);
        return result;
      }

      /** Of the loads: sum of the forces along y, and of their moments. */
      std::array<double, 2> load() const
      {
        std::vector<double> forces(state.velocity.size(), 0.);
        model.discretization->add_loads(0., forces);
        std::array<double, 2> result{};
        for (unsigned int k = 0; k < 2; ++k) {
          const auto motion = model.discretization->interpolate(
              [&](const dealii::Point<dim> &x, unsigned int, double *v) {
                std::fill(v, v + dim, 0.);
                v[1] = k == 0 ? 1. : x[0];
              });
          result[k] =
              communicator.dot(motion.data(), forces.data(), forces.size());
        }
        return result;
      }

      double damaged_area() const
      {
        double sum = 0.;
        for (std::size_t i = 0; i < state.beta.size(); ++i)
          sum +=
              model.discretization->points().weight[i] *
              (model.discretization->origins()[i].kind == PointOrigin::Kind::interface ? 1. -
                                                                                             state
                                                                                                 .beta
                                                                                                     [i]
                                                                                       : 0.);
        return sum;
      }

      std::set<double> betas() const
      {
        std::set<double> values;
        for (std::size_t i = 0; i < state.beta.size(); ++i)
          if (model.discretization->origins()[i].kind ==
              PointOrigin::Kind::interface)
            values.insert(state.beta[i]);
        values.insert(1.);
        return values;
      }

      double jump_of_motion() const
      {
        std::vector<double> Hq(state.jump.size());
        model.delassus->relative_velocity(state.displacement.data(), Hq.data());
        double largest = 0.;
        for (std::size_t i = 0; i < state.beta.size(); ++i)
          if (model.discretization->origins()[i].kind ==
              PointOrigin::Kind::interface)
            for (unsigned int c = 0; c < dim; ++c)
              largest = std::max(
                  largest, std::abs(Hq[i * dim + c] - state.jump[i * dim + c]));
        return largest;
      }

      bool change()
      {
        State next = state;
        next.step = ++looks;
        next.time = looks; // long after the last look
        const bool changed = adaptive->follow(state, next);
        adaptive->accept(state);
        return changed;
      }

      std::unique_ptr<SceneInput> input;
      Communicator communicator;
      Model<dim> model;
      std::unique_ptr<AdaptiveMesh<dim>> adaptive;
      State state;
      unsigned int looks = 0;
    };

    inline double closed(const EnergyLines &e)
    {
      return e.kinetic + e.elastic + e.cohesive + e.damage + e.numerical;
    }
  } // namespace test
} // namespace nsfd
