#include "nsfd/postprocess/observable_input.h"

#include <fmt/format.h>

#include <stdexcept>

namespace nsfd
{
  using namespace observables;

  /** Displacement, velocity and stress at a place, or their means on faces. */
  class Probe final : public Observable
  {
  public:
    Probe(SectionReader &reader, const SceneInput &scene)
        : dimension_(scene.dimension)
    {
      const bool has_place =
          reader.optional("at", "a place at t = 0, m; or write `on`");
      const bool has_faces =
          reader.optional("on", "a Boundary, Obstacle or Interface block: "
                                "means over its faces");
      if (has_place)
        place_ = in_space(reader.numbers("at", "", units::length, Range::any(),
                                         dimension_, ""));
      if (has_faces)
        surface_ = read_surface(reader, scene, "");
      if (surface_ && surface_->kind == NamedSurface::Kind::interface)
        interface_ = int(surface_->block);
      else if (surface_ && surface_->kind == NamedSurface::Kind::obstacle)
        interface_ = scene.obstacles[surface_->block].cohesion;
      if (surface_ && surface_->kind == NamedSurface::Kind::contact)
        reader.error("on", full_name(*surface_) + " has no faces of its own",
                     "name a Boundary, Obstacle or Interface block");
      if (has_place == has_faces)
        reader.error(has_place ? "on" : "type",
                     has_place ? "a probe looks at a place or at faces, not at "
                                 "both"
                               : "the probe has no place",
                     has_place ? "remove `at` or `on`"
                               : "write for example: set at = 1 mm, 2 mm");
    }

    void find(const RunView &view) override
    {
      if ((surface_ ? view.on(*surface_) : view.at(place_)).size > 0.)
        return;
      if (surface_)
        throw std::runtime_error("on = " + full_name(*surface_) +
                                 " has no faces in this mesh");
      throw std::runtime_error(fmt::format(
          "at = {:.6g}, {:.6g}{} is outside of the mesh", place_[0], place_[1],
          dimension_ == 3 ? fmt::format(", {:.6g}", place_[2]) : ""));
    }

    std::vector<ObservedColumn> columns() const override
    {
      std::vector<ObservedColumn> columns;
      add_vector(columns, "displacement", "m", dimension_);
      add_vector(columns, "velocity", "m/s", dimension_);
      for (const char *name : {"xx", "yy", "zz", "xy", "xz", "yz"})
        if (dimension_ == 3 || std::string(name) == "zz" || name[1] != 'z')
          columns.push_back({std::string("stress_") + name, "Pa"});
      if (interface_ >= 0) {
        add_vector(columns, "jump", "m", dimension_);
        add_vector(columns, "traction", "Pa", dimension_);
      }
      return columns;
    }

    std::vector<double> values(const RunView &view) override
    {
      const RunView::Means means =
          surface_ ? view.on(*surface_) : view.at(place_);
      std::vector<double> values;
      add_vector(values, means.displacement, dimension_);
      add_vector(values, means.velocity, dimension_);
      values.insert(values.end(), means.stress.begin(),
                    means.stress.begin() + (dimension_ == 2 ? 4 : 6));
      if (interface_ >= 0)
        add_jump(view, values);
      return values;
    }

    std::string text() const override
    {
      return surface_
                 ? "means on " + full_name(*surface_)
                 : fmt::format("at ({:.6g}, {:.6g}{})", place_[0], place_[1],
                               dimension_ == 3
                                   ? fmt::format(", {:.6g}", place_[2])
                                   : "");
    }

  private:
    void add_jump(const RunView &view, std::vector<double> &values) const
    {
      std::vector<std::size_t> points;
      for (std::size_t i = 0; i < view.points().size(); ++i) {
        const PointOrigin origin = view.points()[i].origin;
        if (origin.kind == PointOrigin::Kind::interface &&
            int(origin.block) == interface_)
          points.push_back(i);
      }
      const std::size_t n = points.size();
      std::vector<double> terms(7 * n, 0.);
      for (std::size_t k = 0; k < n; ++k) {
        const double area = view.points()[points[k]].area;
        const RunView::PointState state = view.at(points[k]);
        terms[k] = area;
        for (unsigned int c = 0; c < 3; ++c) {
          terms[(1 + c) * n + k] = area * state.jump[c];
          terms[(4 + c) * n + k] = area * state.traction[c];
        }
      }
      const auto s = view.sums(terms, 7);
      add_vector(values, {{s[1] / s[0], s[2] / s[0], s[3] / s[0]}}, dimension_);
      add_vector(values, {{s[4] / s[0], s[5] / s[0], s[6] / s[0]}}, dimension_);
    }

    const unsigned int dimension_;
    Vector place_{};
    std::optional<NamedSurface> surface_;
    int interface_ = -1; ///< the block that has a law or contact; -1: none
  };

  NSFD_REGISTER(ObservableRegistry, Probe, "probe",
                "Displacement, velocity, stress at a place, or means on faces",
                "at = 0, 0");
} // namespace nsfd
