#pragma once

#include "nsfd/core/registry.h"
#include "nsfd/materials/history_material.h"
#include "nsfd/materials/hyperelastic.h"
#include "nsfd/scene/material_input.h"

#include <memory>
#include <stdexcept>

namespace nsfd
{
  class SectionReader;

  /** What the entries of a material depend on besides its own block. */
  struct MaterialSetting {
    unsigned int dimension = 2;
    bool plane_stress = false; ///< in the plane only
    bool large_motion = false;
    const GrainTable *grains = nullptr; ///< null: the mesh is not known
  };

  /**
   * A bulk law: what `model` of a Material block names. A class in one file
   * that registers itself; an instance belongs to one block and may keep
   * constants of its own.
   */
  class MaterialModel
  {
  public:
    virtual ~MaterialModel() = default;

    virtual MaterialKind kind() const = 0;

    /** Lists name models in this order, those of equal place by their names. */
    virtual unsigned int place() const { return 100; }

    /**
     * Read the entries of the model: density, which every one has, and others
     * as they are called here (materials/material_entries.h has those that
     * several models share). What cannot be is reported at the reader. What
     * the rest of the program asks for goes to @p material.
     */
    virtual void read(SectionReader &reader, const MaterialSetting &setting,
                      MaterialInput &material) = 0;

    /** The energy of finite strain; of this kind only, else logic_error. */
    template <int dim>
    std::unique_ptr<const Hyperelastic<dim>>
    hyperelastic(const MaterialInput &material, const bool plane_stress) const
    {
      std::unique_ptr<const Hyperelastic<dim>> result;
      make_energy(material, plane_stress, result);
      if (!result)
        throw std::logic_error("not a model of finite strain");
      return result;
    }

    /** The law of a point with internal variables; likewise. */
    template <int dim>
    std::unique_ptr<const HistoryMaterial<dim>>
    history_dependent(const MaterialInput &material, const bool finite_strain,
                      const bool plane_stress) const
    {
      std::unique_ptr<const HistoryMaterial<dim>> result;
      make_history(material, finite_strain, plane_stress, result);
      if (!result)
        throw std::logic_error("not a model with history");
      return result;
    }

    /**
     * S_33 of plane strain, where C_33 = 1, in Pa; models of finite strain.
     * @p lambda is Lame's constant of small strain.
     */
    virtual double stress_across(double lambda, const Voigt<2> &C) const;

  protected:
    /** With plane stress or not; for the plane and for space. */
    virtual void make_energy(const MaterialInput &, bool,
                             std::unique_ptr<const Hyperelastic<2>> &) const
    {
    }
    virtual void make_energy(const MaterialInput &, bool,
                             std::unique_ptr<const Hyperelastic<3>> &) const
    {
    }
    virtual void make_history(const MaterialInput &, bool, bool,
                              std::unique_ptr<const HistoryMaterial<2>> &) const
    {
    }
    virtual void make_history(const MaterialInput &, bool, bool,
                              std::unique_ptr<const HistoryMaterial<3>> &) const
    {
    }
  };

  using MaterialRegistry = Registry<MaterialModel>;

  /** The names of all models, in the order of lists. */
  std::vector<std::string> material_model_names();
} // namespace nsfd
