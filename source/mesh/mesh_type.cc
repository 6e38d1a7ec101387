#include "nsfd/mesh/coarse_mesh.h"

#include <algorithm>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** mesh_of_bodies() makes it of the meshes of the blocks. */
    class BodiesMesh final : public MeshType
    {
    public:
      explicit BodiesMesh(const std::string &) {}
      unsigned int place() const override { return 6; }
      bool is_one_mesh() const override { return false; }
      bool is_for_bodies() const override { return false; }
      void read(SectionReader &, unsigned int, MeshInput &) const override {}

    private:
      void make(const MeshInput &, unsigned int, std::vector<std::string> &,
                CoarseMesh<2> &) const override
      {
      }
      void make(const MeshInput &, unsigned int, std::vector<std::string> &,
                CoarseMesh<3> &) const override
      {
      }
    };

    NSFD_REGISTER(MeshTypeRegistry, BodiesMesh, "bodies",
                  "the meshes of all blocks `Body: name`");
  } // namespace

  std::vector<std::string> mesh_type_names()
  {
    const auto &registry = MeshTypeRegistry::instance();
    std::vector<std::pair<unsigned int, std::string>> types;
    for (const std::string &name : registry.names())
      types.emplace_back(registry.create(name, name)->place(), name);
    std::sort(types.begin(), types.end());
    std::vector<std::string> names;
    for (const auto &type : types)
      names.push_back(type.second);
    return names;
  }

  std::unique_ptr<const MeshType> find_mesh_type(const std::string &name)
  {
    const auto &registry = MeshTypeRegistry::instance();
    return registry.knows(name) ? registry.create(name, name) : nullptr;
  }
} // namespace nsfd
