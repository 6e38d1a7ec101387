#include "crack_front.h"

#include <limits>

namespace nsfd
{
  using namespace observables;

  /**
   * Length, tip and speed of a crack, and what it spends per length; how many
   * of its branches cross given lines.
   */
  class Crack final : public Observable
  {
  public:
    Crack(SectionReader &reader, const SceneInput &scene)
        : front_(reader, scene), text_(front_.text(scene)),
          material_(only_material(scene)), dimension_(scene.dimension),
          area_unit_(area_unit(scene))
    {
      if (scene.dimension == 2)
        sections_ = reader.number_list(
            "sections", units::length, Range::any(),
            "m along the direction: lines whose crossings are counted");
      else
        reader.refuse({"sections"}, "they are lines of the plane");
    }

    std::vector<ObservedColumn> columns() const override
    {
      std::vector<ObservedColumn> columns = {{"length", area_unit_}};
      add_vector(columns, "tip", "m", dimension_);
      columns.push_back({"speed", "m/s"});
      if (material_)
        columns.push_back({"speed_over_rayleigh", ""});
      columns.push_back({"energy_per_length", "J/m²"});
      for (std::size_t k = 0; k < sections_.size(); ++k)
        columns.push_back({"crossings_" + std::to_string(k + 1), "faces"});
      return columns;
    }

    void follow(const RunView &view) override { front_.follow(view); }

    std::vector<double> values(const RunView &view) override
    {
      std::vector<double> values = {front_.length()};
      Vector nowhere;
      nowhere.fill(std::numeric_limits<double>::quiet_NaN());
      add_vector(values, front_.tip().value_or(nowhere), dimension_);
      values.push_back(front_.speed());
      if (material_)
        values.push_back(front_.speed() / material_->rayleigh_speed());
      values.push_back(front_.spent());
      for (const double section : sections_)
        values.push_back(crossings(view, section));
      return values;
    }

    std::string text() const override { return text_; }
    void serialize(Archive &archive) override { front_.serialize(archive); }

  private:
    /** Broken pieces of faces that reach from one side to the other. */
    double crossings(const RunView &view, const double section) const
    {
      std::vector<double> terms;
      for (const std::size_t i : front_.broken()) {
        const auto &ends = view.points()[i].ends;
        const bool first = product(ends[0], front_.direction()) < section,
                   second = product(ends[1], front_.direction()) < section;
        if (first != second)
          terms.push_back(1.);
      }
      return view.sums(terms, 1)[0];
    }

    CrackFront front_;
    const std::string text_;
    const std::optional<RunningCrack> material_;
    const unsigned int dimension_;
    const std::string area_unit_;
    std::vector<double> sections_;
  };

  NSFD_REGISTER(ObservableRegistry, Crack, "crack",
                "Length, tip, speed, energy spent per length, branches",
                "direction = 1, 0");
} // namespace nsfd
