#pragma once

#include "parameters/place_fields.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  struct NamedMesh;

  /**
   * The fields of a mesh, in the order of NamedMesh::fields, as functions of
   * the place: of the mesh as it was read, which cells that are split or
   * refined later stay in. The search takes O(log n).
   */
  class CellFields final : public PlaceFields
  {
  public:
    explicit CellFields(std::shared_ptr<const NamedMesh> mesh);
    ~CellFields() override;

    void find(double x, double y, double z,
              std::vector<std::size_t> &cells) const override;
    double value(std::size_t field, std::size_t cell) const override;

  private:
    class Search; // boxes of cells, made when they are first asked for
    std::shared_ptr<const NamedMesh> mesh_;
    std::vector<const std::vector<double> *> values_;
    mutable std::unique_ptr<const Search> search_;
  };
} // namespace nsfd
