#include "nsfd/postprocess/observable_input.h"

#include <limits>
#include <stdexcept>

namespace nsfd
{
  using namespace observables;

  /** How a surface is pressed: resultant, peak, mean, area, centre, profile. */
  class ContactPressure final : public Observable
  {
  public:
    ContactPressure(SectionReader &reader, const SceneInput &scene)
        : dimension_(scene.dimension), force_unit_(force_unit(scene)),
          area_unit_(area_unit(scene)),
          surface_(
              read_surface(reader, scene, "an Obstacle or an Interface block"))
    {
      if (surface_.name.empty())
        return;
      if (surface_.kind == NamedSurface::Kind::boundary)
        reader.error("on", full_name(surface_) + " touches nothing",
                     "name an Obstacle or an Interface block; for the force of "
                     "a driven boundary write type = reaction");
      else if (surface_.kind == NamedSurface::Kind::contact)
        reader.error("on",
                     full_name(surface_) + " has places on both bodies, which "
                                           "share one pressure",
                     "write type = reaction for the force between them");
      else if (surface_.kind == NamedSurface::Kind::interface &&
               scene.large_motion)
        reader.error("on",
                     "in large motions the contacts of broken faces are those "
                     "of Contact blocks",
                     "name an Obstacle block, or write type = reaction on a "
                     "Contact block");
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
      add_vector(columns, "force", force_unit_, dimension_);
      columns.push_back({"peak", "Pa"});
      columns.push_back({"mean", "Pa"});
      columns.push_back({"area", area_unit_});
      add_vector(columns, "centre", "m", dimension_);
      return columns;
    }

    std::vector<double> values(const RunView &view) override
    {
      std::vector<std::array<double, 8>> touching;
      double peak = 0.;
      for (const RunView::Place &place : view.places(surface_)) {
        if (!place.contact)
          continue;
        const double load = place.area * place.pressure;
        peak = std::max(peak, place.pressure);
        touching.push_back(
            {{place.area, load, place.force[0], place.force[1], place.force[2],
              load * place.position[0], load * place.position[1],
              load * place.position[2]}});
      }
      const std::size_t n = touching.size();
      std::vector<double> terms(8 * n);
      for (std::size_t k = 0; k < n; ++k)
        for (unsigned int r = 0; r < 8; ++r)
          terms[r * n + k] = touching[k][r];
      const auto s = view.sums(terms, 8);
      const double nothing = std::numeric_limits<double>::quiet_NaN();
      std::vector<double> values;
      add_vector(values, {{s[2], s[3], s[4]}}, dimension_);
      values.push_back(view.max(peak));
      values.push_back(s[0] > 0. ? s[1] / s[0] : 0.);
      values.push_back(s[0]);
      for (unsigned int c = 0; c < dimension_; ++c)
        values.push_back(s[1] > 0. ? s[5 + c] / s[1] : nothing);
      return values;
    }

    std::vector<ObservedColumn> profile_columns() const override
    {
      std::vector<ObservedColumn> columns;
      for (unsigned int c = 0; c < dimension_; ++c)
        columns.push_back({std::string(1, "xyz"[c]), "m"});
      columns.push_back({"pressure", "Pa"});
      columns.push_back({"shear", "Pa"});
      columns.push_back({"opening", "m"});
      return columns;
    }

    std::vector<double> profile(const RunView &view) const override
    {
      std::vector<double> rows;
      for (const RunView::Place &place : view.places(surface_)) {
        Vector shear = place.force;
        const double normal = product(shear, place.normal);
        for (unsigned int c = 0; c < 3; ++c)
          shear[c] -= normal * place.normal[c];
        add_vector(rows, place.position, dimension_);
        rows.push_back(place.pressure);
        rows.push_back(
            place.contact ? std::sqrt(product(shear, shear)) / place.area : 0.);
        rows.push_back(place.opening);
      }
      return rows;
    }

    std::string text() const override { return "on " + full_name(surface_); }

  private:
    const unsigned int dimension_;
    const std::string force_unit_, area_unit_;
    const NamedSurface surface_;
  };

  NSFD_REGISTER(ObservableRegistry, ContactPressure, "contact pressure",
                "Resultant, peak, mean, area, centre and profile of a contact",
                "on = floor");
} // namespace nsfd
