#include "fragment_sizes.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace nsfd
{
  namespace
  {
    /** Of sorted values. */
    double median_of(const std::vector<double> &sorted)
    {
      const std::size_t n = sorted.size();
      return (sorted[(n - 1) / 2] + sorted[n / 2]) / 2.;
    }

    std::optional<double> exponent_of(const std::vector<double> &masses)
    {
      double logarithms = 0.;
      for (const double mass : masses)
        logarithms += std::log(mass / masses.back());
      // round-off of equal masses is no distribution
      if (masses.size() < 10 || !(logarithms > 1e-9 * double(masses.size())))
        return {};
      return double(masses.size()) / logarithms;
    }

    void fill_histogram(FragmentSizes &result)
    {
      // a share of round-off keeps equal sizes together
      double edge = result.sizes.back() * (1. - 1e-9);
      result.edges.push_back(edge);
      for (auto size = result.sizes.rbegin(); size != result.sizes.rend();
           ++size) {
        while (result.numbers.empty() || *size >= edge) {
          edge *= 2.;
          result.edges.push_back(edge);
          result.numbers.push_back(0);
        }
        ++result.numbers.back();
      }
    }
  } // namespace

  std::optional<FragmentSizes>
  fragment_sizes(const std::vector<FragmentRecord> &records,
                 const unsigned int dimension)
  {
    if (records.empty())
      return {};
    FragmentSizes result;
    std::vector<double> masses;
    for (const FragmentRecord &record : records) {
      const double size = record.size(dimension);
      result.sizes.push_back(size);
      masses.push_back(record.mass);
      result.mean_size += size / double(records.size());
      result.mean_size_by_mass += record.mass * size;
      result.total_mass += record.mass;
      result.surface += record.surface;
    }
    std::sort(result.sizes.begin(), result.sizes.end(), std::greater<>());
    std::sort(masses.begin(), masses.end(), std::greater<>());
    result.mean_size_by_mass /= result.total_mass;
    result.median_size = median_of(result.sizes);
    result.mean_mass = result.total_mass / double(masses.size());
    result.median_mass = median_of(masses);
    result.smallest_mass = masses.back();
    result.largest_mass = masses.front();
    result.mass_exponent = exponent_of(masses);
    fill_histogram(result);
    return result;
  }

  double FragmentRecord::size(const unsigned int dimension) const
  {
    if (axisymmetric) // 2 pi of them are the volume
      return std::cbrt(12. * volume);
    return dimension == 2 ? std::sqrt(4. * volume / M_PI)
                          : std::cbrt(6. * volume / M_PI);
  }
} // namespace nsfd
