#include "observable_input.h"

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
        : dimension_(scene.dimension),
          surface_(read_surface(reader, scene,
                                "an Obstacle or an Interface block"))
    {
      if (surface_.name.empty())
        return;
      if (surface_.kind == NamedSurface::Kind::boundary)
        reader.error("on",
                     full_name(surface_) + " touches nothing",
                     "name an Obstacle or an Interface block; for the force of "
                     "a driven boundary write type = reaction");
      else if (scene.large_motion)
        reader.error("type",
                     "contact pressure needs motion = small: places of large "
                     "motions meet others in every step",
                     "remove the block, or write motion = small");
    }

    void find(const RunView &view) override
    {
      if (!(view.sums(areas(view), 1)[0] > 0.))
        throw std::runtime_error("on = " + full_name(surface_) +
                                 " has no faces in this mesh");
    }

    std::vector<ObservedColumn> columns() const override
    {
      std::vector<ObservedColumn> columns;
      add_vector(columns, "force", dimension_ == 2 ? "N/m" : "N", dimension_);
      columns.push_back({"peak", "Pa"});
      columns.push_back({"mean", "Pa"});
      columns.push_back({"area", dimension_ == 2 ? "m" : "m²"});
      add_vector(columns, "centre", "m", dimension_);
      return columns;
    }

    std::vector<double> values(const RunView &view) override
    {
      std::vector<std::array<double, 8>> touching;
      double peak = 0.;
      for (std::size_t i = 0; i < view.points().size(); ++i) {
        if (!is_there(view, i))
          continue;
        const RunView::PointState state = view.at(i);
        if (!state.contact)
          continue;
        const auto &point = view.points()[i];
        const double load = point.area * state.pressure;
        peak = std::max(peak, state.pressure);
        touching.push_back({{point.area, load, -point.area * state.traction[0],
                             -point.area * state.traction[1],
                             -point.area * state.traction[2],
                             load * point.position[0], load * point.position[1],
                             load * point.position[2]}});
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
      for (std::size_t i = 0; i < view.points().size(); ++i) {
        if (!is_there(view, i))
          continue;
        const auto &point = view.points()[i];
        const RunView::PointState state = view.at(i);
        Vector shear = state.traction;
        const double normal = product(shear, point.normal);
        for (unsigned int c = 0; c < 3; ++c)
          shear[c] -= normal * point.normal[c];
        add_vector(rows, point.position, dimension_);
        rows.push_back(state.pressure);
        rows.push_back(state.contact ? std::sqrt(product(shear, shear)) : 0.);
        rows.push_back(product(state.jump, point.normal));
      }
      return rows;
    }

    std::string text() const override { return "on " + full_name(surface_); }

  private:
    bool is_there(const RunView &view, const std::size_t i) const
    {
      const PointOrigin origin = view.points()[i].origin;
      return origin.block == surface_.block &&
             origin.kind == (surface_.kind == NamedSurface::Kind::obstacle
                                 ? PointOrigin::Kind::obstacle
                                 : PointOrigin::Kind::interface);
    }

    std::vector<double> areas(const RunView &view) const
    {
      std::vector<double> areas;
      for (std::size_t i = 0; i < view.points().size(); ++i)
        if (is_there(view, i))
          areas.push_back(view.points()[i].area);
      return areas;
    }

    const unsigned int dimension_;
    const NamedSurface surface_;
  };

  NSFD_REGISTER(ObservableRegistry, ContactPressure, "contact pressure",
                "Resultant, peak, mean, area, centre and profile of a contact",
                "on = floor");
} // namespace nsfd
