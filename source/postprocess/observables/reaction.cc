#include "nsfd/postprocess/observable_input.h"

#include <stdexcept>

namespace nsfd
{
  using namespace observables;

  /**
   * The force on the bodies at a driven boundary or an obstacle, of body 1 on
   * body 2 through an interface, of the first on the second material of a
   * contact.
   */
  class Reaction final : public Observable
  {
  public:
    Reaction(SectionReader &reader, const SceneInput &scene)
        : dimension_(scene.dimension), force_unit_(force_unit(scene)),
          surface_(read_surface(reader, scene,
                                "a driven Boundary, an Obstacle, an Interface "
                                "or a Contact block"))
    {
      if (surface_.name.empty())
        return;
      if (surface_.kind == NamedSurface::Kind::contact) {
        const auto &materials = scene.contacts[surface_.block].materials;
        if (materials[0] == materials[1] || materials[0].empty() ||
            materials[1].empty())
          reader.error("on",
                       full_name(surface_) + " does not say on which of two "
                                             "materials the force is",
                       "name a Contact block of two different materials");
      }
      if (surface_.kind != NamedSurface::Kind::boundary)
        return;
      const BoundaryInput &boundary = scene.boundaries[surface_.block];
      bool driven = boundary.exact_motion;
      for (unsigned int c = 0; c < dimension_; ++c)
        driven = driven || boundary.velocity[c] || boundary.displacement[c];
      if (!driven)
        reader.error("on", full_name(surface_) + " prescribes no motion",
                     "its force is the load; name a driven boundary, an "
                     "obstacle or an interface");
    }

    void find(const RunView &view) override
    {
      if (surface_.kind != NamedSurface::Kind::contact &&
          !(view.on(surface_).size > 0.))
        throw std::runtime_error("on = " + full_name(surface_) +
                                 " has no faces in this mesh");
    }

    std::vector<ObservedColumn> columns() const override
    {
      std::vector<ObservedColumn> columns;
      add_vector(columns, "force", force_unit_, dimension_);
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
      const auto places = view.places(surface_);
      const std::size_t n = places.size();
      std::vector<double> terms(3 * n);
      for (std::size_t k = 0; k < n; ++k)
        for (unsigned int c = 0; c < 3; ++c)
          terms[c * n + k] = places[k].force[c];
      const auto s = view.sums(terms, 3);
      return {{s[0], s[1], s[2]}};
    }

    const unsigned int dimension_;
    const std::string force_unit_;
    const NamedSurface surface_;
  };

  NSFD_REGISTER(
      ObservableRegistry, Reaction, "reaction",
      "Force at a driven boundary, an obstacle, an interface, a contact",
      "on = floor");
} // namespace nsfd
