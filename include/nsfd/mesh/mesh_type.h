#pragma once

#include "nsfd/core/registry.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class SectionReader;
  struct MeshInput;
  template <int dim>
  struct CoarseMesh; // see coarse_mesh.h

  /**
   * A way to make a mesh: what `type` of a section Mesh or Body names. A class
   * that registers itself, under one name or, as the generators of deal.II,
   * under several; built with its name.
   */
  class MeshType
  {
  public:
    virtual ~MeshType() = default;

    /** Lists name types in this order, those of equal place by their names. */
    virtual unsigned int place() const { return 100; }

    /** Of the scenes it is for; 0: two and three. */
    virtual unsigned int dimension() const { return 0; }

    /** The mesh of one body or of a whole scene; false: of all `Body` blocks.
     */
    virtual bool is_one_mesh() const { return true; }

    /** For a `Body` block, too; not if the mesh brings groups of its own. */
    virtual bool is_for_bodies() const { return true; }

    /** Material and boundary ids of its cells and faces mean something. */
    virtual bool has_ids() const { return false; }

    /** Two such meshes that overlap do so in their boxes. */
    virtual bool fills_box() const { return false; }

    /** The cells are triangles or tetrahedra, unless they are split. */
    virtual bool has_simplices(const MeshInput &) const { return false; }

    /** Entry `split` where the file does not say it. */
    virtual const char *split(const MeshInput &) const { return "none"; }

    /**
     * What `split = barycentric` makes of two neighbouring triangles: a
     * straight line from centroid to centroid, or one by the middle of their
     * edge.
     */
    virtual bool is_cut_straight() const { return false; }

    /** Cells before they are refined or split, as far as the entries tell. */
    virtual double n_cells(const MeshInput &, unsigned int) const { return 1.; }

    /** Read the entries that only this type has; what cannot be is reported. */
    virtual void read(SectionReader &reader, unsigned int dimension,
                      MeshInput &mesh) const = 0;

    /**
     * The mesh with every cell halved @p refinements times, the same on every
     * rank. What is wrong goes into @p problems, one sentence each.
     */
    template <int dim>
    CoarseMesh<dim> build(const MeshInput &input,
                          const unsigned int refinements,
                          std::vector<std::string> &problems) const
    {
      CoarseMesh<dim> mesh;
      make(input, refinements, problems, mesh);
      return mesh;
    }

  private:
    virtual void make(const MeshInput &input, unsigned int refinements,
                      std::vector<std::string> &problems,
                      CoarseMesh<2> &mesh) const = 0;
    virtual void make(const MeshInput &input, unsigned int refinements,
                      std::vector<std::string> &problems,
                      CoarseMesh<3> &mesh) const = 0;
  };

  using MeshTypeRegistry = Registry<MeshType, const std::string &>;

  /** The names of all types, in the order of lists. */
  std::vector<std::string> mesh_type_names();

  /** Null if there is no such type. */
  std::unique_ptr<const MeshType> find_mesh_type(const std::string &name);
} // namespace nsfd
