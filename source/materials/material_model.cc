#include "nsfd/materials/material_model.h"

#include <algorithm>
#include <utility>

namespace nsfd
{
  double MaterialModel::stress_across(double, const Voigt<2> &) const
  {
    throw std::logic_error("not a model of finite strain");
  }

  std::vector<std::string> material_model_names()
  {
    std::vector<std::pair<unsigned int, std::string>> models;
    for (const std::string &name : MaterialRegistry::instance().names())
      models.emplace_back(MaterialRegistry::instance().create(name)->place(),
                          name);
    std::sort(models.begin(), models.end());
    std::vector<std::string> names;
    for (const auto &model : models)
      names.push_back(model.second);
    return names;
  }
} // namespace nsfd
