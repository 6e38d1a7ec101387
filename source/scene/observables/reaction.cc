#include "observable_input.h"

#include <stdexcept>

namespace nsfd
{
  using namespace observables;

  /**
   * The force on the bodies at a driven boundary or an obstacle, and of body 1
   * on body 2 through an interface.
   */
  class Reaction final : public Observable
  {
  public:
    Reaction(SectionReader &reader, const SceneInput &scene)
        : dimension_(scene.dimension),
          surface_(read_surface(reader, scene,
                                "a driven Boundary, an Obstacle or an "
                                "Interface block"))
    {
      if (surface_.name.empty())
        return;
      if (surface_.kind == NamedSurface::Kind::obstacle && scene.large_motion)
        reader.error("on",
                     "the reaction of an obstacle needs motion = small",
                     "name a driven boundary, or remove the block");
      if (surface_.kind != NamedSurface::Kind::boundary)
        return;
      const BoundaryInput &boundary = scene.boundaries[surface_.block];
      bool driven = boundary.exact_motion;
      for (unsigned int c = 0; c < dimension_; ++c)
        driven =
            driven || boundary.velocity[c] || boundary.displacement[c];
      if (!driven)
        reader.error("on", full_name(surface_) + " prescribes no motion",
                     "its force is the load; name a driven boundary, an "
                     "obstacle or an interface");
    }

    void find(const RunView &view) override
    {
      if (!(view.on(surface_).size > 0.))
        throw std::runtime_error("on = " + full_name(surface_) +
                                 " has no faces in this mesh");
    }

    std::vector<ObservedColumn> columns() const override
    {
      std::vector<ObservedColumn> columns;
      add_vector(columns, "force", dimension_ == 2 ? "N/m" : "N", dimension_);
      return columns;
    }

    std::vector<double> values(const RunView &view) override
    {
      std::vector<double> values;
      add_vector(values,
                 surface_.kind == NamedSurface::Kind::boundary
                     ? view.reaction(surface_.block)
                     : resultant(view),
                 dimension_);
      return values;
    }

    std::string text() const override { return "on " + full_name(surface_); }

  private:
    Vector resultant(const RunView &view) const
    {
      std::vector<Vector> forces;
      for (std::size_t i = 0; i < view.points().size(); ++i) {
        const auto &point = view.points()[i];
        if (point.origin.block != surface_.block ||
            point.origin.kind != (surface_.kind == NamedSurface::Kind::obstacle
                                      ? PointOrigin::Kind::obstacle
                                      : PointOrigin::Kind::interface))
          continue;
        Vector &force = forces.emplace_back(view.at(i).traction);
        for (double &component : force)
          component *= -point.area;
      }
      const std::size_t n = forces.size();
      std::vector<double> terms(3 * n);
      for (std::size_t k = 0; k < n; ++k)
        for (unsigned int c = 0; c < 3; ++c)
          terms[c * n + k] = forces[k][c];
      const auto s = view.sums(terms, 3);
      return {{s[0], s[1], s[2]}};
    }

    const unsigned int dimension_;
    const NamedSurface surface_;
  };

  NSFD_REGISTER(ObservableRegistry, Reaction, "reaction",
                "Force at a driven boundary, an obstacle or an interface",
                "on = floor");
} // namespace nsfd
