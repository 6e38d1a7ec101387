#include "crack_front.h"

#include <fmt/format.h>

#include <limits>

namespace nsfd
{
  using namespace observables;

  namespace
  {
    /** q(r): 1 up to half the radius of a contour, then smoothly to 0. */
    struct Weight {
      double value = 0.;
      Vector gradient{};

      Weight(const Vector &x, const Vector &centre, const double radius)
      {
        const Vector way = minus(x, centre);
        const double r = std::sqrt(product(way, way)), s = 2. * r / radius - 1.;
        if (s >= 1.)
          return;
        if (s <= 0.) {
          value = 1.;
          return;
        }
        value = 1. + s * s * (2. * s - 3.);
        const double slope = 6. * s * (s - 1.) * 2. / radius;
        for (unsigned int c = 0; c < 3; ++c)
          gradient[c] = slope * way[c] / r;
      }

      /** int q dA over the plane. */
      static double integral(const double radius)
      {
        const double a = radius / 2.;
        return 2. * std::acos(-1.) * (a * a / 2. + a * (a / 2. + 0.15 * a));
      }
    };

    /** sigma as a matrix times a vector. */
    Vector times(const RunView::Stress &s, const Vector &n)
    {
      return {{s[0] * n[0] + s[3] * n[1] + s[4] * n[2],
               s[3] * n[0] + s[1] * n[1] + s[5] * n[2],
               s[4] * n[0] + s[5] * n[1] + s[2] * n[2]}};
    }

    /** grad u . direction */
    Vector along(const RunView::Gradient &gradient, const Vector &direction)
    {
      Vector result{};
      for (unsigned int c = 0; c < 3; ++c)
        for (unsigned int d = 0; d < 3; ++d)
          result[c] += gradient[3 * c + d] * direction[d];
      return result;
    }

    /** sigma : grad u / 2; sigma zz does no work in the plane. */
    double strain_energy(const RunView::Stress &s,
                         const RunView::Gradient &gradient)
    {
      double energy = 0.;
      for (unsigned int c = 0; c < 3; ++c) {
        Vector unit{};
        unit[c] = 1.;
        energy +=
            0.5 * product(times(s, unit),
                          {{gradient[c], gradient[3 + c], gradient[6 + c]}});
      }
      return energy;
    }
  } // namespace

  /**
   * The dynamic energy release rate by domain integrals (Nakamura, Shih and
   * Freund 1985) around a place or a moving tip, see doc/observables.md:
   *
   *   G = sum over cells int (P . grad q + f q) dA + terms of faces,
   *   P = (d.grad u) sigma - (W + T) d,
   *   f = (rho a - b).(d.grad u) - rho v.(d.grad v).
   */
  class EnergyRelease final : public Observable
  {
  public:
    EnergyRelease(SectionReader &reader, const SceneInput &scene)
        : material_(only_material(scene)), scene_(scene)
    {
      check(reader, scene);
      if (reader.optional("at", "m, a tip that stays there; by default it "
                                "follows the broken faces"))
        place_ = in_space(reader.numbers("at", "", units::length, Range::any(),
                                         scene.dimension, ""));
      front_ = std::make_unique<CrackFront>(reader, scene, !place_);
      radii_ = reader.number_list(
          "radii", units::length, Range::positive(),
          "m, of the contours; by default three around the cohesive zone");
      for (std::size_t b = 0; b < scene.interfaces.size(); ++b)
        if (front_->faces()[b] && material_)
          zone_ = std::max(zone_, cohesive_zone(*scene.interfaces[b].law));
    }

    void find(const RunView &view) override
    {
      if (place_ && !(view.at(*place_).size > 0.))
        throw std::runtime_error(
            fmt::format("at = {:.6g}, {:.6g} is outside of the mesh",
                        (*place_)[0], (*place_)[1]));
      if (!radii_.empty())
        return;
      const double first = 2. * std::max(4. * view.cell_size(), zone_);
      radii_ = {first, 1.5 * first, 2. * first};
    }

    std::vector<ObservedColumn> columns() const override
    {
      std::vector<ObservedColumn> columns = {{"G", "J/m²"}};
      for (std::size_t k = 0; k < radii_.size(); ++k)
        columns.push_back({"G_" + std::to_string(k + 1), "J/m²"});
      columns.push_back({"spread", ""});
      columns.push_back({"zone", "J/m²"});
      columns.push_back({"inside", ""});
      if (material_)
        columns.push_back({"K", "Pa √m"});
      add_vector(columns, "tip", "m", 2);
      columns.push_back({"speed", "m/s"});
      return columns;
    }

    void follow(const RunView &view) override { front_->follow(view); }

    std::vector<double> values(const RunView &view) override;

    std::string text() const override
    {
      std::string list;
      for (const double radius : radii_)
        list += fmt::format("{}{:.4g}", list.empty() ? "" : ", ", radius);
      return (place_ ? fmt::format("at ({:.4g}, {:.4g})", (*place_)[0],
                                   (*place_)[1])
                     : "at the tip of the " + front_->text(scene_)) +
             ", radii " + list + " m";
    }

    void serialize(Archive &archive) override { front_->serialize(archive); }

  private:
    static void check(SectionReader &reader, const SceneInput &scene);
    double cohesive_zone(const CohesiveLaw &law) const;
    /** Rows G of the radii, weights of the radii, zone; a column per term. */
    class Terms;
    void add_cells(const RunView &view, const Vector &tip, Terms &terms) const;
    void add_faces(const RunView &view, const Vector &tip, Terms &terms) const;

    const std::optional<RunningCrack> material_;
    const SceneInput &scene_;
    std::unique_ptr<CrackFront> front_;
    std::optional<Vector> place_;
    std::vector<double> radii_; ///< m
    double zone_ = 0.;          ///< longest cohesive zone, m
  };

  void EnergyRelease::check(SectionReader &reader, const SceneInput &scene)
  {
    if (scene.dimension != 2)
      reader.error("type", "the energy release rate needs dimension = 2",
                   "contours are around a point of the plane");
    if (scene.large_motion)
      reader.error("type", "the energy release rate needs motion = small",
                   "remove the block, or write motion = small");
    if (std::all_of(scene.materials.begin(), scene.materials.end(),
                    [](const auto &material) { return material.rigid; }))
      reader.error("type", "no material is elastic: no energy is released");
    for (const MaterialInput &material : scene.materials)
      if (material.varies() || material.plastic || material.is_viscous() ||
          material.initial_stress.is_given())
        reader.error(
            "type",
            fmt::format("contours of the energy release rate agree in uniform "
                        "elastic bodies; `Material: {}` {}",
                        material.name,
                        material.varies()       ? "differs from place to place"
                        : material.plastic      ? "flows"
                        : material.is_viscous() ? "is viscous"
                                                : "has an initial stress"),
            "remove the block; `type = crack` gives length and speed");
  }

  /** 9 pi/32 E' G/R_max^2. */
  double EnergyRelease::cohesive_zone(const CohesiveLaw &law) const
  {
    return 9. * std::acos(-1.) / 32. * material_->stiffness() *
           law.toughness() / (law.strength() * law.strength());
  }

  class EnergyRelease::Terms
  {
  public:
    explicit Terms(const std::size_t n_radii)
        : rows_(2 * n_radii + 1), n_radii_(n_radii)
    {
    }
    /** A column of zeros. */
    void begin() { columns_.emplace_back(rows_, 0.); }
    double &release(const std::size_t k) { return columns_.back()[k]; }
    double &weight(const std::size_t k)
    {
      return columns_.back()[n_radii_ + k];
    }
    double &zone() { return columns_.back()[2 * n_radii_]; }

    std::vector<double> sums(const RunView &view) const
    {
      const std::size_t n = columns_.size();
      std::vector<double> terms(rows_ * n);
      for (std::size_t r = 0; r < rows_; ++r)
        for (std::size_t k = 0; k < n; ++k)
          terms[r * n + k] = columns_[k][r];
      return view.sums(terms, unsigned(rows_));
    }

  private:
    const std::size_t rows_, n_radii_;
    std::vector<std::vector<double>> columns_;
  };

  void EnergyRelease::add_cells(const RunView &view, const Vector &tip,
                                Terms &terms) const
  {
    const Vector &d = front_->direction();
    const double reach = *std::max_element(radii_.begin(), radii_.end());
    view.visit_cells(tip, reach, [&](const RunView::CellPoint &x) {
      const Vector slope = along(x.gradient, d);
      const double energy = strain_energy(x.stress, x.gradient) +
                            0.5 * x.density * product(x.velocity, x.velocity);
      Vector flux = times(x.stress, slope), load{};
      for (unsigned int c = 0; c < 3; ++c) {
        flux[c] -= energy * d[c];
        load[c] = x.density * x.acceleration[c] - x.force[c];
      }
      const double source =
          product(load, slope) -
          x.density * product(x.velocity, along(x.velocity_gradient, d));
      terms.begin();
      for (std::size_t k = 0; k < radii_.size(); ++k) {
        const Weight q(x.position, tip, radii_[k]);
        terms.release(k) =
            x.JxW * (product(flux, q.gradient) + source * q.value);
        terms.weight(k) = x.JxW * q.value;
      }
    });
  }

  /**
   * What is not the crack that grows: the jump of P n at faces with springs,
   * and at broken faces. Springs of the crack's own faces store energy ahead
   * of the tip, as cells do. What the cohesive zone takes is the row `zone`.
   */
  void EnergyRelease::add_faces(const RunView &view, const Vector &tip,
                                Terms &terms) const
  {
    const Vector &d = front_->direction();
    const double reach = *std::max_element(radii_.begin(), radii_.end());
    view.visit_sides(tip, reach, [&](const RunView::SidePoint &x) {
      if (x.kind != PointKind::elastic && x.kind != PointKind::cohesive &&
          x.kind != PointKind::free)
        return;
      const bool of_crack = front_->faces()[x.block];
      const double energy = strain_energy(x.stress, x.gradient) +
                            0.5 * x.density * product(x.velocity, x.velocity);
      const double forward = product(x.normal, d);
      const double across =
          product(x.traction, along(x.gradient, x.normal)) - energy;
      const double jump =
          x.sign * x.area *
          (product(x.traction, along(x.gradient, d)) - energy * forward);
      terms.begin();
      const bool broken = x.beta <= x.broken_beta;
      const bool intact = x.kind == PointKind::elastic || x.beta == 1.;
      if (of_crack && !broken && !intact)
        terms.zone() = -jump;
      for (std::size_t k = 0; k < radii_.size(); ++k) {
        const Weight q(x.position, tip, radii_[k]);
        if (broken || !of_crack)
          terms.release(k) = jump * q.value;
        else if (intact) {
          terms.release(k) = x.sign * x.area * forward * across * q.value;
          if (x.sign < 0.) { // once per point: the stored energy
            const double along_face = product(q.gradient, d) -
                                      forward * product(q.gradient, x.normal);
            terms.release(k) -=
                0.5 * x.area * product(x.traction, x.jump) * along_face;
          }
        }
      }
    });
  }

  std::vector<double> EnergyRelease::values(const RunView &view)
  {
    const std::size_t n = radii_.size();
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    const std::optional<Vector> tip = place_ ? place_ : front_->tip();
    if (!tip)
      return std::vector<double>(columns().size(), nothing);
    Terms terms(n);
    add_cells(view, *tip, terms);
    add_faces(view, *tip, terms);
    const auto s = terms.sums(view);
    double mean = 0., inside = 1.;
    for (std::size_t k = 0; k < n; ++k) {
      mean += s[k] / double(n);
      inside = std::min(inside, s[n + k] / Weight::integral(radii_[k]));
    }
    const auto [low, high] =
        std::minmax_element(s.begin(), s.begin() + long(n));
    const double speed = place_ ? 0. : front_->speed();
    std::vector<double> values = {mean};
    values.insert(values.end(), s.begin(), s.begin() + long(n));
    values.push_back(mean != 0. ? (*high - *low) / std::abs(mean) : 0.);
    values.push_back(s[2 * n]);
    values.push_back(inside);
    if (material_)
      values.push_back(material_->opening_intensity(mean, speed));
    add_vector(values, *tip, 2);
    values.push_back(speed);
    return values;
  }

  NSFD_REGISTER(ObservableRegistry, EnergyRelease, "energy release rate",
                "Dynamic energy release rate G and K around a tip, contours",
                "direction = 1, 0");
} // namespace nsfd
