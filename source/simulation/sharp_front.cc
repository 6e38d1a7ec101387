#include "sharp_front.h"

#include "discretization/body_shape.h"
#include "discretization/cells.h"
#include "discretization/obstacle_of_point.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** What a wall that moves at 1 m/s presses into the stiffest body, Pa. */
    template <int dim>
    double impedance(const SceneInput &input,
                     const Discretization<dim> &discretization)
    {
      double largest = 0.;
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        if (!input.materials[m].rigid)
          largest = std::max(largest, discretization.extremes(m).densest *
                                          discretization.extremes(m).fastest);
      return largest;
    }

    /** Density c^2 of the stiffest body. */
    template <int dim>
    double wave_modulus(const SceneInput &input,
                        const Discretization<dim> &discretization)
    {
      double largest = 0.;
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        if (!input.materials[m].rigid) {
          const auto &extremes = discretization.extremes(m);
          largest = std::max(largest, extremes.densest * extremes.fastest *
                                          extremes.fastest);
        }
      return largest;
    }

    /**
     * Of stress per rate of a plane wave, over modulus times crossing, in the
     * body that has least of it; theta > 1/2 is a viscosity of (theta - 1/2) h
     * per modulus. Steps that shorten by themselves damp as they like.
     */
    template <int dim>
    double relative_viscosity(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              const double modulus, const double crossing)
    {
      double least = std::numeric_limits<double>::infinity();
      for (const auto &material : input.materials)
        if (!material.rigid)
          least = std::min(least, 4. / 3. * material.shear_viscosity +
                                      material.bulk_viscosity);
      const TimeInput &time = input.time;
      const double step = time.step_kind == StepKind::time ? time.step
                          : time.step_kind == StepKind::courant
                              ? time.step * discretization.crossing_time()
                              : 0.;
      const double numerical =
          std::max(0., time.bulk_theta() - 0.5) * step / crossing;
      return least / (modulus * crossing) + numerical;
    }

    template <int dim>
    double longest_crossing(const Discretization<dim> &discretization,
                            const Communicator &communicator)
    {
      double longest = 0.;
      const auto &bodies = discretization.bodies();
      for (const BodyClass &body : bodies.classes)
        for (const unsigned int b : body.bodies) {
          const double speed =
              discretization.cells().class_shape(b).extremes.fastest;
          if (!body.rigid && speed > 0.)
            longest = std::max(longest,
                               discretization.cells().shape(b)->height / speed);
        }
      return communicator.max(longest);
    }

    /** The middle, the corners and what is between them of all bodies. */
    template <int dim>
    std::vector<Point<dim>>
    places_in_box(const Discretization<dim> &discretization,
                  const Communicator &communicator)
    {
      Point<dim> low, high;
      for (unsigned int d = 0; d < dim; ++d) {
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (unsigned int b = 0; b < discretization.bodies().size(); ++b)
          for (const auto &corner : discretization.cells().corners[b]) {
            least = std::min(least, corner[d]);
            most = std::max(most, corner[d]);
          }
        low[d] = communicator.min(least);
        high[d] = communicator.max(most);
      }
      std::vector<Point<dim>> places;
      const unsigned int n = dim == 3 ? 27 : 9;
      for (unsigned int k = 0; k < n; ++k) {
        Point<dim> x;
        for (unsigned int d = 0, digits = k; d < dim; ++d, digits /= 3)
          x[d] = low[d] + (digits % 3) / 2. * (high[d] - low[d]);
        places.push_back(x);
      }
      return places;
    }

    /** Largest change of a function of time within a window. */
    class Steepest
    {
    public:
      using Function = std::function<double(double)>;

      Steepest(const Function &f, const double window, const double begin,
               const double end)
          : f_(f), window_(window)
      {
        // coarser than the window where there are very many of them; what
        // changes by more than the steepest place so far is looked into
        const double n =
            std::clamp(std::ceil((end - begin) / window), 1., most_samples);
        double a = begin, before = f(a);
        for (double k = 1.; k <= n; ++k) {
          const double b = begin + (end - begin) * (k / n), after = f(b);
          look(a, b, before, after);
          a = b;
          before = after;
        }
        // a rise across the ends of two windows
        for (const double shift : {-0.5, 0.5}) {
          const double from = time + shift * window;
          if (from >= begin)
            take(from, std::abs(f(from + window) - f(from)));
        }
      }

      double change = 0., time = 0.;

    private:
      static constexpr double most_samples = 4096.;

      void take(const double at, const double value)
      {
        if (value > change) { // a formula may be no number somewhere
          change = value;
          time = at;
        }
      }
      void look(const double a, const double b, const double before,
                const double after)
      {
        if (!(std::abs(after - before) > change))
          return;
        if (b - a <= window_ * (1. + 1e-9)) {
          take(a, std::abs(after - before));
          return;
        }
        const double middle = (a + b) / 2., value = f_(middle);
        look(a, middle, before, value);
        look(middle, b, value, after);
      }

      const Function &f_;
      const double window_;
    };

    /** What is raised by boundaries, one place after the other. */
    template <int dim>
    class Fronts
    {
    public:
      Fronts(const SceneInput &input, const Discretization<dim> &discretization,
             const double impedance, const double crossing,
             const std::vector<Point<dim>> &places)
          : input_(input), discretization_(discretization),
            impedance_(impedance), places_(places),
            begin_(input.statics && input.statics->steps ? input.statics->until
                                                         : 0.)
      {
        front.crossing = crossing;
      }

      void add(const BoundaryInput &boundary);
      /** Driven points that begin at another velocity than their bodies. */
      double sudden_motion(unsigned int boundary) const;
      void take(const double stress, const double time, const std::string &name)
      {
        if (stress > front.stress) {
          front.stress = stress;
          front.time = time;
          front.name = name;
        }
      }

      SharpFront front;

    private:
      const SceneInput &input_;
      const Discretization<dim> &discretization_;
      const double impedance_;
      const std::vector<Point<dim>> &places_;
      const double begin_;
    };

    template <int dim>
    void Fronts<dim>::add(const BoundaryInput &boundary)
    {
      const std::string name = "Boundary: " + boundary.name;
      for (const Point<dim> &x : places_) {
        const auto add_load = [&](const Expression &load) {
          const Steepest::Function stress = [&](const double t) {
            return load.at(x, t);
          };
          // an initial stress is there to hold it
          if (!input_.statics && !input_.has_initial_stress())
            take(std::abs(load.at(x, begin_)), begin_, name);
          if (load.depends_on_time()) {
            const Steepest steepest(stress, front.crossing, begin_,
                                    input_.time.end);
            take(steepest.change, steepest.time, name);
          }
        };
        const auto add_motion = [&](const Expression &motion,
                                    const bool is_velocity) {
          const double T = front.crossing;
          const Steepest::Function stress = [&](const double t) {
            return impedance_ *
                   (is_velocity ? motion.at(x, t)
                                : (motion.at(x, t + T) - motion.at(x, t)) / T);
          };
          if (motion.depends_on_time()) {
            const Steepest steepest(stress, T, begin_, input_.time.end);
            take(steepest.change, steepest.time, name);
          }
        };
        for (unsigned int c = 0; c < dim; ++c) {
          if (boundary.has_traction)
            add_load(boundary.traction[c]);
          if (boundary.velocity[c])
            add_motion(*boundary.velocity[c], true);
          if (boundary.displacement[c])
            add_motion(*boundary.displacement[c], false);
        }
        if (boundary.has_pressure)
          add_load(boundary.pressure);
      }
    }

    template <int dim>
    double Fronts<dim>::sudden_motion(const unsigned int k) const
    {
      const BoundaryInput &boundary = input_.boundaries[k];
      const auto &points = discretization_.points();
      const double T = front.crossing;
      double largest = 0.;
      for (std::size_t i = 0; i < points.n_points; ++i) {
        const PointOrigin &origin = discretization_.origins()[i];
        if (origin.kind != PointOrigin::Kind::motion || origin.block != k)
          continue;
        const auto &bodies = points.faces[points.face_of[i]].bodies;
        const int body = std::max(bodies[0], bodies[1]);
        if (body < 0)
          continue;
        const auto &material =
            input_.materials
                [discretization_.cells().body_class(unsigned(body)).material];
        const Point<dim> x = position_of(discretization_.points(), i);
        for (unsigned int c = 0; c < dim; ++c) {
          const auto &v = boundary.velocity[c], &u = boundary.displacement[c];
          if (!v && !u)
            continue;
          const double driven =
              v ? v->at(x, begin_)
                : (u->at(x, begin_ + T) - u->at(x, begin_)) / T;
          const double own =
              input_.statics ? 0. : material.initial_velocity[c].at(x);
          if (std::abs(driven - own) > largest)
            largest = std::abs(driven - own);
        }
      }
      return impedance_ * largest;
    }

    double smallest_strength(const SceneInput &input)
    {
      double smallest = std::numeric_limits<double>::infinity();
      for (const auto &block : input.interfaces)
        if (block.law && block.law->strength() > 0.)
          smallest = std::min(smallest, block.law->strength());
      return smallest;
    }
  } // namespace

  template <int dim>
  std::optional<SharpFront>
  sharp_front(const SceneInput &input,
              const Discretization<dim> &discretization,
              const Communicator &communicator)
  {
    const double strength = smallest_strength(input),
                 Z = impedance(input, discretization),
                 crossing = longest_crossing(discretization, communicator);
    if (!input.may_move() || std::isinf(strength) || !(Z > 0.) ||
        !(crossing > 0.))
      return {};
    const auto places = places_in_box(discretization, communicator);
    Fronts<dim> fronts(input, discretization, Z, crossing, places);
    for (unsigned int b = 0; b < input.boundaries.size(); ++b) {
      const BoundaryInput &boundary = input.boundaries[b];
      if (boundary.exact_motion)
        continue; // of a smooth solution
      fronts.add(boundary);
      fronts.take(communicator.max(fronts.sudden_motion(b)), 0.,
                  "Boundary: " + boundary.name);
    }
    fronts.front.strength = strength;
    fronts.front.modulus = wave_modulus(input, discretization);
    fronts.front.viscosity = relative_viscosity(input, discretization,
                                                fronts.front.modulus, crossing);
    return fronts.front;
  }

  template <int dim>
  void add_impacts(const SceneInput &input,
                   const Discretization<dim> &discretization,
                   const State &state, const Communicator &communicator,
                   SharpFront &front)
  {
    const double Z = impedance(input, discretization);
    double largest = 0.;
    for (std::size_t i = 0; i < discretization.points().n_points; ++i) {
      const PointOrigin &origin = discretization.origins()[i];
      const double approach = -state.relative_velocity[i * dim];
      if (obstacle_of(input, origin) >= 0)
        largest = std::max(largest, approach);
      else if (origin.kind == PointOrigin::Kind::interface &&
               input.interfaces[origin.block].law_name != "rigid")
        largest = std::max(largest, std::abs(approach) / 2.); // both give way
    }
    const double stress = Z * communicator.max(largest);
    if (stress > front.stress) {
      front.stress = stress;
      front.time = 0.;
      front.name = "what meets at t = 0";
      front.can_rise = false;
    }
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::optional<SharpFront> sharp_front(                              \
      const SceneInput &, const Discretization<dim> &, const Communicator &);  \
  template void add_impacts(const SceneInput &, const Discretization<dim> &,   \
                            const State &, const Communicator &, SharpFront &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
